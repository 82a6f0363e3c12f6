#include "app/work/nominal_compare.h"

#include <utility>

#include <fmt/format.h>

#include "engine/io/files/input_file.h"
#include "engine/io/import.h"
#include "engine/io/mesh/nominal_file.h"
#include "engine/nominal/nominal_align.h"

namespace fettle::app {
namespace {

constexpr const char* kMostlyBeside = ", more than lie over one: does the mesh lie where the field does?";

std::vector<std::string> remarksOn(const engine::NominalMesh& mesh, const engine::NominalDeviation& found,
                                   bool shortest) {
  std::vector<std::string> remarks;
  if (mesh.withoutArea() > 0)
    remarks.push_back(fmt::format("{} triangles without an area were left out", mesh.withoutArea()));
  if (shortest && mesh.oddSides() > 0)
    remarks.push_back(fmt::format(
        "at {} sides triangles are wound in opposite senses or are more than two: near those the side on "
        "which a sample lies may be wrong",
        mesh.oddSides()));
  if (found.turned)
    remarks.emplace_back(
        "its triangles are wound clockwise seen from above: inside and outside were exchanged");
  if (found.face_down > 0)
    remarks.push_back(
        fmt::format("{} samples lie over triangles that are wound the other way round", found.face_down));
  if (found.no_nominal > 0)
    remarks.push_back(fmt::format("{} samples lie over no triangle{}", found.no_nominal,
                                  found.no_nominal > found.samples ? kMostlyBeside : ""));
  return remarks;
}

}  // namespace

bool isNominalFile(const std::string& path) {
  return engine::extensionOf(path) == ".stl";
}

engine::Result<NominalCompared> compareWithNominal(const engine::Version& part, const std::string& path,
                                                   const NominalChoice& choice,
                                                   const std::optional<engine::AlignOptions>& how,
                                                   engine::JobControl& job) {
  constexpr const char* kMove = "let it be moved, or say its unit";
  const auto read = engine::readNominal(path, engine::lengthUnitFromName(choice.unit), job);
  if (!read) return tl::unexpected(read.error());
  const engine::NominalMesh* const mesh = &read->mesh;
  NominalCompared compared;
  engine::RigidMotion motion;
  if (how) {
    auto found = engine::alignNominal(part, *mesh, *how, job);
    if (!found) return tl::unexpected(found.error());
    motion = found->motion;
    compared.alignment = *std::move(found);
  } else {
    const auto placed = engine::placedAsStored(*mesh, part.grid());
    if (!placed) return engine::inputError("the mesh lies nowhere over or under the field", path, kMove);
    motion = placed->motion;
  }
  engine::NominalOptions options;
  if (choice.shortest) options.distance = engine::NominalDistance::kShortest;
  if (choice.tolerance > 0.0) options.tolerance = choice.tolerance;
  auto found = engine::deviationFromNominal(part, *mesh, motion, options, job);
  if (!found) return tl::unexpected(found.error());
  if (found->samples == 0) return engine::inputError("no sample lies over or under a triangle", path, kMove);
  compared.remarks = remarksOn(*mesh, *found, choice.shortest);
  compared.deviation = *std::move(found);
  return compared;
}

}  // namespace fettle::app
