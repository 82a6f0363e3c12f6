// 16-bit grey PNG: height = offset + count * step, 0 = hole. The picture's Description states the rule.

#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/format.h"
#include "engine/io/raster/png_stream.h"

namespace fettle::engine {

namespace {

struct Quantisation {
  double offset = 0.0;
  double step = 1.0;
  bool counts_given_back = true;  // the offset is 0, so that --z-scale alone restores the heights
};

bool hasHoles(const FieldReader& reader) {
  return reader.root().holed_children != 0;
}

// 0 stands for a hole, so a height of 0 fits only without holes.
bool fits(const HeightBounds& bounds, bool holes, double step) {
  return std::nearbyint(bounds.min / step) >= (holes ? 1.0 : 0.0) &&
         std::nearbyint(bounds.max / step) <= 65535.0;
}

Result<Quantisation> chooseSteps(const Version& field, const ExportOptions& options, const std::string& path,
                                 std::vector<std::string>& warnings) {
  const HeightBounds bounds = field.reader().bounds();
  const bool holes = hasHoles(field.reader());
  const std::string& unit = field.grid().height_unit.name;
  if (options.height_per_count) {
    if (!fits(bounds, holes, *options.height_per_count))
      return inputError(fmt::format("heights {} to {} {} do not fit 16 bits at {} per count", bounds.min,
                                    bounds.max, unit, *options.height_per_count),
                        path, "omit the height per count or write a .tif");
    return Quantisation{0.0, *options.height_per_count, true};
  }
  const double own = field.grid().height_per_count;
  if (own > 0.0 && fits(bounds, holes, own)) return Quantisation{0.0, own, true};
  if (own > 0.0)
    warnings.push_back(fmt::format("heights no longer fit 16 bits at {} {} per count", own, unit));
  const double range = static_cast<double>(bounds.max) - static_cast<double>(bounds.min);
  const double step = range > 0.0 ? range / 65534.0 : 1.0;
  return Quantisation{static_cast<double>(bounds.min) - step, step, false};
}

}  // namespace

// 16-bit grey, 0 = hole, quantised: a warning states count and largest error.
Result<Exported> writePng(const Version& field, const std::string& path, const ExportOptions& options,
                          JobControl& job) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  Exported exported{"PNG", {}};
  Quantisation q;
  if (!reader.bounds().empty()) {
    const Result<Quantisation> chosen = chooseSteps(field, options, path, exported.warnings);
    if (!chosen) return tl::unexpected(chosen.error());
    q = *chosen;
  }
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const std::string& unit = grid.height_unit.name;
  std::string rule = q.counts_given_back ? fmt::format("height = count * {} {}", q.step, unit)
                                         : fmt::format("height = {} + count * {} {}", q.offset, q.step, unit);
  // Without holes 0 may be a height (fits).
  const bool zero_is_height = !reader.bounds().empty() && !hasHoles(reader) &&
                              std::nearbyint((double{reader.bounds().min} - q.offset) / q.step) < 1.0;
  if (!zero_is_height) rule += ", 0 = no data";
  PngHeader header;
  header.width = grid.width;
  header.height = grid.height;
  header.bits = 16;
  const std::string description =
      fmt::format("{}; spacing {} x {} {}; lower left sample at {}, {}", rule, grid.spacing_x, grid.spacing_y,
                  grid.lateral_unit.name, grid.origin_x, grid.origin_y);
  Result<PngWriter> writer = PngWriter::create(*file, header, description);
  if (!writer) return tl::unexpected(writer.error());
  std::vector<float> heights(static_cast<std::size_t>(grid.width));
  std::vector<std::uint16_t> counts(heights.size());
  double worst = 0.0;
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  for (std::int32_t row = grid.height - 1; row >= 0; --row) {
    reader.readHeights(0, row, grid.width, 1, heights.data(), grid.width);
    for (std::size_t c = 0; c < heights.size(); ++c) {
      if (std::isnan(heights[c])) {
        counts[c] = 0;
        continue;
      }
      const double height = heights[c];
      const double count = std::nearbyint((height - q.offset) / q.step);
      // The value computed by a reader: rounded to float like every height.
      worst = std::fmax(
          worst, std::abs(static_cast<double>(static_cast<float>(q.offset + count * q.step)) - height));
      counts[c] = static_cast<std::uint16_t>(count);
    }
    if (Status status = writer->writeRow(reinterpret_cast<const unsigned char*>(counts.data())); !status)
      return tl::unexpected(status.error());
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  if (Status status = writer->finish(); !status) return tl::unexpected(status.error());
  if (Status status = file->commit(); !status) return tl::unexpected(status.error());
  exported.warnings.push_back(fmt::format("{}; largest error {:.3g} {}", rule, worst, unit));
  exported.warnings.push_back(
      fmt::format("PNG stores no spacing ({} x {} {}), units, origin or coordinate system: they are "
                  "in the picture's description only",
                  grid.spacing_x, grid.spacing_y, grid.lateral_unit.name));
  return exported;
}

}  // namespace fettle::engine
