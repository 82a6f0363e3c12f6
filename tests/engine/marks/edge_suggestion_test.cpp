#include "engine/marks/edge_suggestion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/builder.h"
#include "engine/scanner/scanner.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

Version fieldOf(int width, int height, const std::function<double(int, int)>& z) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::vector<float> heights;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) heights.push_back(static_cast<float>(z(c, r)));
  return makeField(grid, heights);
}

EdgeSuggestion suggested(const Version& field, double sigma = EdgeMap::kUsualSigma, EdgeChoice choice = {}) {
  JobControl job;
  const auto map = findEdges(field, sigma, job);
  EXPECT_TRUE(map);
  if (!map) return {};
  auto marks = suggestMarks(field, *map, choice, job);
  EXPECT_TRUE(marks);
  return marks.value_or(EdgeSuggestion{});
}

// Normal numbers from a fixed generator, the same on every machine.
std::vector<float> noise(std::size_t n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> v(n);
  for (float& x : v) {
    double sum = 0.0;  // of 12 even numbers: variance 1
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
    x = static_cast<float>(sum - 6.0);
  }
  return v;
}

// Share of the samples of `of` that have one of `in` within `within` samples.
struct Agreement {
  double precision = 0.0, recall = 0.0;
  std::int64_t found = 0, truth = 0;
};
std::vector<std::uint8_t> marksOf(const Version& v) {
  std::vector<std::uint8_t> m(static_cast<std::size_t>(v.grid().samples()));
  v.reader().readMarks(0, 0, v.grid().width, v.grid().height, m.data(), v.grid().width);
  return m;
}
double covered(const std::vector<std::uint8_t>& of, const std::vector<std::uint8_t>& in, int width,
               int within, std::int64_t& count) {
  std::int64_t hit = 0;
  const int height = static_cast<int>(of.size()) / width;
  count = 0;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      if (of[static_cast<std::size_t>(r * width + c)] == 0) continue;
      ++count;
      bool near = false;
      for (int y = std::max(r - within, 0); y <= std::min(r + within, height - 1) && !near; ++y)
        for (int x = std::max(c - within, 0); x <= std::min(c + within, width - 1) && !near; ++x)
          near = (x - c) * (x - c) + (y - r) * (y - r) <= within * within &&
                 in[static_cast<std::size_t>(y * width + x)] != 0;
      hit += near;
    }
  return count > 0 ? static_cast<double>(hit) / static_cast<double>(count) : 1.0;
}
Agreement agreement(const Version& found, const Version& truth, int within) {
  const auto f = marksOf(found), t = marksOf(truth);
  Agreement a;
  a.precision = covered(f, t, found.grid().width, within, a.found);
  a.recall = covered(t, f, found.grid().width, within, a.truth);
  return a;
}

// What was measured, at the usual scale and sensitivity, thin lines, 3 samples to both sides allowed: the
// bounds stand some 0.05 below. What is missed are creases within a few samples of tall walls, which hide
// them; what is found too much are rims of shadows, where the scan itself breaks off.
struct Measured {
  const char* part;
  double precision, recall;
};
constexpr Measured kMeasured[] = {
    {"bracket", 0.865, 0.783}, {"housing", 0.787, 0.802}, {"ribs", 0.785, 0.557}, {"steps", 0.937, 0.797},
    {"wedges", 0.976, 0.999},  {"die", 0.798, 0.894},     {"plate", 1.0, 1.0},
};

TEST(EdgeSuggestion, the_true_edges_of_simulated_parts_are_found_through_noise_and_shadows) {
  for (const Measured& expected : kMeasured)
    for (const double scale : {0.0, 1.0}) {
      ScannerSpec spec;
      spec.part = expected.part;
      spec.width = spec.height = 512;
      spec.noise = scale;
      if (scale > 0.0) spec.outliers = 0.05, spec.dropouts = 1.0;
      JobControl job;
      const auto scan = simulateScan(spec, job);
      ASSERT_TRUE(scan);
      EdgeChoice thin;
      thin.thickness = 0.0;
      const EdgeSuggestion found = suggested(scan->scan, EdgeMap::kUsualSigma, thin);
      const Agreement a = agreement(found.field, scan->edges, 3);
      std::printf("%-8s noise %.0f: precision %.3f, recall %.3f of %lld, %lld lines\n", expected.part, scale,
                  a.precision, a.recall, static_cast<long long>(a.truth),
                  static_cast<long long>(found.lines));
      if (scale == 1.0) {
        EXPECT_GE(a.precision, expected.precision - 0.05) << expected.part;
        EXPECT_GE(a.recall, expected.recall - 0.05) << expected.part;
      }
    }
}

TEST(EdgeSuggestion, without_shadows_hardly_a_line_is_false) {
  for (const char* part : {"bracket", "housing", "wedges", "die"}) {
    ScannerSpec spec;
    spec.part = part;
    spec.width = spec.height = 512;
    JobControl job;
    const auto scan = simulateScan(spec, job);
    ASSERT_TRUE(scan);
    EdgeChoice thin;
    thin.thickness = 0.0;
    const EdgeSuggestion found = suggested(scan->scan, EdgeMap::kUsualSigma, thin);
    const Agreement a = agreement(found.field, scan->edges, 3);
    std::printf("%-8s without shadows: precision %.3f, recall %.3f\n", part, a.precision, a.recall);
    EXPECT_GE(a.precision, 0.85) << part;
    EXPECT_GE(a.recall, 0.70) << part;
  }
}

TEST(EdgeSuggestion, planes_constants_and_smooth_hills_have_no_edges) {
  const std::vector<float> grain = noise(400 * 400, 1);
  const auto rough = [&](int c, int r) { return 0.02 * grain[static_cast<std::size_t>(r * 400 + c)]; };
  EXPECT_EQ(suggested(fieldOf(300, 300, [](int, int) { return 7.25; })).samples, 0);
  EXPECT_EQ(suggested(fieldOf(300, 300, [](int c, int r) { return 1000.0 + 0.37 * c - 0.11 * r; })).samples,
            0);
  EXPECT_EQ(suggested(fieldOf(300, 300, [](int c, int r) { return 1e-3 * (c * c + r * r); })).samples, 0);
  EXPECT_EQ(suggested(fieldOf(400, 400, rough)).samples, 0);
  EXPECT_EQ(suggested(fieldOf(400, 400, [&](int c, int r) { return 0.4 * c + rough(c, r); })).samples, 0);
  EXPECT_EQ(suggested(fieldOf(400, 400,
                              [&](int c, int r) {
                                return 3.0 * std::sin(c * 0.02) * std::cos(r * 0.02) + rough(c, r);
                              }))
                .samples,
            0);
}

TEST(EdgeSuggestion, a_faint_step_is_found_where_it_is_and_nothing_else) {
  const std::vector<float> grain = noise(256 * 256, 2);
  const Version v = fieldOf(256, 256, [&](int c, int r) {
    return (c >= 128 ? 0.1 : 0.0) + 0.03 * c + 0.02 * grain[static_cast<std::size_t>(r * 256 + c)];
  });
  const EdgeSuggestion found = suggested(v);
  int rows = 0;
  for (int r = 0; r < 256; ++r) {
    bool here = false;
    for (int c = 0; c < 256; ++c) {
      if (!found.field.reader().markedAt(c, r)) continue;
      // The step lies between 127 and 128; marks are thick by one and noise of a fifth of the step moves the
      // line by a sample.
      EXPECT_NEAR(c, 127.5, 3.0) << "row " << r;
      here = true;
    }
    rows += here;
  }
  EXPECT_GT(rows, 245);
  EXPECT_EQ(found.lines, 1);
}

// The wall around the plate, 2 mm high, between columns 10 and 11: one line there and none at its two feet, 1.5 samples
// away. So coarse a scan of many steps has more noise in its slopes than in its curvature.
TEST(EdgeSuggestion, a_tall_wall_is_one_line_where_it_stands) {
  JobControl job;
  ScannerSpec spec;
  spec.part = "steps";
  spec.width = spec.height = 512;
  spec.seed = 5;
  const auto scan = simulateScan(spec, job);
  ASSERT_TRUE(scan);
  ASSERT_GT(scan->truth.reader().heightAt(11, 200) - scan->truth.reader().heightAt(10, 200), 1.9F);
  const auto map = findEdges(scan->scan, EdgeMap::kUsualSigma, job);
  ASSERT_TRUE(map);
  int at_wall = 0, beside = 0;
  for (const EdgeCandidate& c : map->candidates)
    if (c.row >= 120 && c.row < 392 && c.column >= 7 && c.column < 15 &&
        c.strength >= EdgeChoice{}.strength())
      ++(c.column == 10 || c.column == 11 ? at_wall : beside);
  EXPECT_GE(at_wall, 270);
  EXPECT_EQ(beside, 0);
}

TEST(EdgeSuggestion, a_ridge_without_a_step_is_one_line) {
  const std::vector<float> grain = noise(256 * 256, 3);
  const Version v = fieldOf(256, 256, [&](int c, int r) {
    return -0.1 * std::abs(r - 100) + 0.02 * grain[static_cast<std::size_t>(r * 256 + c)];
  });
  const EdgeSuggestion found = suggested(v);
  EXPECT_EQ(found.lines, 1);
  EXPECT_GT(found.samples, 245);
  for (int r = 0; r < 256; ++r)
    for (int c = 0; c < 256; ++c)
      if (found.field.reader().markedAt(c, r)) {
        EXPECT_NEAR(r, 100, 3);
      }
}

TEST(EdgeSuggestion, holes_and_borders_of_a_tilted_plane_are_no_edges) {
  const std::vector<float> grain = noise(300 * 300, 4);
  const Version v = fieldOf(300, 300, [&](int c, int r) -> double {
    const bool round = std::hypot(c - 90, r - 90) < 40, lonely = (c * 7 + r * 13) % 97 == 0;
    if (round || lonely || (c > 200 && r > 100 && r < 120)) return kNan;
    return 0.5 * c - 0.3 * r + 0.02 * grain[static_cast<std::size_t>(r * 300 + c)];
  });
  EXPECT_EQ(suggested(v).samples, 0);
}

TEST(EdgeSuggestion, spikes_of_a_million_are_no_edges_and_hide_none) {
  const std::vector<float> grain = noise(256 * 256, 5);
  std::mt19937 random(9);
  std::vector<std::uint8_t> spiked(256 * 256, 0);
  for (int i = 0; i < 600; ++i) spiked[random() % spiked.size()] = 1;
  const auto surface = [&](int c, int r) {
    return (r >= 60 ? 0.5 : 0.0) + 0.02 * grain[static_cast<std::size_t>(r * 256 + c)];
  };
  const Version v = fieldOf(256, 256, [&](int c, int r) {
    const bool spike = spiked[static_cast<std::size_t>(r * 256 + c)] != 0;
    return spike ? ((c + r) % 2 != 0 ? 1e6 : -1e6) : surface(c, r);
  });
  const EdgeSuggestion found = suggested(v);
  EXPECT_EQ(found.lines, 1);
  EXPECT_GT(found.samples, 245);
}

TEST(EdgeSuggestion, fields_of_one_row_one_column_one_sample_or_holes_alone_are_taken) {
  EXPECT_EQ(suggested(fieldOf(1, 1, [](int, int) { return 3.0; })).samples, 0);
  EXPECT_EQ(suggested(fieldOf(500, 1, [](int c, int) { return c * 0.1; })).samples, 0);
  EXPECT_EQ(suggested(fieldOf(1, 500, [](int, int) { return 2.0; })).samples, 0);
  EXPECT_EQ(suggested(fieldOf(100, 100, [](int, int) { return double{kNan}; })).samples, 0);
  EXPECT_EQ(
      suggested(fieldOf(5, 5, [](int c, int r) { return c == 2 && r == 2 ? double{kNan} : 1.0; })).samples,
      0);
}

TEST(EdgeSuggestion, marks_are_added_and_holes_and_heights_left_alone) {
  Grid grid;
  grid.width = grid.height = 128;
  std::vector<float> z(128 * 128);
  std::vector<std::uint8_t> marks(z.size(), 0);
  for (int r = 0; r < 128; ++r)
    for (int c = 0; c < 128; ++c) z[static_cast<std::size_t>(r * 128 + c)] = c > 64 ? 1.0F : 0.0F;
  z[50 * 128 + 64] = kNan;
  marks[5 * 128 + 5] = 1;
  const Version v = makeField(grid, z, marks);
  const Version found = suggested(v).field;
  EXPECT_TRUE(found.reader().markedAt(5, 5));
  EXPECT_FALSE(found.reader().markedAt(64, 50));
  EXPECT_TRUE(found.reader().markedAt(64, 90));
  JobControl job;
  EXPECT_EQ(contentHash(*clearMarks(found, job)), contentHash(*clearMarks(v, job)));
}

TEST(EdgeSuggestion, more_sensitivity_never_takes_a_mark_away) {
  ScannerSpec spec;
  spec.width = spec.height = 300;
  JobControl job;
  const Version scan = simulateScan(spec, job)->scan;
  const EdgeMap map = *findEdges(scan, 2.0, job);
  std::vector<std::uint8_t> before;
  std::int64_t last = -1;
  for (double s = 0.0; s <= 1.0; s += 0.125) {
    EdgeChoice choice;
    choice.sensitivity = s;
    const EdgeSuggestion now = *suggestMarks(scan, map, choice, job);
    const auto marks = marksOf(now.field);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LE(before[i], marks[i]);
    EXPECT_GE(now.samples, last);
    last = now.samples;
    before = marks;
  }
}

TEST(EdgeSuggestion, any_number_of_threads_and_either_sign_give_the_same) {
  ScannerSpec spec;
  spec.width = 600;
  spec.height = 500;
  spec.dropouts = 1.0;
  JobControl job;
  const Version scan = simulateScan(spec, job)->scan;
  const std::uint64_t many = contentHash(suggested(scan).field);
  EXPECT_EQ(contentHash(suggested(scan.inverted()).field.inverted()), many);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(contentHash(suggested(scan).field), many);
}

TEST(EdgeSuggestion, numbers_out_of_range_and_a_cancel_are_refused) {
  const Version v = fieldOf(64, 64, [](int c, int) { return c > 30 ? 1.0 : 0.0; });
  JobControl job;
  for (const double s : {0.0, -1.0, 9.0, std::nan("")})
    EXPECT_EQ(findEdges(v, s, job).error().kind, ErrorKind::kInput);
  const EdgeMap map = *findEdges(v, 2.0, job);
  EXPECT_EQ(suggestMarks(v, map, {1.5, 1.0, 0}, job).error().kind, ErrorKind::kInput);
  EXPECT_EQ(suggestMarks(v, map, {0.5, -1.0, 0}, job).error().kind, ErrorKind::kInput);
  job.cancel();
  EXPECT_EQ(findEdges(v, 2.0, job).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(suggestMarks(v, map, {}, job).error().kind, ErrorKind::kCancelled);
}

TEST(EdgeKernels, measure_constants_lines_and_parabolas_exactly) {
  for (const double sigma : {0.7, 1.0, 2.3, 8.0}) {
    const EdgeKernels k = edgeKernels(sigma);
    double constant = 0, line = 0, parabola = 0, first0 = 0, second0 = 0, second1 = 0;
    for (int d = -k.radius; d <= k.radius; ++d) {
      const auto i = static_cast<std::size_t>(d + k.radius);
      constant += k.smooth[i];
      first0 += k.first[i];
      line += static_cast<double>(d) * k.first[i];
      second0 += k.second[i];
      second1 += static_cast<double>(d) * k.second[i];
      parabola += 0.5 * d * d * k.second[i];
    }
    // Weights are floats: each rounded by 2^-25 of itself, times distances up to 3.5 sigma squared.
    EXPECT_NEAR(constant, 1.0, 1e-6);
    EXPECT_NEAR(line, 1.0, 1e-6);
    EXPECT_NEAR(parabola, 1.0, 1e-6);
    EXPECT_NEAR(first0, 0.0, 1e-6);
    EXPECT_NEAR(second0, 0.0, 1e-6);
    EXPECT_NEAR(second1, 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace fettle::engine
