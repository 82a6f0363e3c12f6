#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/format.h"
#include "engine/io/geo_reference.h"
#include "engine/io/text_writer.h"

namespace fettle::engine {

namespace {

// A number that stands for "no data" and is no height of the field: -9999 where it can be, else below or
// above all; for a field that fills the range of the float, NaN, which not every reader takes.
float freeNoData(const FieldReader& reader) {
  const HeightBounds bounds = reader.bounds();
  if (bounds.empty() || bounds.min > -9999.0F || bounds.max < -9999.0F) return -9999.0F;
  for (float value = -99999.0F; value > -3.0e38F; value *= 10.0F)
    if (value < bounds.min) return value;
  return bounds.max < 3.4e38F ? 3.4e38F : std::numeric_limits<float>::quiet_NaN();
}

// xllcorner, which every reader knows; where no corner gives the origin back bit for bit, xllcenter.
std::string originLines(const Grid& grid) {
  std::string lines;
  const auto add = [&](char axis, double centre, double spacing) {
    if (const auto corner = cornerOf(centre, 0.5 * spacing))
      lines += fmt::format("{}llcorner {}\n", axis, *corner);
    else
      lines += fmt::format("{}llcenter {}\n", axis, centre);
  };
  add('x', grid.origin_x, grid.spacing_x);
  add('y', grid.origin_y, grid.spacing_y);
  return lines;
}

}  // namespace

Result<Exported> writeAsciiGrid(const Version& field, const std::string& path, const ExportOptions&,
                                JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const float no_data = freeNoData(reader);
  TextWriter out{*file};
  out.text = fmt::format("ncols {}\nnrows {}\n{}", grid.width, grid.height, originLines(grid));
  out.text += grid.spacing_x == grid.spacing_y
                  ? fmt::format("cellsize {}\n", grid.spacing_x)
                  : fmt::format("dx {}\ndy {}\n", grid.spacing_x, grid.spacing_y);
  out.text += fmt::format("NODATA_value {}\n", no_data);
  std::vector<float> heights(static_cast<std::size_t>(grid.width));
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  for (std::int32_t row = grid.height - 1; row >= 0; --row) {
    reader.readHeights(0, row, grid.width, 1, heights.data(), grid.width);
    for (const float height : heights)
      fmt::format_to(std::back_inserter(out.text), "{} ", std::isnan(height) ? no_data : height);
    out.text.back() = '\n';
    if (Status status = out.settle(); !status) return tl::unexpected(status.error());
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  if (Status status = out.finish(); !status) return tl::unexpected(status.error());
  if (Status status = file->commit(); !status) return tl::unexpected(status.error());
  Exported exported{"AAIGrid", {}};
  if (!grid.crs_wkt.empty()) exported.warnings.emplace_back("an ASCII grid keeps no coordinate system");
  if (grid.lateral_unit != LengthUnit{} || grid.height_unit != LengthUnit{})
    exported.warnings.push_back(
        grid.lateral_unit == grid.height_unit
            ? fmt::format("an ASCII grid keeps no unit, read it with --unit {}", grid.lateral_unit.name)
            : fmt::format("an ASCII grid keeps no units ({} across, {} up)", grid.lateral_unit.name,
                          grid.height_unit.name));
  return exported;
}

}  // namespace fettle::engine
