// STL as a height field: its surface seen from above.

#include <string_view>
#include <utility>

#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/mesh/mesh_sampling.h"
#include "engine/io/mesh/stl_file.h"

namespace fettle::engine {

namespace {

bool looksLikeStl(std::string_view head, std::string_view extension) {
  return extension == ".stl" ||
         (head.starts_with("solid") && looksLikeText(head) && head.find("facet") != std::string_view::npos);
}

Result<Imported> readStl(const InputFile& file, const ImportOptions& options, JobControl& job) {
  Result<StlMesh> read = readStlMesh(file, job);
  if (!read) return tl::unexpected(read.error());
  read->mesh.corners.unit = read->header.unit;
  Result<Imported> field = sampleMesh(std::move(read->mesh), options, "STL", file.path(), job);
  if (!field || read->header.zero == glm::dvec2(0.0)) return field;
  Grid grid = field->field.grid();
  grid.origin_x += read->header.zero.x;
  grid.origin_y += read->header.zero.y;
  field->field = field->field.withGrid(grid);
  return field;
}

}  // namespace

constexpr std::string_view kStlExtensions[] = {".stl"};
constexpr Format kStlFormat{
    .info = {"STL", "STL mesh", kStlExtensions, true, true},
    .recognises = looksLikeStl,
    .read = readStl,
    .write = writeStl,
    .mesh = true,
};

}  // namespace fettle::engine
