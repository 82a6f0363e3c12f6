// Ten thousand passes: where a filter ends, how far that is from where exact arithmetic ends, and whether it
// stays there.
//
// A mean with symmetric weights w(i, j), each window renormalised to W(i) = sum_j w(i, j) over the samples
// there are, is a random walk that is reversible: P(i, j) = w(i, j) / W(i) and W(i) P(i, j) = W(j) P(j, i).
// So sum_i W(i) z(i) is kept by exact arithmetic whatever the borders and holes, and every connected part
// comes to its mean with the weights W (Levin, Peres, Wilmer, Markov Chains and Mixing Times, 2009, sections
// 1.5 and 12.1). Samples at borders and next to holes count less in it: that is the price of renormalising.
//
// Each pass rounds every sample by at most h = half a last bit of the largest magnitude (what the kinds round
// in double is 2^-20 of that, and is doubled away below). In the norm weighted by W, P is self-adjoint and
// shrinks what is not constant by lambda, its second largest eigenvalue, so that
//   spread:  |z - mean| <= lambda |z - mean| + h per pass, and in the end <= h / (1 - lambda);
//   drift:   the weighted mean moves by at most h a pass, as long as bits change, and not at all afterwards.
// lambda is worked out here, by power iteration in long double.

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/numeric/filter/cases.h"
#include "tests/numeric/support/rare.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {
namespace {

constexpr int kPasses = 10000;

Version passesOf(const Version& start, FilterSpec spec, int passes) {
  Version now = start;
  spec.threads = 1;
  for (int left = passes; left > 0; left -= spec.passes) {
    spec.passes = std::min(left, FilterSpec::kMaxPasses);
    now = filtered(now, spec).field;
  }
  return now;
}

// Passes until nothing changes, or until it comes back to the state two passes before.
struct Settled {
  Version field;
  int passes = 0;
  int period = 0;  // 1 a fixed point, 2 a cycle of two, 0 neither within kPasses
};
Settled settle(const Version& start, FilterSpec spec) {
  spec.threads = 1;
  Version before_last = start, last = start;
  for (int pass = 1; pass <= kPasses; ++pass) {
    const Filtered next = filtered(last, spec);
    if (next.report.changed == 0) return {last, pass - 1, 1};
    if (pass > 1 && contentHash(next.field) == contentHash(before_last)) return {last, pass - 1, 2};
    before_last = std::exchange(last, next.field);
  }
  return {last, kPasses, 0};
}

// The walk that a 3 x 3 mean with weights edge * edge .. 1 is.
class Walk {
 public:
  Walk(const PlainField& field, double edge) : width_(field.width), height_(field.height), edge_(edge) {
    for (const float z : field.z) there_.push_back(!std::isnan(z));
    std::vector<long double> ones(there_.size(), 1.0L);
    weights_ = sums(ones);
  }
  [[nodiscard]] const std::vector<long double>& weights() const { return weights_; }
  [[nodiscard]] std::vector<long double> pass(const std::vector<long double>& z) const {
    std::vector<long double> next = sums(z);
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = there_[i] ? next[i] / weights_[i] : 0.0L;
    return next;
  }
  [[nodiscard]] long double mean(const std::vector<long double>& z) const {
    long double sum = 0.0L, weight = 0.0L;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (there_[i]) sum += weights_[i] * z[i], weight += weights_[i];
    return sum / weight;
  }
  // |z - mean| in the norm weighted by W, of weights that add up to one: at most the largest deviation.
  [[nodiscard]] long double spread(const std::vector<long double>& z) const {
    const long double middle = mean(z);
    long double sum = 0.0L, weight = 0.0L;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (there_[i]) sum += weights_[i] * (z[i] - middle) * (z[i] - middle), weight += weights_[i];
    return std::sqrt(sum / weight);
  }
  // The second largest eigenvalue, from below; after 4000 rounds what else there was has gone by lambda^4000
  // against the next one.
  [[nodiscard]] long double lambda() const {
    std::mt19937 random(9);
    std::vector<long double> z;
    for (std::size_t i = 0; i < there_.size(); ++i)
      z.push_back(static_cast<long double>(random() % 2001) - 1000);
    long double factor = 0.0L;
    for (int round = 0; round < 4000; ++round) {
      const long double middle = mean(z), size = spread(z);
      for (long double& x : z) x = (x - middle) / size;
      z = pass(z);
      factor = spread(z);
    }
    return factor;
  }

 private:
  [[nodiscard]] std::vector<long double> sums(const std::vector<long double>& z) const {
    std::vector<long double> out(z.size());
    for (int r = 0; r < height_; ++r)
      for (int c = 0; c < width_; ++c)
        for (int y = std::max(r - 1, 0); y <= std::min(r + 1, height_ - 1); ++y)
          for (int x = std::max(c - 1, 0); x <= std::min(c + 1, width_ - 1); ++x)
            if (there_[at(x, y)])
              out[at(c, r)] += (x == c ? 1.0L : edge_) * (y == r ? 1.0L : edge_) * z[at(x, y)];
    return out;
  }
  [[nodiscard]] std::size_t at(int c, int r) const { return static_cast<std::size_t>(r) * width_ + c; }
  int width_, height_;
  long double edge_;
  std::vector<bool> there_;
  std::vector<long double> weights_;
};

std::vector<long double> wide(const PlainField& field) {
  std::vector<long double> z;
  for (const float x : field.z) z.push_back(std::isnan(x) ? 0.0L : static_cast<long double>(x));
  return z;
}

// Small fields in one connected part, so that 10,000 passes come to an end of the road.
std::map<std::string, PlainField> startFields() {
  std::mt19937 random(5);
  const auto unit = [&] { return static_cast<float>(random() % 65536U) / 65536.0F; };
  return {
      {"noise", formed(11, 9, [&](int, int) { return unit() - 0.5F; })},
      {"step", formed(12, 8, [&](int c, int) { return c > 5 ? 20.0F : -3.1F; })},
      {"spike of a million", formed(9, 9, [&](int c, int r) { return c == 4 && r == 2 ? 1e6F : unit(); })},
      {"saddle", formed(10, 10, [&](int c, int r) { return 0.01F * static_cast<float>(c * c - r * r); })},
      {"one row", formed(14, 1, [&](int, int) { return unit(); })},
      {"one column", formed(1, 14, [&](int, int) { return unit(); })},
      {"holes", formed(12, 11, [&](int c, int r) { return (c * 5 + r * 3) % 7 == 0 ? kNan : unit(); })},
      {"far from zero", formed(10, 8, [&](int, int) { return 5e6F + 8.0F * unit(); })},
      {"denormals", formed(9, 8, [&](int, int) { return unit() * 1e-41F; })},
      {"huge", formed(9, 8, [&](int, int) { return (2.0F * unit() - 1.0F) * 3e38F; })},
  };
}

class TenThousandPasses : public testing::TestWithParam<std::string> {};

TEST_P(TenThousandPasses, OfAMeanComeToTheWeightedMeanAndStayThereToTheBit) {
  const PlainField start = startFields().at(GetParam());
  for (const auto& [kind, edge] : {std::pair{FilterKind::kBox, 1.0}, {FilterKind::kGaussian, 0.5}}) {
    SCOPED_TRACE(name(kind));
    const FilterSpec spec = makeSpec(kind, 3);
    const Version version = toVersion(start);
    const HeightBounds bounds = version.reader().bounds();
    const long double largest = std::fmax(std::fabs(bounds.min), std::fabs(bounds.max));
    const long double half = ulp(static_cast<float>(largest)) / 2 * (1 + std::ldexp(1.0L, -19));
    const Walk walk(start, edge);
    const long double lambda = walk.lambda();
    ASSERT_LT(lambda, 0.999L);

    const Settled end = settle(version, spec);
    ASSERT_NE(end.period, 0) << "still moving after " << end.passes;
    // Two-cycles of last bits are legal, one in ten ends.
    fettle::tests::Rare cycles(fmt::format("{} of {} ends in a cycle of two", name(kind), GetParam()), 1.0);
    cycles.saw(end.period == 2);
    const std::vector<long double> z = wide(toPlain(end.field));
    // In a cycle of two the same holds for each of its states.
    EXPECT_LE(walk.spread(z), half / (1 - lambda) * 1.01L) << static_cast<double>(lambda);
    EXPECT_LE(std::fabs(walk.mean(z) - walk.mean(wide(start))), half * end.passes) << end.passes;
    RecordProperty(fmt::format("passes_{}", name(kind)), end.passes);

    // No drift: what 10,000 passes give, asked for by the thousand, is that very state (or the other of two).
    const Version long_run = passesOf(version, spec, kPasses);
    const int odd = (kPasses - end.passes) % end.period;
    EXPECT_TRUE(sameBits(toPlain(long_run), toPlain(passesOf(end.field, spec, odd))));
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, TenThousandPasses,
                         testing::Values("noise", "step", "spike of a million", "saddle", "one row",
                                         "one column", "holes", "far from zero", "denormals", "huge"),
                         [](const auto& test) {
                           std::string text = test.param;
                           for (char& c : text) c = c == ' ' ? '_' : c;
                           return text;
                         });

TEST(TenThousandPassesOfParts, ThatHolesSeparateComeEachToItsOwnMean) {
  // Two constants next to each other, a column of holes between: nothing may cross.
  PlainField start = formed(11, 6, [](int c, int r) {
    return c == 5 ? kNan : c < 5 ? 0.1F + (c == 1 && r == 2 ? 3.0F : 0.0F) : -7.3F;
  });
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian}) {
    const PlainField end = toPlain(passesOf(toVersion(start), makeSpec(kind, 3), kPasses));
    for (int r = 0; r < 6; ++r) {
      for (int c = 6; c < 11; ++c) ASSERT_EQ(end.at(c, r), -7.3F);
      for (int c = 0; c < 5; ++c) {
        ASSERT_GE(end.at(c, r), 0.1F);
        ASSERT_LE(end.at(c, r), 3.1F);
      }
      ASSERT_TRUE(std::isnan(end.at(5, r)));
    }
  }
}

// Medians of odd counts choose a sample, so they commute with thresholds, and each threshold is a majority
// vote between neighbours: symmetric, with a vote of its own. Such a network ends in a fixed point or a cycle
// of two (Goles and Olivos, Periodic behaviour of generalized threshold functions, 1980). Marked borders keep
// windows odd: there a median may not do anything else.
TEST(MedianRoots, AreReachedOrACycleOfTwoIsWhenEveryWindowIsOdd) {
  fettle::tests::Rare cycles("a median of nine ends in a cycle of two", 0.1);
  std::mt19937 random(17);
  for (int round = 0; round < 100; ++round) {
    const int width = 3 + static_cast<int>(random() % 14), height = 3 + static_cast<int>(random() % 14);
    const unsigned values = 2 + static_cast<unsigned>(random() % 7);
    PlainField start = formed(width, height, [&](int, int) { return static_cast<float>(random() % values); });
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c)
        start.marks.push_back(c == 0 || r == 0 || c == width - 1 || r == height - 1 ? 1 : 0);
    const FilterSpec spec = makeSpec(FilterKind::kMedian, 3);
    const Settled end = settle(toVersion(start), spec);
    ASSERT_NE(end.period, 0) << width << " x " << height;
    cycles.saw(end.period == 2);
    // Idempotent: a root is the same state, not a copy of it; and however many passes are asked for.
    if (end.period != 1) continue;
    ASSERT_TRUE(filtered(end.field, spec).field == end.field);
    if (round % 20 == 0) {
      ASSERT_TRUE(sameBits(toPlain(passesOf(toVersion(start), spec, kPasses)), toPlain(end.field)));
    }
  }
}

TEST(MedianRoots, AreReachedFromHardFieldsWithBordersAndHoles) {
  // Even counts at borders and next to holes take a mean of two, so that new heights come to be and the
  // theorem does not hold. It ends all the same, since heights stay within their range and floats are
  // finitely many; 10,000 passes are enough for these.
  fettle::tests::Rare cycles("a median with even windows ends in a cycle of two", 0.5);
  for (const auto& [name, start] : startFields()) {
    SCOPED_TRACE(name);
    const FilterSpec spec = makeSpec(FilterKind::kMedian, 3);
    const Settled end = settle(toVersion(start), spec);
    ASSERT_NE(end.period, 0);
    cycles.saw(end.period == 2);
    if (end.period == 1) {
      EXPECT_TRUE(filtered(end.field, spec).field == end.field);
    }
  }
}

}  // namespace
}  // namespace fettle::engine::tests
