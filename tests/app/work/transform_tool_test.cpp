// The panel Transform without the window: the form over the field goes along, or it is said that it does not.
#include "app/work/transform_tool.h"

#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

constexpr int kAcross = 90, kDown = 70;
constexpr double kApart = 0.1, kBallMm = 40.0;  // [mm]

engine::Version waveOnABall() {
  return tests::fieldOf(
      kAcross, kDown,
      [](int c, int r) {
        const double x = kApart * (c - 30), y = kApart * (r - 20);
        return std::sqrt(kBallMm * kBallMm - x * x - y * y) - kBallMm + 0.01 * std::sin(0.3 * c);
      },
      kApart, kApart);
}

// `spacing`: that of the field which the form says it lies over.
engine::Version underABall(double spacing) {
  engine::ShapeForm ball;
  ball.width = kAcross;
  ball.height = kDown;
  ball.spacing_x_mm = spacing;
  ball.spacing_y_mm = kApart;
  ball.column = 30.0;
  ball.row = 20.0;
  ball.curvature = -1.0 / kBallMm;
  engine::JobControl job;
  const engine::Version under =
      waveOnABall().withForm(std::make_shared<const engine::NominalForm>(engine::NominalForm(ball)));
  return engine::SeenField::of(under, job)->seen();
}

struct MadeSession {
  engine::Version field;
  std::vector<Notice> notices;
};

MadeSession madeOf(const engine::Version& field) {
  const tests::TempFolder folder;
  tests::LoopClientBench bench(field);
  TransformTool tool;
  tool.options.angle_deg = 30.0;
  tool.write(bench.client(), {}, folder.file("made.fettle"));
  std::optional<std::string> path;
  EXPECT_TRUE(bench.until([&] {
    if (auto done = tool.poll(bench.noticesToFill())) path = done;
    return !tool.busy();
  }));
  EXPECT_TRUE(path);
  engine::JobControl job;
  const auto read = engine::importField(folder.file("made.fettle"), {}, job);
  EXPECT_TRUE(read);
  return {read ? read->field : field, bench.notices()};
}

TEST(TransformToolTest, AFormGoesAlongWithoutAWord) {
  const MadeSession made = madeOf(underABall(kApart));
  ASSERT_NE(made.field.formOver(), nullptr);
  ASSERT_NE(made.field.formOver()->shape(), nullptr);
  EXPECT_NEAR(made.field.formOver()->shape()->curvature, -1.0 / kBallMm, 1e-12);
  EXPECT_TRUE(made.notices.empty());
}

TEST(TransformToolTest, AFormThatCannotGoAlongIsNamedInANotice) {
  // As of a session that is read with another spacing along rows: turned it would be no ball.
  const MadeSession made = madeOf(underABall(2.0 * kApart));
  EXPECT_EQ(made.field.formOver(), nullptr);
  ASSERT_EQ(made.notices.size(), 1U);
  EXPECT_NE(made.notices[0].what.find("has no place over the new samples"), std::string::npos);
}

}  // namespace
}  // namespace fettle::app
