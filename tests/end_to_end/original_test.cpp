// What --max-change is measured against: the scan that the work began with, however many commands it took.

#include <cmath>
#include <cstdlib>

#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "engine/filter/filter.h"
#include "engine/formats/formats.h"
#include "engine/session/session.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

constexpr double kMost = 0.01;  // mm

class Original : public testing::Test {
 protected:
  void SetUp() override {
    setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
    ASSERT_EQ(fettle({"synth", scan, "--size", "128x96", "--noise", "3"}).status, 0);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder.file(name); }
  /// How far a field is from the scan at most [mm].
  [[nodiscard]] double away(const std::string& path) const {
    return fettleJson({"compare", scan, path})["max_abs"];
  }
  /// A filter that would take every sample far, held by --max-change 0.01. Its hash.
  static std::string filtered(const std::string& in, const std::string& out, const std::string& filter,
                              const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"filter", in,         out, "--filter",     filter, "--window",
                                       "9",      "--passes", "3", "--max-change", "0.01"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fettleJson(arguments)["hash"];
  }
  // A brush over the middle of the scan, pressed deep.
  void writeStrokes() const {
    engine::JobControl job;
    const auto imported = engine::importField(scan, {}, job);
    ASSERT_TRUE(imported);
    const engine::Grid& grid = imported->field.grid();
    std::ofstream strokes(file("strokes.csv"));
    strokes << "t,x,y,z,tool\n";
    for (int k = 0; k < 400; ++k) {
      const int column = 10 + k / 4, row = 48;
      const double height = imported->field.reader().heightAt(column, row);
      if (std::isnan(height)) continue;
      strokes << 0.001 * k << ',' << column * grid.spacingXMm() << ',' << row * grid.spacingYMm() << ','
              << height - 0.5 << ",smooth\n";
    }
    std::ofstream(file("scene.toml")) << "[brush]\nradius_samples = 6\nmax_change = 0.01\n";
  }

  TempFolder folder;
  std::string scan = folder.file("scan.tif");
};

TEST_F(Original, IsTheScanOverBrushAndFiltersWhenItIsNamed) {
  writeStrokes();
  const std::string brushed = file("brushed.tif");
  const auto report =
      fettleJson({"replay", scan, file("strokes.csv"), brushed, "--scene", file("scene.toml")});
  EXPECT_GT(report["samples_changed"], 100);
  (void)filtered(brushed, file("1.tif"), "box", {"--original", scan});
  (void)filtered(file("1.tif"), file("2.tif"), "gaussian", {"--original", scan});
  EXPECT_LE(away(file("2.tif")), kMost);
  // The brush after a filter, too.
  ASSERT_EQ(fettle({"replay", file("2.tif"), file("strokes.csv"), file("3.tif"), "--scene",
                    file("scene.toml"), "--original", scan})
                .status,
            0);
  EXPECT_LE(away(file("3.tif")), kMost);
  // Unnamed it is what each command reads.
  (void)filtered(brushed, file("1.tif"), "box");
  EXPECT_GT(away(file("1.tif")), 1.5 * kMost);
}

TEST_F(Original, IsTheSessionsOwnAsInTheWindow) {
  // As the window leaves it after a filter held within 0.01.
  engine::JobControl job;
  const auto imported = engine::importField(scan, {}, job);
  ASSERT_TRUE(imported);
  engine::FilterSpec spec;
  spec.window = 9;
  spec.passes = 3;
  spec.max_change = kMost;
  const auto first = engine::applyFilter(imported->field, imported->field, spec, job);
  ASSERT_TRUE(first);
  engine::Session session;
  session.original = imported->field;
  session.history = engine::History(imported->field);
  session.history.push({"Box", engine::StepKind::kFilter, {}, {}, 0}, first->field);
  const std::string work = file("work.fettle");
  ASSERT_TRUE(engine::saveSession(session, work, job));

  spec.kind = engine::FilterKind::kGaussian;
  const auto second = engine::applyFilter(first->field, imported->field, spec, job);
  ASSERT_TRUE(second);
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx",
                static_cast<unsigned long long>(engine::contentHash(second->field)));
  EXPECT_EQ(filtered(work, file("a.tif"), "gaussian"), hash);
  EXPECT_LE(away(file("a.tif")), kMost);
  // What a command makes of a session keeps its original; so does a scan that becomes a session.
  (void)filtered(work, file("b.fettle"), "gaussian");
  (void)filtered(file("b.fettle"), file("c.fettle"), "box");
  ASSERT_EQ(fettle({"convert", file("c.fettle"), file("d.fettle")}).status, 0);
  (void)filtered(file("d.fettle"), file("e.tif"), "median");
  EXPECT_LE(away(file("e.tif")), kMost);
  (void)filtered(scan, file("f.fettle"), "box");
  (void)filtered(file("f.fettle"), file("g.tif"), "gaussian");
  EXPECT_LE(away(file("g.tif")), kMost);
}

TEST_F(Original, ThatCannotBeOneIsRefused) {
  const std::vector<std::string> limited{"--filter", "box", "--max-change", "0.01", "--original"};
  const auto ask = [&](const std::string& in, const std::string& original) {
    std::vector<std::string> arguments{"filter", in, file("out.tif")};
    arguments.insert(arguments.end(), limited.begin(), limited.end());
    arguments.push_back(original);
    return fettle(arguments);
  };
  ASSERT_EQ(fettle({"synth", file("small.tif"), "--size", "64x64"}).status, 0);
  expectRefused(ask(scan, file("small.tif")), "64 x 64");
  expectRefused(ask(scan, file("none.tif")), "none.tif");
  ASSERT_EQ(fettle({"convert", scan, file("work.fettle")}).status, 0);
  expectRefused(ask(file("work.fettle"), scan), "a session has its own original");
  expectRefused(fettle({"filter", scan, file("out.tif"), "--filter", "box", "--original", scan}),
                "there is no limit");
  expectRefused(ask(scan, file("out.tif")), "would replace an input");
  writeStrokes();
  expectRefused(
      fettle({"replay", scan, file("strokes.csv"), file("out.tif"), "--original", file("small.tif")}),
      "there is no limit");
}

TEST_F(Original, OnAnotherGridIsRefusedWithWhatDiffers) {
  const auto ask = [&](const std::string& in, const std::string& original) {
    return fettle(
        {"filter", in, file("out.tif"), "--filter", "box", "--max-change", "0.01", "--original", original});
  };
  engine::JobControl job;
  const auto imported = engine::importField(scan, {}, job);
  ASSERT_TRUE(imported);
  const auto placed = [&](const std::string& name, const std::function<void(engine::Grid&)>& change) {
    engine::Grid grid = imported->field.grid();
    change(grid);
    EXPECT_TRUE(engine::exportField(imported->field.withGrid(grid), file(name), {}, job));
    return file(name);
  };
  expectRefused(ask(scan, placed("shift.tif", [](engine::Grid& g) { g.origin_x += 100.0; })),
                "the origin of the original is ");
  expectRefused(ask(scan, placed("half.tif", [](engine::Grid& g) { g.origin_y += 0.5 * g.spacing_y; })),
                "the origin of the original is ");
  expectRefused(ask(scan, placed("wide.tif", [](engine::Grid& g) { g.spacing_x *= 1.01; })),
                "the spacing of the original is ");
  EXPECT_FALSE(std::filesystem::exists(file("out.tif")));
  // What a format rounds or does not keep is no other grid.
  const std::string close = placed("close.tif", [](engine::Grid& g) {
    g.origin_x += 1e-3 * g.spacing_x;
    g.spacing_y *= 1.0 + 1e-7;
  });
  for (const std::string& name : {close, file("a.asc"), file("a.xyz"), file("a.png"), file("a.ply")}) {
    if (name != close) {
      ASSERT_EQ(fettle({"convert", scan, name}).status, 0);
    }
    const Outcome taken = ask(name, scan);
    EXPECT_EQ(taken.status, 0) << name << ": " << taken.err;
  }
}

}  // namespace
}  // namespace fettle::tests
