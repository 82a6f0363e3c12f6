#include "tests/numeric/support/touch_case.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"

namespace fettle::tests {

engine::Version TouchCase::field() const {
  engine::Grid grid;
  grid.width = columns;
  grid.height = std::max(2, static_cast<int>((heights.size() + static_cast<std::size_t>(columns) - 1) /
                                             static_cast<std::size_t>(columns)));
  std::vector<float> samples(static_cast<std::size_t>(grid.samples()), 0.0F);
  for (std::size_t i = 0; i < heights.size(); ++i)
    samples[i] = heights[i] == kGap ? NAN : static_cast<float>(heights[i]) / 16.0F;
  return engine::makeField(grid, samples);
}

std::vector<haptic::StrokeSample> TouchCase::strokes() const {
  std::vector<haptic::StrokeSample> rows;
  for (const Move& move : moves)
    rows.push_back({0.001 * static_cast<double>(rows.size()),
                    {move.x / 32.0, move.y / 32.0, move.z / 32.0},
                    haptic::Tool::kFeel});
  return rows;
}

haptic::Scene TouchCase::scene() const {
  engine::Grid grid;
  return sceneFor(choice, grid);
}

void showValue(const TouchCase& touch, std::ostream& out) {
  out << choiceName(touch.choice) << ", " << touch.columns << " columns, heights [1/16 mm]";
  for (const int z : touch.heights)
    out << ' ' << (z == TouchCase::kGap ? std::string("hole") : std::to_string(z));
  out << ", endpoints [1/32 mm]";
  for (const TouchCase::Move& m : touch.moves) out << " (" << m.x << ' ' << m.y << ' ' << m.z << ')';
}

rc::Gen<TouchCase> touchCases(Choice choice) {
  // One in 16 is a hole; a hole shrinks to 0.
  const auto height = rc::gen::map(rc::gen::inRange(0, 1024), [](int n) {
    return n >= 960 ? TouchCase::kGap : ((n + 1) / 2 % 32) * (n % 2 == 0 ? 1 : -1);
  });
  const auto move = rc::gen::apply(
      [](int x, int y, int z) {
        return TouchCase::Move{x, y, z};
      },
      rc::gen::inRange(0, 160), rc::gen::inRange(0, 160), rc::gen::inRange(-64, 65));
  return rc::gen::apply(
      [choice](int columns, std::vector<int> heights, std::vector<TouchCase::Move> moves) {
        return TouchCase{columns, std::move(heights), std::move(moves), choice};
      },
      rc::gen::inRange(2, 7), rc::gen::container<std::vector<int>>(height),
      rc::gen::container<std::vector<TouchCase::Move>>(move));
}

namespace {

std::string writeCase(const TouchCase& touch, const std::string& folder) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path in = folder;
  const std::string scan = (in / "scan.tif").string();
  const std::string strokes = (in / "strokes.csv").string();
  const std::string scene = (in / "scene.toml").string();
  engine::JobControl job;
  const auto exported = engine::exportField(touch.field(), scan, {}, job);
  EXPECT_TRUE(exported) << exported.error().line();
  const auto written = haptic::writeStrokes(strokes, touch.strokes());
  EXPECT_TRUE(written) << written.error().line();
  std::ofstream(scene) << haptic::sceneText(touch.scene());
  return fmt::format("fettle replay {} {} {} --scene {} --forces {}", scan, strokes,
                     (in / "out.tif").string(), scene, (in / "forces.csv").string());
}

}  // namespace

std::optional<SmallestCase> findBroken(const std::string& name, Choice choice, const TouchProperty& property,
                                       const std::string& folder) {
  // Shrinking continues from a case only when it is broken too: the last broken one is the smallest.
  std::optional<SmallestCase> smallest;
  // 100 cases a check, RapidCheck's default; RC_PARAMS sets seed and more.
  bool holds = true;
  for (int round = 0; holds && round < 5; ++round)
    holds = rc::check(name, [&] {
      const TouchCase touch = *touchCases(choice);
      if (const auto problem = property(touch)) {
        smallest = SmallestCase{touch, *problem, {}};
        RC_FAIL(*problem);
      }
    });
  if (holds) return std::nullopt;
  smallest->command = writeCase(smallest->touch, folder);
  std::printf("%s: %s\n", smallest->problem.c_str(), smallest->command.c_str());
  return smallest;
}

}  // namespace fettle::tests
