// A field's surface as triangles: STL, and PLY with faces.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/format.h"
#include "engine/io/mesh/ply_header.h"
#include "engine/io/mesh/stl_file.h"
#include "engine/io/mesh/surface_mesh.h"

namespace fettle::engine {

namespace {

// Warnings about what the triangles leave out.
std::vector<std::string> describe(const SurfaceMesh& mesh, const Version& field, const ExportOptions& options,
                                  std::uint64_t triangles) {
  const Grid& grid = field.grid();
  std::vector<std::string> warnings;
  if (options.max_error)
    warnings.push_back(fmt::format("decimated to {} triangles of {}: no sample is off by more than {:.3g} {}",
                                   triangles, 2 * std::int64_t{grid.width - 1} * (grid.height - 1),
                                   mesh.error(), grid.height_unit.name));
  if (!grid.crs_wkt.empty()) warnings.emplace_back("a mesh stores no coordinate system");
  if (field.reader().root().holed_children != 0)
    warnings.emplace_back("cells next to a hole have no surface and were left out");
  return warnings;
}

struct Counted {
  std::uint64_t triangles = 0;
  std::vector<bool> used;
};
Result<Counted> count(const SurfaceMesh& mesh, const Grid& grid, const std::string& path) {
  Counted all;
  all.used.resize(static_cast<std::size_t>(grid.samples()));
  mesh.forEach([&](const SurfaceMesh::Triangle& t) {
    ++all.triangles;
    for (const std::uint64_t corner : t) all.used[corner] = true;
  });
  if (all.triangles == 0)
    return inputError("the field has no cell without a hole, so no surface", path, "write it as points");
  if (all.triangles > std::numeric_limits<std::uint32_t>::max())
    return inputError(fmt::format("{} triangles are more than the format can count", all.triangles), path,
                      "decimate with --max-error or cut the scan into parts");
  return all;
}

// Writes triangles from a callback into a file, piece by piece; after an error the rest is ignored.
Status writeTriangles(const SurfaceMesh& mesh, TextWriter& out, std::uint64_t triangles, JobControl& job,
                      auto&& append_one) {
  constexpr std::uint64_t kLook = 65536;
  job.begin("writing", triangles);
  Status status;
  std::uint64_t done = 0;
  mesh.forEach([&](const SurfaceMesh::Triangle& t) {
    if (!status) return;
    append_one(t, out.text);
    if (++done % kLook != 0) return;
    job.advance(kLook);
    status = job.cancelled() ? Status(cancelled()) : out.flushIfLarge();
  });
  return status ? out.flush() : status;
}

}  // namespace

// The surface as triangles, binary; x and y from the field's corner, float32, all in one unit.
Result<Exported> writeStl(const Version& field, const std::string& path, const ExportOptions& options,
                          JobControl& job) {
  const Grid& grid = field.grid();
  const Result<SurfaceMesh> mesh = SurfaceMesh::create(field, options.max_error, job);
  if (!mesh) return tl::unexpected(mesh.error());
  const Result<Counted> all = count(*mesh, grid, path);
  if (!all) return tl::unexpected(all.error());
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  TextWriter out{*file};
  const LengthUnit& unit = options.mesh_unit ? *options.mesh_unit : grid.lateral_unit;
  // 1.0 in equal units, which changes no bit.
  const double xy_unit = grid.lateral_unit.mm / unit.mm, z_unit = grid.height_unit.mm / unit.mm;
  const glm::dvec2 zero = glm::dvec2(grid.origin_x, grid.origin_y) * xy_unit;
  out.text = stlHeader(unit, zero);
  appendLittle(out.text, static_cast<std::uint32_t>(all->triangles));
  const auto width = static_cast<std::uint64_t>(grid.width);
  const Status status =
      writeTriangles(*mesh, out, all->triangles, job, [&](const SurfaceMesh::Triangle& t, std::string& text) {
        std::array<std::array<double, 3>, 3> p{};
        for (std::size_t k = 0; k < 3; ++k)
          p[k] = {static_cast<double>(t[k] % width) * grid.spacing_x * xy_unit,
                  static_cast<double>(t[k] / width) * grid.spacing_y * xy_unit,
                  static_cast<double>(mesh->height(t[k])) * z_unit};
        std::array<double, 3> u{}, v{};
        for (std::size_t k = 0; k < 3; ++k) {
          u[k] = p[1][k] - p[0][k];
          v[k] = p[2][k] - p[0][k];
        }
        const std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                      u[0] * v[1] - u[1] * v[0]};
        const double length = std::hypot(n[0], n[1], n[2]);
        for (const double component : n) appendLittle(text, static_cast<float>(component / length));
        for (const auto& corner : p)
          for (const double coordinate : corner) appendLittle(text, static_cast<float>(coordinate));
        appendLittle(text, std::uint16_t{0});
      });
  if (!status) return tl::unexpected(status.error());
  if (Status done = file->commit(); !done) return tl::unexpected(done.error());
  std::vector<std::string> warnings = describe(*mesh, field, options, all->triangles);
  warnings.push_back(fmt::format("STL has no units, all lengths are in {}", unit.name));
  if (xy_unit != 1.0 || z_unit != 1.0)
    warnings.push_back(fmt::format(
        "{} were converted to {}, each number rounded by up to 6e-8 of it",
        xy_unit == 1.0  ? fmt::format("heights in {}", grid.height_unit.name)
        : z_unit == 1.0 ? fmt::format("x and y in {}", grid.lateral_unit.name)
        : grid.lateral_unit.name == grid.height_unit.name
            ? fmt::format("lengths in {}", grid.lateral_unit.name)
            : fmt::format("x and y in {} and heights in {}", grid.lateral_unit.name, grid.height_unit.name),
        unit.name));
  if (zero != glm::dvec2(0.0))
    warnings.push_back(
        fmt::format("STL has few digits: x and y are relative to the field's corner at {}, {}, which its "
                    "header states for Fettle alone",
                    zero.x, zero.y));
  return Exported{"STL", std::move(warnings)};
}

Result<Exported> writePlyMesh(const Version& field, const std::string& path, const ExportOptions& options,
                              JobControl& job) {
  const Grid& grid = field.grid();
  const Result<SurfaceMesh> mesh = SurfaceMesh::create(field, options.max_error, job);
  if (!mesh) return tl::unexpected(mesh.error());
  const Result<Counted> all = count(*mesh, grid, path);
  if (!all) return tl::unexpected(all.error());
  // Corners are numbered in the order of their samples.
  std::vector<std::uint32_t> number(all->used.size());
  std::uint32_t corners = 0;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (all->used[i]) number[i] = corners++;
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  TextWriter out{*file};
  out.text = "ply\nformat binary_little_endian 1.0\n" + plyRasterComments(grid);
  out.text += fmt::format(
      "element vertex {}\nproperty double x\nproperty double y\nproperty float z\nelement face {}\nproperty "
      "list uchar uint vertex_indices\nend_header\n",
      corners, all->triangles);
  const auto width = static_cast<std::uint64_t>(grid.width);
  for (std::uint64_t i = 0; i < number.size(); ++i) {
    if (!all->used[i]) continue;
    appendLittle(out.text, grid.origin_x + static_cast<double>(i % width) * grid.spacing_x);
    appendLittle(out.text, grid.origin_y + static_cast<double>(i / width) * grid.spacing_y);
    appendLittle(out.text, mesh->height(i));
    if (Status status = out.flushIfLarge(); !status) return tl::unexpected(status.error());
  }
  const Status status =
      writeTriangles(*mesh, out, all->triangles, job, [&](const SurfaceMesh::Triangle& t, std::string& text) {
        appendLittle(text, std::uint8_t{3});
        for (const std::uint64_t corner : t) appendLittle(text, number[corner]);
      });
  if (!status) return tl::unexpected(status.error());
  if (Status done = file->commit(); !done) return tl::unexpected(done.error());
  std::vector<std::string> warnings = describe(*mesh, field, options, all->triangles);
  if (grid.lateral_unit != grid.height_unit)
    warnings.push_back(fmt::format("x and y are in {}, z in {}: only a comment in the file states this",
                                   grid.lateral_unit.name, grid.height_unit.name));
  return Exported{"PLY", std::move(warnings)};
}

}  // namespace fettle::engine
