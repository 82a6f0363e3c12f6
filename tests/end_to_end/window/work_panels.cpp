#include "tests/end_to_end/window/work_panels.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {

using State = User::State;

void openPanels(const TempFolder& folder, const std::vector<std::string>& names) {
  State panels;
  for (const char* other : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[other] = false;
  for (const std::string& name : names) panels[name] = true;
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"edge_lines", false}, {"panels", panels}};
}

State settledWith(ViewProgram& program, const char* what, const std::function<bool(const State&)>& is) {
  return program.until(what, [&](const State& s) { return s["settled"] == true && is(s); });
}

State jsonOf(const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {FETTLE_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--json", "--quiet"});
  const Outcome outcome = runProcess(all);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.status == 0 ? State::parse(outcome.out) : State::object();
}

void layOnABall(const std::string& scan, double from) {
  const engine::Version part = load(scan);
  const engine::Grid& grid = part.grid();
  const double mm = grid.height_unit.mm, radius = 4.0 * grid.width * grid.spacingXMm();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  part.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double x = (c - from * grid.width) * grid.spacingXMm(),
                   y = (r - 0.5 * grid.height) * grid.spacingYMm();
      z[static_cast<std::size_t>(r * grid.width + c)] +=
          static_cast<float>((std::sqrt(radius * radius - x * x - y * y) - radius) / mm);
    }
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(engine::makeField(grid, z, {}), scan, {}, job));
}

void expectSameBall(const State& a, const State& b, double within) {
  EXPECT_NEAR(a["radius_mm"].get<double>(), b["radius_mm"].get<double>(), within);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(a["point_mm"][k].get<double>(), b["point_mm"][k].get<double>(), within) << k;
}

}  // namespace fettle::tests
