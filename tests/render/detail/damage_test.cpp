// Frames drawn in parts against frames drawn as a whole, bit for bit.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "engine/field/live_field.h"
#include "render/live/live_picture.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

double noise(int c, int r) {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return (h >> 8U) / 16777216.0;
}

enum class Holes { kNone, kSome };

engine::Version part(int w, int h, Holes holes) {
  return fieldOf(
      gridOf(w, h, 0.1, 0.1),
      [&](int c, int r) -> double {
        const double x = c * 0.1, y = r * 0.1;
        if (holes == Holes::kSome && (std::hypot(x - 20, y - 30) < 2 || (c * 7 + r * 13) % 997 == 0))
          return kNan;
        double z = 0.02 * x + 0.01 * noise(c, r);
        if (std::hypot(x - 20, y - 30) < 9) z += 5;
        if (y > 8 && y < 12) z -= 3;
        return z;
      },
      [](int c, int) { return c % 50 == 0; });
}

// Where samples lie: all of them on the device, or in pages of a pool of so many bytes.
constexpr std::int64_t kWhole = 0, kPages = 1'200'000;

class Twins {
 public:
  explicit Twins(std::int64_t device_bytes = kWhole) {
    LiveOptions options;
    options.validation = Validation::kOn;
    options.memory_budget_bytes = device_bytes;
    auto created = LivePicture::create(options);
    if (created) picture_ = *std::move(created);
  }
  [[nodiscard]] LivePicture& picture() { return *picture_; }

  // The next frame in parts, or the first of those that pages keep coming with, then the same as a whole;
  // equal to the last bit. How much the first drew again.
  double shoot(FrameInput input) {
    Image parts, whole;
    input.redraw = FrameInput::Redraw::kChanged;
    auto first = picture_->draw(input, parts);
    const double drawn = first ? first->redrawn : -1.0;
    while (first && first->residency.pages_loaded + first->residency.pages_waiting > 0)
      first = picture_->draw(input, parts);
    if (first) by_need_ = first->residency.on_demand;
    input.redraw = FrameInput::Redraw::kAll;
    const auto second = picture_->draw(input, whole);
    if (!first || !second) {
      ADD_FAILURE() << (first ? second : first).error().line();
      return -1.0;
    }
    EXPECT_EQ(second->redrawn, 1.0);
    int off = 0;
    for (std::size_t i = 0; i < parts.rgba.size(); ++i) off += parts.rgba[i] != whole.rgba[i];
    EXPECT_EQ(off, 0) << "channels differ, drawn again: " << first->redrawn;
    for (const std::string& message : picture_->validationMessages()) ADD_FAILURE() << message;
    return drawn;
  }
  [[nodiscard]] bool onDemand() const noexcept { return by_need_; }

 private:
  bool by_need_ = false;
  std::unique_ptr<LivePicture> picture_;
};

FrameInput smallInput() {
  FrameInput input;
  input.view.width = 360;
  input.view.height = 240;
  return input;
}

class DamageOverEdits : public testing::TestWithParam<std::tuple<Holes, std::int64_t>> {};

TEST_P(DamageOverEdits, FramesInPartsEqualWholeOnes) {
  std::mt19937 random(20261121);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const auto [holes, device_bytes] = GetParam();
  Twins twins(device_bytes);
  const engine::Version start = part(640, 480, holes);
  auto live = std::make_unique<engine::LiveField>(start, engine::Growth::kAllowed);
  Shown shown;
  shown.versions = {start};
  shown.marks = MarksOverlay::kShow;
  ASSERT_TRUE(twins.picture().update(shown));
  FrameInput input = smallInput();
  double drawn = 0.0;
  int parts = 0;
  std::vector<engine::Version> undo{start};
  for (int step = 0; step < 24; ++step) {
    SCOPED_TRACE(testing::Message() << "step " << step << " holes " << static_cast<int>(holes));
    const bool moves = step % 10 == 0;
    if (moves) {
      input.view.azimuth_deg = below(360);
      input.view.elevation_deg = 15 + below(76);
      input.view.zoom = 0.4 + 0.1 * below(60);
      input.view.projection = below(2) == 0 ? Projection::kOrthographic : Projection::kPerspective;
      input.contours = below(2) == 0 ? Contours::kShow : Contours::kHide;
      input.vertex_budget = 4096 << below(5);
    }
    const int what = below(6);
    if (what == 0 && undo.size() > 1) {
      undo.pop_back();
      live = std::make_unique<engine::LiveField>(undo.back(), engine::Growth::kAllowed);
    } else if (what == 1) {
      const int c = below(600), r = below(440);
      for (int i = 0; i < 30; ++i) ASSERT_TRUE(live->setMark(c + i, r + i, i % 3 != 0));
      undo.push_back(live->snapshot());
    } else if (what == 2) {
      // Only what lies over the surface.
      input.overlays.lines.clear();
      appendStylus({{5.0 + below(50), 24, 6}, {30, 24, 3}, {0, 0, 1}, true, 1.0}, 4.0, input.overlays.lines);
    } else {
      const int w = 1 + below(40), h = 1 + below(40), c = below(640 - w), r = below(480 - h);
      std::vector<float> z(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
      live->reader().readHeights(c, r, w, h, z.data(), w);
      const float by = 0.01F * static_cast<float>(below(400) - 200);
      for (float& x : z) x += by;
      if (holes == Holes::kSome && below(4) == 0) z[z.size() / 2] = static_cast<float>(kNan);
      ASSERT_TRUE(live->writeHeights(c, r, w, h, z.data(), w));
      undo.push_back(live->snapshot());
    }
    shown.versions = {undo.back()};
    ASSERT_TRUE(twins.picture().update(shown));
    const double share = twins.shoot(input);
    if (moves) {
      EXPECT_EQ(share, 1.0);
      continue;
    }
    ++parts;
    drawn += share;
  }
  // A brush of 40 samples is a fifteenth of the field's width; zoomed in it fills the picture.
  EXPECT_LT(drawn / parts, 0.6);
  EXPECT_EQ(twins.onDemand(), device_bytes != kWhole);
}
INSTANTIATE_TEST_SUITE_P(, DamageOverEdits,
                         testing::Combine(testing::Values(Holes::kNone, Holes::kSome),
                                          testing::Values(kWhole, kPages)),
                         [](const auto& about) {
                           return std::string(std::get<0>(about.param) == Holes::kSome ? "Holed" : "Full") +
                                  (std::get<1>(about.param) == kWhole ? "Whole" : "Pages");
                         });

TEST(Damage, NothingIsDrawnAnewWhereNothingChangedAndLittleUnderABrush) {
  Twins twins;
  const engine::Version start = part(1024, 1024, Holes::kNone);
  Shown shown;
  shown.versions = {start};
  ASSERT_TRUE(twins.picture().update(shown));
  FrameInput input = smallInput();
  input.view.centre_x = input.view.centre_y = 0.5;
  EXPECT_EQ(twins.shoot(input), 1.0);
  EXPECT_EQ(twins.shoot(input), 0.0);
  input.overlays.rings = {{50, 50, 4, {1, 1, 1}, 2}};
  EXPECT_EQ(twins.shoot(input), 0.0);
  engine::LiveField live(start, engine::Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(700, 700, 0.5F));
  shown.versions = {live.snapshot()};
  ASSERT_TRUE(twins.picture().update(shown));
  const double share = twins.shoot(input);
  EXPECT_GT(share, 0.0);
  EXPECT_LT(share, 0.05);
  // Whatever else changes is drawn as a whole.
  input.light_azimuth_deg = 10;
  EXPECT_EQ(twins.shoot(input), 1.0);
  input.colouring.map = ColourMap::kGrey;
  EXPECT_EQ(twins.shoot(input), 1.0);
  shown.versions = {live.snapshot().inverted()};
  ASSERT_TRUE(twins.picture().update(shown));
  EXPECT_EQ(twins.shoot(input), 1.0);
  input.view.width = 500;
  EXPECT_EQ(twins.shoot(input), 1.0);
}

// From above heights move no pixel: patches are as coarse as can be, and a stroke lies between their vertices.
TEST(Damage, LittleIsDrawnAnewUnderABrushBetweenTheVerticesOfCoarsePatches) {
  for (const Holes holes : {Holes::kNone, Holes::kSome}) {
    SCOPED_TRACE(static_cast<int>(holes));
    Twins twins;
    const engine::Version start = part(1000, 700, holes);
    engine::LiveField live(start, engine::Growth::kAllowed);
    Shown shown;
    shown.versions = {start};
    ASSERT_TRUE(twins.picture().update(shown));
    FrameInput input = smallInput();
    input.view.elevation_deg = 90;
    input.view.azimuth_deg = 0;
    input.range = ValueRange{-4, 9};
    EXPECT_EQ(twins.shoot(input), 1.0);
    const auto edited = [&](int column, int row) {
      for (int i = 0; i < 9; ++i) EXPECT_TRUE(live.setHeight(column + i % 3, row + i / 3, 4.0F));
      shown.versions = {live.snapshot()};
      EXPECT_TRUE(twins.picture().update(shown));
      return twins.shoot(input);
    };
    for (const auto& [column, row] : {std::pair{700, 600}, {333, 111}, {905, 350}})
      EXPECT_LT(edited(column, row), 0.02) << column << " " << row;
    // Vertices of every patch, and those of the last column and row, whatever the stride.
    for (const auto& [column, row] : {std::pair{511, 511}, {255, 383}, {997, 200}, {400, 697}, {997, 697}})
      EXPECT_GT(edited(column, row), 0.0) << column << " " << row;
  }
}

TEST(Damage, PanelsBesideEachOtherAndSplitAreDrawnInPartsEachForItself) {
  for (const Arrangement arrangement : {Arrangement::kSideBySide, Arrangement::kSplit}) {
    Twins twins;
    const engine::Version start = part(640, 480, Holes::kNone);
    Shown shown;
    shown.versions = {start, start};
    shown.original = start;
    ASSERT_TRUE(twins.picture().update(shown));
    FrameInput input = smallInput();
    input.arrangement = arrangement;
    input.titles = {"unchanged", "a variant"};
    EXPECT_EQ(twins.shoot(input), 1.0);
    engine::LiveField live(start, engine::Growth::kAllowed);
    for (int i = 0; i < 6; ++i) {
      ASSERT_TRUE(live.setHeight(300 + 9 * i, 200, 2.0F));
      shown.versions[static_cast<std::size_t>(i % 2)] = live.snapshot();
      ASSERT_TRUE(twins.picture().update(shown));
      const double share = twins.shoot(input);
      EXPECT_LT(share, 0.5);
    }
  }
}

TEST(Damage, APanelThatIsRefinedOrLitFromPagesOfItsOwnIsDrawnAloneAndTheOthersStay) {
  // Four states take 5.2 MB; of this picture their pages take less.
  for (const std::int64_t device_bytes : {kWhole, std::int64_t{5'000'000}}) {
    SCOPED_TRACE(device_bytes);
    Twins twins(device_bytes);
    const engine::Version start = part(640, 480, Holes::kNone);
    engine::LiveField live(start, engine::Growth::kAllowed);
    Shown shown;
    for (int i = 0; i < 4; ++i) {
      // Four states without a page in common, so that no panel's pages come with another's.
      std::vector<float> z(640 * 480);
      start.reader().readHeights(0, 0, 640, 480, z.data(), 640);
      for (float& height : z) height *= 1.0F + 0.1F * static_cast<float>(i);
      ASSERT_TRUE(live.writeHeights(0, 0, 640, 480, z.data(), 640));
      shown.versions.push_back(live.snapshot());
    }
    ASSERT_TRUE(twins.picture().update(shown));
    FrameInput input = smallInput();
    input.range = ValueRange{-3, 9};
    input.panel_vertices.assign(4, 4096);
    EXPECT_EQ(twins.shoot(input), 1.0);
    for (std::size_t i = 0; i < 4; ++i) {
      input.panel_vertices[i] = 1 << 20;
      const double share = twins.shoot(input);
      EXPECT_EQ(twins.onDemand(), device_bytes != kWhole);
      EXPECT_GT(share, 0.1) << i;
      EXPECT_LE(share, 0.25) << i;
    }
    EXPECT_EQ(twins.shoot(input), 0.0);
  }
}

}  // namespace
}  // namespace fettle::render
