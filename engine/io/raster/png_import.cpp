#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/format.h"
#include "engine/io/geo/sidecar.h"
#include "engine/io/raster/png_stream.h"
#include "engine/io/rows_down.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

// Pixels per metre of 72, 96, 150, 300 and 600 per inch, rounded either way.
bool isPrintResolution(std::uint32_t per_metre) {
  for (const double inch : {72.0, 96.0, 150.0, 300.0, 600.0})
    if (std::abs(per_metre - inch / 0.0254) < 1.0) return true;
  return false;
}

// The rule for counts in a PNG written by Fettle (png_export.cpp): "height = -2 + count * 0.005 mm, 0 = no
// data; ...". Counts stay counts, as in any PNG, but holes are read, and a warning states how to get heights.
struct CountRule {
  std::string height;  // the right-hand side
  bool zero_is_hole = false;
};

std::optional<CountRule> countRuleOf(const std::string& description) {
  constexpr std::string_view kBegin = "height = ", kHole = ", 0 = no data";
  if (!description.starts_with(kBegin) || description.find("count * ") == std::string::npos)
    return std::nullopt;
  const std::string rule = description.substr(kBegin.size(), description.find(';') - kBegin.size());
  const std::size_t comma = rule.find(',');
  return CountRule{rule.substr(0, comma),
                   comma != std::string::npos && std::string_view(rule).substr(comma) == kHole};
}

bool looksLikePng(std::string_view head, std::string_view) {
  return head.starts_with(std::string_view("\x89PNG\r\n\x1a\n", 8));
}

Result<Imported> readPng(const InputFile& file, const ImportOptions& options, JobControl& job) {
  Result<PngReader> reader = PngReader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  const PngHeader& header = reader->header();
  std::vector<std::string> warnings;
  if (header.alpha) warnings.emplace_back("the second band is transparency and was left out");
  if (header.bits <= 8)
    warnings.push_back(fmt::format("the PNG has {} bits, heights come in {} steps only", header.bits,
                                   (1 << header.bits) - 1));
  StatedUnits units;
  if (header.per_metre) {
    const auto [across, down] = *header.per_metre;
    if (isPrintResolution(across) && isPrintResolution(down))
      warnings.push_back(
          fmt::format("the file states {} samples per metre, a print resolution, which was ignored", across));
    else
      units.spacing_mm = std::pair{1000.0 / across, 1000.0 / down};
  }
  Grid grid;
  grid.width = header.width;
  grid.height = header.height;
  determineUnits(grid, units, options, warnings);
  HeightRule rule = HeightRule::of(options);
  if (header.transparent) rule.declared_no_data = *header.transparent;
  if (const auto stated = countRuleOf(header.description)) {
    if (stated->zero_is_hole) rule.declared_no_data = 0.0;
    if (!options.z_scale)
      warnings.push_back(
          fmt::format("the file states height = {}: counts were read, --z-scale converts them to heights",
                      stated->height));
  }
  const Sidecar sidecar = readAuxXml(file.path(), warnings);
  rule.declared_no_data = chooseNoData(rule.declared_no_data, sidecar, warnings);
  grid.height_per_count = std::abs(rule.scale);

  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), file.path());
  if (!builder) return tl::unexpected(builder.error());
  job.begin("reading", static_cast<std::uint64_t>(header.height));
  HeightTally tally;
  const auto read = [&reader](auto* numbers) {
    return reader->readRow(reinterpret_cast<unsigned char*>(numbers));
  };
  const Status rows = header.bits == 16 ? readRowsDown<std::uint16_t>(read, rule, *builder, tally, job)
                                        : readRowsDown<std::uint8_t>(read, rule, *builder, tally, job);
  if (!rows) return tl::unexpected(rows.error());
  if (Status finished = reader->finish(); !finished) return tl::unexpected(finished.error());
  return finishImport(std::move(*builder), rule, tally, "PNG", std::move(warnings));
}

}  // namespace

constexpr std::string_view kPngExtensions[] = {".png"};
constexpr Format kPngFormat{
    .info = {"PNG", "16-bit grey PNG", kPngExtensions, true, true},
    .recognises = looksLikePng,
    .read = readPng,
    .write = writePng,
    .picture = true,
};

}  // namespace fettle::engine
