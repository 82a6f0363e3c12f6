// ESRI ASCII grid (Esri, "ASCII raster format"): a header of keys, then the rows from the top. Not by GDAL:
// version 3.6 refuses grids that contain `nan` and rounds through a table of its own.

#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/base/lower_case.h"
#include "engine/io/field_limits.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/geo/sidecar.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr double kEsriNoData = -9999.0;  // meaning of the format when the key is missing

struct Header {
  std::optional<double> columns, rows, cell, dx, dy, no_data;
  std::optional<double> x_corner, x_centre, y_corner, y_centre;

  std::optional<double>* slot(const std::string& key) {
    if (key == "ncols") return &columns;
    if (key == "nrows") return &rows;
    if (key == "cellsize") return &cell;
    if (key == "dx") return &dx;
    if (key == "dy") return &dy;
    if (key == "nodata_value" || key == "nodata") return &no_data;
    if (key == "xllcorner") return &x_corner;
    if (key == "yllcorner") return &y_corner;
    if (key == "xllcenter" || key == "xllcentre") return &x_centre;
    if (key == "yllcenter" || key == "yllcentre") return &y_centre;
    return nullptr;
  }
};

bool number(std::string_view word, double& value) {
  const char* at = word.data();
  return parseNumber(at, word.data() + word.size(), value) && at == word.data() + word.size();
}

tl::unexpected<Error> badWord(std::string_view word, const std::string& where, const std::string& path) {
  const std::string shown(word.substr(0, 40));
  if (word.find(',') != std::string_view::npos)
    return inputError(fmt::format("\"{}\" {} has a decimal comma", shown, where), path,
                      "write decimal points");
  return inputError(fmt::format("\"{}\" {} is not a number", shown, where), path, "the file is damaged");
}

// Reads keys until the first word that is a number; `first` returns that word.
Result<Header> readHeader(TextReader& text, std::string& first, const std::string& path) {
  Header header;
  std::string_view word;
  while (text.word(word)) {
    double value = 0.0;
    if (number(word, value)) {
      first = word;
      return header;
    }
    const std::string key = lowerCase(word);
    std::optional<double>* slot = header.slot(key);
    if (slot == nullptr) return badWord(word, "in the header", path);
    if (!text.word(word)) break;
    if (!number(word, value)) return badWord(word, "after " + key, path);
    *slot = value;
  }
  if (!text.status()) return tl::unexpected(text.status().error());
  return inputError("the file ends inside the header", path, "the file is cut short");
}

Result<Grid> gridOf(const Header& h, std::uint64_t file_size, StatedUnits& units, const std::string& path) {
  if (!h.columns || !h.rows)
    return inputError("the header states no ncols or nrows", path, "the file is damaged");
  if (!(*h.columns >= 1 && *h.columns < 1e18 && *h.rows >= 1 && *h.rows < 1e18) ||
      *h.columns != std::floor(*h.columns) || *h.rows != std::floor(*h.rows))
    return inputError(fmt::format("the header states {} x {} samples", *h.columns, *h.rows), path,
                      "the file is damaged");
  const auto columns = static_cast<std::uint64_t>(*h.columns);
  const auto rows = static_cast<std::uint64_t>(*h.rows);
  if (Status s = checkFieldSize(columns, rows, 0, path); !s) return tl::unexpected(s.error());
  // Every number takes a digit and, except for the last, a space.
  if (columns * rows * 2 - 1 > file_size)
    return inputError(fmt::format("the file is too short for {} x {} numbers", columns, rows), path,
                      "the file is cut short");
  const double dx = h.dx ? *h.dx : h.cell.value_or(0.0);
  const double dy = h.dy ? *h.dy : h.cell.value_or(0.0);
  if (!(std::isfinite(dx) && std::isfinite(dy) && dx > 0.0 && dy > 0.0))
    return inputError("the header states no positive cellsize", path, "the file is damaged");
  for (const auto& corner : {h.x_corner, h.x_centre, h.y_corner, h.y_centre})
    if (corner && !std::isfinite(*corner))
      return inputError("the header's lower left corner is not finite", path, "the file is damaged");
  Grid grid;
  grid.width = static_cast<std::int32_t>(columns);
  grid.height = static_cast<std::int32_t>(rows);
  units.spacing = std::pair{dx, dy};
  grid.origin_x = h.x_centre ? *h.x_centre : h.x_corner.value_or(0.0) + 0.5 * dx;
  grid.origin_y = h.y_centre ? *h.y_centre : h.y_corner.value_or(0.0) + 0.5 * dy;
  return grid;
}

void tallyRounding(std::string_view word, float number, const HeightRule& rule, HeightTally& tally) {
  const char* at = word.data();
  double exact = 0.0;
  if (!rule.hole(number) && std::isfinite(number) && parseNumber(at, word.data() + word.size(), exact))
    tally.rounded(exact, number);
}

// The rows, parsed as Float: directly to float where they are not scaled, so that they are rounded once;
// otherwise to double.
template <class Float>
Status readRows(TextReader& text, const std::string& first, const HeightRule& rule, FieldBuilder& builder,
                HeightTally& tally, const std::string& path, JobControl& job) {
  const std::int32_t width = builder.grid().width;
  std::vector<Float> numbers(static_cast<std::size_t>(width));
  std::vector<float> heights(static_cast<std::size_t>(width));
  std::string_view word = first;
  bool have = true;
  const std::int32_t height = builder.grid().height;
  for (std::int32_t r = 0; r < height; ++r) {
    for (std::int32_t c = 0; c < width; ++c) {
      if (!have && !text.word(word)) {
        if (!text.status()) return text.status();
        return inputError(fmt::format("the file ends inside row {} of {}", r + 1, height), path,
                          "the file is cut short");
      }
      have = false;
      const char* at = word.data();
      if (!parseNumber(at, word.data() + word.size(), numbers[static_cast<std::size_t>(c)]) ||
          at != word.data() + word.size())
        return badWord(word, fmt::format("in row {}, column {}", r + 1, c + 1), path);
      // What a float loses is seen by one number of each row, down the diagonal: parsed as double they would be rounded twice.
      if constexpr (std::is_same_v<Float, float>)
        if (c == r % width) tallyRounding(word, numbers[static_cast<std::size_t>(c)], rule, tally);
    }
    if (job.cancelled()) return cancelled();
    rule.convert(numbers.data(), heights.data(), numbers.size(), tally);
    builder.writeHeights(0, height - 1 - r, width, 1, heights.data(), width);
    job.advance();
  }
  return {};
}

bool looksLikeAsciiGrid(std::string_view head, std::string_view) {
  if (!looksLikeText(head)) return false;
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos) return false;
  const std::string word = lowerCase(head.substr(start, 9));
  return word.starts_with("ncols") || word.starts_with("nrows") || word.starts_with("xllc") ||
         word.starts_with("yllc") || word.starts_with("cellsize");
}

Result<Imported> readAsciiGrid(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  TextReader text(file);
  std::string first;
  const Result<Header> header = readHeader(text, first, path);
  if (!header) return tl::unexpected(header.error());
  StatedUnits units;
  Result<Grid> grid = gridOf(*header, file.size(), units, path);
  if (!grid) return tl::unexpected(grid.error());
  std::vector<std::string> warnings;
  const Sidecar sidecar = readAuxXml(path, warnings);
  grid->crs_wkt = readPrj(path, warnings);
  if (grid->crs_wkt.empty()) grid->crs_wkt = sidecar.crs_wkt;
  units.height = heightUnitNamed(sidecar.height_unit, options, warnings);
  if (!grid->crs_wkt.empty()) {
    const GdalSession quiet;
    unitsOfCrs(grid->crs_wkt, grid->origin_y + 0.5 * grid->height * units.spacing->second, units, warnings);
  }
  determineUnits(*grid, units, options, warnings);
  // A corner lies half a sample from the first one, by the spacing that holds.
  if (!header->x_centre) grid->origin_x = header->x_corner.value_or(0.0) + 0.5 * grid->spacing_x;
  if (!header->y_centre) grid->origin_y = header->y_corner.value_or(0.0) + 0.5 * grid->spacing_y;
  HeightRule rule;
  rule.scale = options.z_scale.value_or(1.0);
  const std::optional<double> declared = chooseNoData(header->no_data, sidecar, warnings);
  rule.declared_no_data = declared.value_or(kEsriNoData);
  rule.user_no_data = options.no_data;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(*grid), path);
  if (!builder) return tl::unexpected(builder.error());
  job.begin("reading", static_cast<std::uint64_t>(builder->grid().height));
  HeightTally tally;
  const Status status = rule.scale == 1.0 ? readRows<float>(text, first, rule, *builder, tally, path, job)
                                          : readRows<double>(text, first, rule, *builder, tally, path, job);
  if (!status) return tl::unexpected(status.error());
  tally.decimals = true;
  if (!declared && tally.holes > 0)
    warnings.push_back("the header states no NODATA_VALUE, -9999 is used as defined by the format");
  if (text.lastLineIsOpen()) warnings.emplace_back(kOpenLastLine);
  if (std::string_view rest; text.word(rest))
    warnings.push_back("there are more numbers than the header states, the rest was left out");
  return finishImport(std::move(*builder), rule, tally, "AAIGrid", std::move(warnings));
}

}  // namespace

constexpr std::string_view kAsciiGridExtensions[] = {".asc", ".agr", ".grd"};
constexpr Format kAsciiGridFormat{
    .info = {"AAIGrid", "ESRI ASCII grid", kAsciiGridExtensions, true, true, true},
    .recognises = looksLikeAsciiGrid,
    .read = readAsciiGrid,
    .write = writeAsciiGrid,
};

}  // namespace fettle::engine
