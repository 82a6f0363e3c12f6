#include "engine/io/mesh/nominal_file.h"

#include <cmath>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/mesh/ply_mesh.h"
#include "engine/io/mesh/stl_file.h"

namespace fettle::engine {

namespace {

Result<StlMesh> wholeStl(const InputFile& file, const std::string& path, JobControl& job) {
  Result<StlMesh> read = readStlMesh(file, job);
  if (!read) return tl::unexpected(read.error());
  if (read->not_counted > 0)
    return inputError(
        fmt::format("its header counts {} triangles, its bytes are those of {}", read->mesh.triangles.size(),
                    read->mesh.triangles.size() + read->not_counted),
        path, "export it again: a nominal with a part missing is none");
  return read;
}

// A PLY's header is read by its words; what it states of units is for a scan.
Result<StlMesh> plyMesh(const InputFile& file, JobControl& job) {
  Result<TriangleMesh> mesh = readPlyMesh(file, job);
  if (!mesh) return tl::unexpected(mesh.error());
  StlMesh read;
  read.mesh = *std::move(mesh);
  return read;
}

}  // namespace

Result<NominalFile> readNominal(const std::string& path, const std::optional<LengthUnit>& unit,
                                JobControl& job) try {
  constexpr double kFarthest = 1e15;
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  std::vector<TriangleCorners> triangles;
  LengthUnit stated;
  {
    const Result<StlMesh> read = isPly(*file) ? plyMesh(*file, job) : wholeStl(*file, path, job);
    if (!read) return tl::unexpected(read.error());
    stated = unit ? *unit : read->header.unit.value_or(LengthUnit());
    const glm::dvec3 zero(read->header.zero, 0.0);
    const TriangleMesh& mesh = read->mesh;
    const PointCloud& corners = mesh.corners;
    triangles.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      TriangleCorners& triangle = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = mesh.triangles[t][k];
        if (i >= corners.x.size())
          return inputError(fmt::format("triangle {} has a corner past the last vertex", t + 1), path,
                            "the file is damaged: export it again");
        triangle[k] = stated.mm * (glm::dvec3(corners.x[i], corners.y[i], corners.z[i]) + zero);
        for (int axis = 0; axis < 3; ++axis)
          if (!(std::abs(triangle[k][axis]) <= kFarthest))
            return inputError(
                fmt::format("triangle {} has a corner that is not finite or beyond 1e15 mm", t + 1), path,
                "the file is damaged: export it again");
      }
    }
  }
  Result<NominalMesh> nominal = NominalMesh::create(std::move(triangles), path, job);
  if (!nominal) return tl::unexpected(nominal.error());
  return NominalFile{*std::move(nominal), std::move(stated)};
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", path, "export the mesh with a larger tolerance");
}

}  // namespace fettle::engine
