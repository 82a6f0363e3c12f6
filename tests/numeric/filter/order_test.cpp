// What a sample becomes depends on the samples of its window and on nothing else: not on the tiles and blocks
// the work is cut into, their order, the threads, nor where in the field the window lies. Bits are compared
// throughout, so there is no tolerance.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/filter/pass.h"
#include "engine/filter/region.h"
#include "tests/numeric/filter/cases.h"
#include "tests/numeric/support/rare.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {
namespace {

Version must(Result<Version> result) {
  EXPECT_TRUE(result.has_value());
  return std::move(*result);
}

// Over several tiles and blocks: noise, steps, spikes, holes scattered and in a block, marks.
PlainField manyTiles() {
  std::mt19937 random(31);
  PlainField field = formed(203, 150, [&](int c, int r) {
    if (random() % 31 == 0 || (c > 120 && c < 136 && r > 60 && r < 70)) return kNan;
    const float noise = static_cast<float>(random() % 4096) * 1.234e-3F;
    return noise + (c > 63 ? 20.0F : 0.0F) + (random() % 200 == 0 ? 1e6F : 0.0F);
  });
  for (int i = 0; i < 203 * 150; ++i) field.marks.push_back(random() % 13 == 0 ? 1 : 0);
  return field;
}

TEST(Order, OfTilesBlocksAndThreadsDoesNotShow) {
  const Version start = toVersion(manyTiles());
  for (const FilterCase& filter : filterCases()) {
    SCOPED_TRACE(filter.name);
    FilterSpec spec = filter.spec;
    spec.passes = 2;
    spec.max_change = 3.0;
    spec.threads = 1;
    const std::uint64_t whole = contentHash(filtered(start, spec).field);
    for (const int side : {64, 128, 192})
      for (const int threads : {1, 3}) {
        spec.threads = threads;
        JobControl job;
        const Result<Filtered> cut = applyFilter(start, start, spec, FilterTuning{side}, job);
        ASSERT_TRUE(cut);
        EXPECT_EQ(contentHash(cut->field), whole) << side << " " << threads;
      }
    // Tile by tile in any order, each put onto what the others left.
    std::vector<std::pair<int, int>> tiles;
    for (int tr = 0; tr < 3; ++tr)
      for (int tc = 0; tc < 4; ++tc) tiles.emplace_back(tc, tr);
    std::mt19937 random(2);
    std::shuffle(tiles.begin(), tiles.end(), random);
    Version onto = start;
    for (const auto& [tc, tr] : tiles) {
      JobControl job;
      onto = must(filterRange(start, start, onto, spec, TileRange{tc, tr, 1, 1}, job));
    }
    EXPECT_EQ(contentHash(onto), whole);
  }
}

TEST(Order, AWindowHasTheSameResultWhereverItLies) {
  // One patch with holes all round, as deep as the window is wide: moved over every remainder of a vector and
  // across the borders of tiles.
  std::mt19937 random(7);
  const PlainField patch = formed(19, 17, [&](int, int) {
    return random() % 11 == 0 ? kNan : static_cast<float>(random() % 65536) * 0.37F - 9000.0F;
  });
  for (const FilterCase& filter : filterCases()) {
    SCOPED_TRACE(filter.name);
    const PlainField alone = toPlain(filtered(toVersion(patch), filter.spec).field);
    for (const auto& [x0, y0] : {std::pair{0, 0},
                                 {1, 3},
                                 {45, 47},
                                 {46, 63},
                                 {50, 60},
                                 {61, 55},
                                 {63, 64},
                                 {64, 50},
                                 {101, 58},
                                 {120, 121}}) {
      PlainField field = formed(150, 140, [](int, int) { return kNan; });
      // A far corner that is not flat, so that the surroundings are not the same as those of `alone`.
      field.at(149, 139) = 1e9F;
      for (int r = 0; r < patch.height; ++r)
        for (int c = 0; c < patch.width; ++c) field.at(x0 + c, y0 + r) = patch.at(c, r);
      const PlainField after = toPlain(filtered(toVersion(field), filter.spec).field);
      int different = 0;
      for (int r = 0; r < patch.height; ++r)
        for (int c = 0; c < patch.width; ++c) {
          if (149 - x0 - c <= filter.reach() && 139 - y0 - r <= filter.reach()) continue;  // sees the corner
          different += !sameBits(after.at(x0 + c, y0 + r), alone.at(c, r));
        }
      EXPECT_EQ(different, 0) << x0 << " " << y0;
    }
  }
}

class Symmetry : public testing::TestWithParam<std::string> {};

TEST_P(Symmetry, FiltersCommuteWithMirrorsTurnsSignsAndPowersOfTwo) {
  const PlainField start = hardField(GetParam());
  const auto mirroredX = [](const PlainField& f) {
    return formed(f.width, f.height, [&](int c, int r) { return f.at(f.width - 1 - c, r); });
  };
  const auto mirroredY = [](const PlainField& f) {
    return formed(f.width, f.height, [&](int c, int r) { return f.at(c, f.height - 1 - r); });
  };
  const auto turned = [](const PlainField& f) {
    return formed(f.height, f.width, [&](int c, int r) { return f.at(r, c); });
  };
  const auto times = [](const PlainField& f, float factor) {
    return formed(f.width, f.height, [&](int c, int r) { return factor * f.at(c, r); });
  };
  for (const FilterCase& filter : filterCases()) {
    SCOPED_TRACE(filter.name);
    const auto through = [&](const PlainField& f) {
      return toPlain(filtered(toVersion(f), filter.spec).field);
    };
    const PlainField after = through(start);
    const WindowExtremes extremes = windowExtremes(start, filter.spec.window);
    fettle::tests::Rare order(fmt::format("{} on {} shows the order of its sum", filter.name, GetParam()),
                              filter.symmetric ? 0.0 : 0.05);
    // Of zeros a new one is the positive one, so that signs of zeros are not compared. Where the order of a
    // sum shows, both results are within the kind's error of the exact one before they are rounded.
    const auto differing = [&](const PlainField& other, bool exact) {
      int wrong = 0;
      for (std::size_t i = 0; i < after.z.size(); ++i) {
        if (std::isnan(after.z[i]) && std::isnan(other.z[i])) continue;
        const long double off = std::fabs(static_cast<long double>(after.z[i]) - other.z[i]);
        const long double allowed =
            exact ? 0.0L : 2 * filter.errorOf(extremes.magnitude(i)) + ulp(after.z[i]);
        wrong += off <= allowed ? 0 : 1;
        if (!exact) order.saw(off != 0.0L);
      }
      return wrong;
    };
    EXPECT_EQ(differing(mirroredX(through(mirroredX(start))), filter.symmetric), 0) << "mirrored in x";
    EXPECT_EQ(differing(mirroredY(through(mirroredY(start))), filter.symmetric), 0) << "mirrored in y";
    EXPECT_EQ(differing(turned(through(turned(start))), filter.symmetric), 0) << "turned";
    EXPECT_EQ(differing(times(through(times(start, -1.0F)), -1.0F), true), 0) << "negated";
    // Halving is exact above the denormals.
    if (GetParam() != "denormals" && GetParam() != "all magnitudes") {
      EXPECT_EQ(differing(times(through(times(start, 0.5F)), 2.0F), true), 0) << "halved";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, Symmetry, testing::ValuesIn(hardFieldNames()), [](const auto& test) {
  std::string text = test.param;
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
});

TEST(Spacing, UnitsAndOriginsAreNothingToAFilter) {
  // Windows are counted in samples and heights kept in their own unit: an origin five million metres away and
  // a thousandfold spacing to one side change no bit.
  const PlainField plain = manyTiles();
  Grid far;
  far.width = plain.width;
  far.height = plain.height;
  far.spacing_x = 1e3;
  far.spacing_y = 1e-3;
  far.origin_x = 5e6;
  far.origin_y = -5e6;
  far.lateral_unit = {"m", 1000.0};
  const Version near = toVersion(plain);
  for (const FilterCase& filter : filterCases())
    EXPECT_EQ(contentHash(filtered(near.withGrid(far), filter.spec).field),
              contentHash(filtered(near, filter.spec).field))
        << filter.name;
}

}  // namespace
}  // namespace fettle::engine::tests
