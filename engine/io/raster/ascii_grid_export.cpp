#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/format.h"
#include "engine/io/geo/crs_text.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/geo/sidecar.h"

namespace fettle::engine {

namespace {

// A number for "no data" that is not a height of the field: -9999 if possible, otherwise below or above all
// heights; for a field that fills the range of the float, NaN, which not every reader accepts.
float freeNoData(const FieldReader& reader) {
  const HeightBounds bounds = reader.bounds();
  if (bounds.empty() || bounds.min > -9999.0F || bounds.max < -9999.0F) return -9999.0F;
  for (float value = -99999.0F; value > -3.0e38F; value *= 10.0F)
    if (value < bounds.min) return value;
  return bounds.max < 3.4e38F ? 3.4e38F : std::numeric_limits<float>::quiet_NaN();
}

// xllcorner, which every reader supports; where no corner gives the origin bit-identical, xllcenter.
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

// Commits the grid, and before it its .prj. An existing .prj that does not belong to the grid would be read
// with it: a warning is given, and it is not removed, since it may belong to another file as well.
Status commitBoth(AtomicFile& grid, const std::string& prj_path, const std::string& prj,
                  std::vector<std::string>& warnings) {
  std::error_code error;
  const bool there = std::filesystem::exists(prj_path, error);
  if (prj.empty()) {
    if (there)
      warnings.push_back(
          fmt::format("{} is there and names a coordinate system that the grid does not have: "
                      "remove it if it does not belong to another file",
                      prj_path));
    return grid.commit();
  }
  if (Status status = writeFileAtomically(prj_path, prj); !status) return status;
  Status status = grid.commit();
  if (!status && !there) std::filesystem::remove(prj_path, error);
  return status;
}

// What the file and the .prj next to it do not state.
std::vector<std::string> lostByAsciiGrid(const Grid& grid, bool system_kept) {
  std::vector<std::string> warnings;
  if (!grid.crs_wkt.empty() && !system_kept)
    warnings.emplace_back("a .prj file cannot express the coordinate system, it was left out");
  StatedUnits stated;
  std::vector<std::string> ignored;
  if (system_kept) unitsOfCrs(grid.crs_wkt, grid.origin_y, stated, ignored);
  const LengthUnit lateral = stated.lateral.value_or(LengthUnit{});
  const bool degrees = lateral.name == "deg";
  const LengthUnit height = stated.height.value_or(degrees ? LengthUnit{"m", 1000.0} : lateral);
  const bool lateral_kept = degrees ? grid.lateral_unit.name == "deg" : lateral == grid.lateral_unit;
  if (lateral_kept && height == grid.height_unit) return warnings;
  warnings.push_back(
      grid.lateral_unit == grid.height_unit
          ? fmt::format("an ASCII grid stores no unit, read it with --unit {}", grid.lateral_unit.name)
          : fmt::format("an ASCII grid stores no units ({} across, {} up)", grid.lateral_unit.name,
                        grid.height_unit.name));
  return warnings;
}

}  // namespace

// Every float with enough digits to be read back bit-identical, holes = a declared number (ESRI readers do
// not support NaN); anisotropic spacing as dx, dy; a coordinate system goes into a .prj file next to it,
// which is written before the grid.
Result<Exported> writeAsciiGrid(const Version& field, const std::string& path, const ExportOptions&,
                                JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  std::optional<GdalSession> quiet;
  if (!field.grid().crs_wkt.empty()) quiet.emplace();
  const std::string prj = field.grid().crs_wkt.empty() ? std::string() : prjOf(field.grid().crs_wkt);
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
    if (Status status = out.flushIfLarge(); !status) return tl::unexpected(status.error());
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  if (Status status = out.flush(); !status) return tl::unexpected(status.error());
  std::vector<std::string> warnings = lostByAsciiGrid(grid, !prj.empty());
  if (Status status = commitBoth(*file, prjPathOf(path), prj, warnings); !status)
    return tl::unexpected(status.error());
  return Exported{"AAIGrid", std::move(warnings)};
}

}  // namespace fettle::engine
