#include "bench/render_scenes.h"

#include <cmath>
#include <tuple>
#include <utility>

#include "bench/bench_forms.h"
#include "engine/field/builder.h"

namespace fettle::bench {
namespace {

double plateNoise(std::int32_t c, std::int32_t r) {
  auto h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return (h >> 8U) / 8388608.0 - 1.0;
}

// What depends on the field's size.
std::vector<Scene> frameScenes(const Scene& all_round) {
  std::vector<Scene> scenes(9, all_round);
  scenes[1].name = "empty";
  scenes[1].input.view.zoom = 1e-3;
  scenes[2].name = "brush";
  scenes[3].name = "brush, still";
  scenes[4].name = "brush, whole";
  scenes[4].input.redraw = render::FrameInput::Redraw::kAll;
  for (const std::size_t k : {2, 3, 4}) scenes[k].brush = Brush::kWorks;
  scenes[5].name = "stylus, still";
  scenes[5].stylus = Stylus::kLines;
  // As the window draws a picture at rest.
  scenes[6].name = "fine";
  scenes[7].name = "fine, brush";
  scenes[8].name = "rest, a band";
  scenes[8].input.sharpness = render::Sharpness::kRest;
  for (const std::size_t k : {6, 7, 8}) scenes[k].input.vertex_budget = std::int64_t{1} << 20;
  scenes[7].brush = Brush::kWorks;
  for (const std::size_t k : {3, 4, 5, 7}) scenes[k].camera = Camera::kFixed;
  scenes[8].camera = Camera::kRests;
  // Shaded as in the window.
  for (const std::size_t k : {2, 3, 4, 5, 6, 7, 8}) scenes[k].input.form = render::kShownForm;
  return scenes;
}

// Pieces of edge lines as those of a scan with many of them, which lie on the surface.
void putEdgeLines(render::Overlays& overlays) {
  constexpr int kLines = 40, kPieces = 100;
  for (int line = 0; line < kLines; ++line)
    for (int piece = 0; piece < kPieces; ++piece) {
      const auto at = [&](int k) {
        return glm::dvec3(2.0 + 60.0 * k / kPieces, 2.0 + 60.0 * line / kLines + std::sin(0.2 * k), 2.0);
      };
      overlays.lines.push_back(
          {.from_mm = at(piece), .to_mm = at(piece + 1), .depth = render::OverlayLine::Depth::kInScene});
    }
}

// Each effect alone, beside the plain row: what is left out costs nothing.
engine::Status addEffects(const engine::Version& field, const Scene& all_round, std::vector<Scene>& scenes,
                          engine::JobControl& job) {
  const std::size_t first = scenes.size();
  scenes.insert(scenes.end(), 8, all_round);
  scenes[first].name = "contours";
  scenes[first].input.contours = render::Contours::kShow;
  scenes[first + 1].name = "deviation";
  scenes[first + 1].shown.original = field;
  scenes[first + 2].name = "marks";
  scenes[first + 2].shown.marks = render::MarksOverlay::kShow;
  scenes[first + 3].name = "two eyes";
  scenes[first + 3].input.stereo.mode = render::StereoMode::kAnaglyph;
  scenes[first + 4].name = "normals";
  scenes[first + 4].input.form.filtered_normals = true;
  scenes[first + 5].name = "occlusion";
  scenes[first + 5].input.form.occlusion = 0.8;
  scenes[first + 6].name = "cavity";
  scenes[first + 6].input.form.cavity = 0.5;
  scenes[first + 7].name = "material";
  scenes[first + 7].input.form.material = render::Material::kPorcelain;
  // What is seen under a form is drawn as any field; when a form comes or goes, all tiles are others.
  const auto seen = bentAndSeen(field, benchSphere(field.grid()), job);
  if (!seen) return tl::unexpected(seen.error());
  scenes.insert(scenes.end(), 2, all_round);
  scenes[first + 8].name = "under a sphere";
  scenes[first + 8].shown.versions = {*seen};
  scenes[first + 9].name = "sphere in, out";
  scenes[first + 9].shown.versions = {*seen->seenOf()};
  scenes[first + 9].other = *seen;
  for (const auto& [name, stylus] : {std::pair{"pen, still", Stylus::kPen},
                                     {"pen, shadow, still", Stylus::kPenAndShadow},
                                     {"trail, still", Stylus::kTrail}}) {
    scenes.push_back(scenes[5]);
    scenes.back().name = name;
    scenes.back().stylus = stylus;
  }

  // Two and four versions beside each other, and two in one plot.
  for (const auto& [name, count, arrangement] : {std::tuple{"split", 2, render::Arrangement::kSplit},
                                                 {"two panels", 2, render::Arrangement::kSideBySide},
                                                 {"four panels", 4, render::Arrangement::kSideBySide}}) {
    scenes.push_back(all_round);
    scenes.back().name = name;
    scenes.back().shown.versions.assign(static_cast<std::size_t>(count), field);
    scenes.back().input.arrangement = arrangement;
  }
  scenes.push_back(all_round);
  scenes.back().name = "edge lines";
  putEdgeLines(scenes.back().input.overlays);
  return {};
}

// While the camera moves, as the window draws.
void addMoving(const Scene& all_round, SceneSet set, std::vector<Scene>& scenes) {
  Scene moving = all_round;
  moving.name = "moving";
  moving.input.sharpness = render::Sharpness::kHalf;
  moving.input.form = render::kShownForm;
  if (set == SceneSet::kAll) {
    scenes.push_back(moving);
    scenes.back().name = "two, moving";
    scenes.back().input.stereo.mode = render::StereoMode::kAnaglyph;
    scenes.push_back(moving);
    scenes.back().name = "pen, moving";
    scenes.back().stylus = Stylus::kPenAndShadow;
  }
  scenes.insert(scenes.begin() + 1, moving);
  // As the window draws where these take too long.
  moving.name = "moving, a quarter";
  moving.input.sharpness = render::Sharpness::kQuarter;
  scenes.insert(scenes.begin() + 2, std::move(moving));
}

}  // namespace

engine::Result<engine::Version> benchPart(std::int32_t side) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = 64.0 / side;
  auto builder = engine::FieldBuilder::create(grid, "benchmark field");
  if (!builder) return tl::unexpected(builder.error());
  std::vector<float> row(static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r) {
    for (std::int32_t c = 0; c < side; ++c) {
      const double x = c * grid.spacing_x, y = r * grid.spacing_y;
      double z = 0.02 * x + 0.005 * plateNoise(c, r);
      if (std::hypot(x - 18, y - 40) < 9) z += 5;
      if (y > 8 && y < 12) z -= 3;
      const double dome = std::hypot(x - 45, y - 35);
      if (dome < 12) z += 0.5 * std::sqrt(144 - dome * dome);
      row[static_cast<std::size_t>(c)] = static_cast<float>(z);
    }
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return (*std::move(builder)).build();
}

Scene plainScene(const engine::Version& field, const render::FrameInput& plain) {
  return {"plain", {{field}, std::nullopt, {}, render::MarksOverlay::kHide}, plain};
}

engine::Result<std::vector<Scene>> renderScenes(const engine::Version& field, const render::FrameInput& plain,
                                                render::Sharpness in_motion, SceneSet set,
                                                engine::JobControl& job) {
  const Scene all_round = plainScene(field, plain);
  std::vector<Scene> scenes = frameScenes(all_round);
  if (set == SceneSet::kAll)
    if (const auto added = addEffects(field, all_round, scenes, job); !added)
      return tl::unexpected(added.error());
  if (in_motion == render::Sharpness::kHalf) addMoving(all_round, set, scenes);
  return scenes;
}

void putStylus(Stylus stylus, double way, render::Overlays& overlays) {
  constexpr int kTrailPieces = 60;
  overlays = {};
  const auto x = [](double at) { return 16.0 + 32.0 * at; };
  if (stylus == Stylus::kLines)
    render::appendStylus({{x(way), 20.0, 8.0}, {x(way), 20.0, 6.0}, {0.0, 0.0, 1.0}, true, 0.0}, 4.0,
                         overlays.lines);
  if (stylus == Stylus::kPen || stylus == Stylus::kPenAndShadow)
    overlays.stylus =
        render::StylusBody{.tip_mm = {x(way), 20.0, 6.0}, .shadow = stylus == Stylus::kPenAndShadow};
  for (int i = 0; stylus == Stylus::kTrail && i < kTrailPieces; ++i) {
    const auto at = [&](int k) { return glm::dvec3(x(way - 0.002 * k), 20.0 + std::sin(0.1 * k), 6.0); };
    overlays.lines.push_back(
        {.from_mm = at(i), .to_mm = at(i + 1), .depth = render::OverlayLine::Depth::kInScene});
  }
}

}  // namespace fettle::bench
