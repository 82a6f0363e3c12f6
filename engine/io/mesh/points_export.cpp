// A field as points, XYZ text and PLY: every sample that is not a hole, row by row from the lowest y.

#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/format.h"
#include "engine/io/grid_notes.h"
#include "engine/io/mesh/ply_header.h"

namespace fettle::engine {

namespace {

std::vector<std::string> whatIsLost(const Version& field) {
  const Grid& grid = field.grid();
  std::vector<std::string> warnings;
  if (field.reader().root().holed_children != 0)
    warnings.emplace_back("holes have no points and were left out");
  if (!grid.crs_wkt.empty()) warnings.emplace_back("points store no coordinate system");
  if (grid.lateral_unit != grid.height_unit)
    warnings.push_back(fmt::format("x and y are in {}, z in {}: only a comment in the file states this",
                                   grid.lateral_unit.name, grid.height_unit.name));
  return warnings;
}

// Calls append(x, y, z, text) for each point and writes the text.
Status writePoints(const Version& field, TextWriter& out, JobControl& job, auto&& append) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  std::vector<float> heights(static_cast<std::size_t>(grid.width));
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  for (std::int32_t row = 0; row < grid.height; ++row) {
    reader.readHeights(0, row, grid.width, 1, heights.data(), grid.width);
    const double y = grid.origin_y + row * grid.spacing_y;
    for (std::int32_t c = 0; c < grid.width; ++c)
      if (!std::isnan(heights[static_cast<std::size_t>(c)]))
        append(grid.origin_x + c * grid.spacing_x, y, heights[static_cast<std::size_t>(c)], out.text);
    if (Status status = out.flushIfLarge(); !status) return status;
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  return out.flush();
}

std::int64_t pointsIn(const Version& field) {
  return field.grid().samples() - summarize(field).no_data;
}

}  // namespace

// One "x y z" per sample that is not a hole, world coordinates, shortest exact digits; raster and units in
// comments.
Result<Exported> writeXyz(const Version& field, const std::string& path, const ExportOptions&,
                          JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  TextWriter out{*file};
  // CloudCompare reads names of columns from a first line that begins with //, GDAL ignores all lines that
  // begin with a slash, and neither accepts names or comments anywhere else.
  out.text = "//X Y Z\n";
  for (const std::string& line : rasterNotes(field.grid())) out.text += "// " + line + '\n';
  const Status status = writePoints(field, out, job, [](double x, double y, float z, std::string& text) {
    fmt::format_to(std::back_inserter(text), "{} {} {}\n", x, y, z);
  });
  if (!status) return tl::unexpected(status.error());
  if (Status done = file->commit(); !done) return tl::unexpected(done.error());
  return Exported{"XYZ", whatIsLost(field)};
}

// Binary little-endian points, double x and y, float z, world coordinates; raster and units in comments;
// with ExportOptions::mesh the surface: cells without a hole as triangles.
Result<Exported> writePly(const Version& field, const std::string& path, const ExportOptions& options,
                          JobControl& job) {
  if (options.mesh || options.max_error) return writePlyMesh(field, path, options, job);
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  TextWriter out{*file};
  out.text = "ply\nformat binary_little_endian 1.0\n" + plyRasterComments(field.grid());
  out.text +=
      fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty float z\nend_header\n",
                  pointsIn(field));
  const Status status = writePoints(field, out, job, [](double x, double y, float z, std::string& text) {
    appendLittle(text, x);
    appendLittle(text, y);
    appendLittle(text, z);
  });
  if (!status) return tl::unexpected(status.error());
  if (Status done = file->commit(); !done) return tl::unexpected(done.error());
  return Exported{"PLY", whatIsLost(field)};
}

}  // namespace fettle::engine
