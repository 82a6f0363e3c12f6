#include "engine/suggest/worth_places.h"

#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/scanner/counter_random.h"

namespace fettle::engine {
namespace {

constexpr double kNoise = 0.02;
constexpr std::int32_t kWide = 420, kHigh = 300;
// A step of 1.7 times the noise, and a wall of fifty times.
constexpr double kWeakAt = 130.3, kStrongAt = 300.3;

double height(std::int32_t c, std::int32_t r) {
  const double slant = 0.1 * r;
  return (c > kWeakAt + slant ? 1.7 * kNoise : 0.0) + (c > kStrongAt ? 50.0 * kNoise : 0.0);
}

Version scanned(const std::function<float(std::int32_t, std::int32_t, double)>& of, Grid grid = {}) {
  if (grid.width == 0) {
    grid.width = kWide;
    grid.height = kHigh;
    grid.spacing_x = grid.spacing_y = 0.1;
  }
  const CounterRandom random(7, 7);
  std::vector<float> heights;
  for (std::int32_t r = 0; r < grid.height; ++r)
    for (std::int32_t c = 0; c < grid.width; ++c) heights.push_back(of(c, r, kNoise * random.normal(c, r)));
  return makeField(grid, heights);
}

Version steps() {
  return scanned(
      [](std::int32_t c, std::int32_t r, double noise) { return static_cast<float>(height(c, r) + noise); });
}

WorthRequest usual() {
  WorthRequest request;
  request.noise = kNoise;
  return request;
}

WorthPlaces placesOf(const Version& field, const WorthRequest& request = usual()) {
  JobControl job;
  auto found = findWorthPlaces(field, request, job);
  EXPECT_TRUE(found) << (found ? "" : found.error().line());
  return found ? *found : WorthPlaces{};
}

double fromWeak(glm::dvec2 p) {
  return std::abs(p.x - (kWeakAt + 0.1 * p.y));
}

TEST(WorthPlaces, the_step_as_low_as_the_noise_is_worth_most_and_the_wall_nothing) {
  const WorthPlaces found = placesOf(steps());
  ASSERT_FALSE(found.places.empty());
  const WorthPlace& best = found.places.front();
  EXPECT_GT(best.length, 100.0);
  double off = 0.0;
  for (const glm::dvec2& p : best.path) off += fromWeak(p);
  EXPECT_LT(off / static_cast<double>(best.path.size()), 1.5);
  for (const WorthPlace& place : found.places) {
    EXPECT_GT(place.gain, 0.0);
    EXPECT_DOUBLE_EQ(place.seconds, HandPace{}.seconds(place.length));
    EXPECT_LE(place.gain / place.seconds, best.gain / best.seconds);
    for (const glm::dvec2& p : place.path) EXPECT_GT(std::abs(p.x - kStrongAt), 5.0) << "at the wall";
  }
  // 0.1 to 4 squares of the noise for each sample along the step.
  EXPECT_GT(best.gain, 0.1 * kNoise * kNoise * best.length);
  EXPECT_LT(best.gain, 4.0 * kNoise * kNoise * best.length);
  EXPECT_LT(found.rmseAfter(1), found.rmseAfter(0));
  EXPECT_GT(found.rmseAfter(0), 0.02 * kNoise);
  EXPECT_LT(found.rmseAfter(0), kNoise);
}

TEST(WorthPlaces, they_depend_neither_on_threads_nor_on_where_the_field_lies) {
  const WorthPlaces one = placesOf(steps());
  WorthRequest request = usual();
  request.threads = 1;
  Grid far = steps().grid();
  far.origin_x = 5e6;
  far.origin_y = -5e6;
  for (const WorthPlaces& other : {placesOf(steps(), request), placesOf(steps().withGrid(far))}) {
    ASSERT_EQ(one.places.size(), other.places.size());
    EXPECT_EQ(one.left, other.left);
    for (std::size_t i = 0; i < one.places.size(); ++i) {
      EXPECT_EQ(one.places[i].path, other.places[i].path);
      EXPECT_EQ(one.places[i].gain, other.places[i].gain);
    }
  }
}

TEST(WorthPlaces, there_is_none_where_a_line_is_already) {
  EdgeLine line{3, false, {}};
  for (int r = -1; r <= kHigh; ++r) {
    EdgePoint point;
    point.position = {kWeakAt + 0.1 * r, r};
    point.located = true;
    line.points.push_back(point);
  }
  const Version lined =
      steps().withLines(std::make_shared<const std::vector<EdgeLine>>(std::vector<EdgeLine>{line}));
  const WorthPlaces bare = placesOf(steps()), found = placesOf(lined);
  for (const WorthPlace& place : found.places)
    for (const glm::dvec2& p : place.path) EXPECT_GT(fromWeak(p), 2.0);
  EXPECT_LT(found.left, bare.left);
}

TEST(WorthPlaces, the_number_of_places_is_limited_to_the_best) {
  WorthRequest request = usual();
  request.most = 1;
  const WorthPlaces all = placesOf(steps()), best = placesOf(steps(), request);
  ASSERT_EQ(best.places.size(), 1U);
  EXPECT_EQ(best.places[0].path, all.places[0].path);
}

TEST(WorthPlaces, a_flat_field_and_fields_without_surface_have_next_to_none) {
  const WorthPlaces flat =
      placesOf(scanned([](std::int32_t, std::int32_t, double noise) { return static_cast<float>(noise); }));
  double gain = 0.0;
  for (const WorthPlace& place : flat.places) gain += place.gain;
  EXPECT_LT(gain, 0.15 * flat.left);
  const WorthPlaces holes = placesOf(
      scanned([](std::int32_t, std::int32_t, double) { return std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(holes.places.empty());
  EXPECT_EQ(holes.rmseAfter(0), 0.0);
  Grid row;
  row.width = 500;
  row.height = 1;
  EXPECT_TRUE(
      placesOf(scanned([](std::int32_t c, std::int32_t,
                          double noise) { return static_cast<float>((c > 250 ? 0.05 : 0.0) + noise); },
                       row))
          .places.empty());
}

TEST(WorthPlaces, spikes_holes_and_denormals_leave_finite_gains) {
  const WorthPlaces found = placesOf(scanned([](std::int32_t c, std::int32_t r, double noise) {
    if (c % 97 == 13 && r % 89 == 7) return 1e6F;
    if (c % 53 == 5 && r % 31 < 3) return std::numeric_limits<float>::quiet_NaN();
    if (r > 250) return std::numeric_limits<float>::denorm_min() * static_cast<float>(c);
    return static_cast<float>(height(c, r) + noise);
  }));
  EXPECT_TRUE(std::isfinite(found.left));
  for (const WorthPlace& place : found.places) {
    EXPECT_TRUE(std::isfinite(place.gain));
    EXPECT_GT(place.gain, 0.0);
  }
}

TEST(WorthPlaces, a_wrong_noise_is_refused_and_a_cancel_is_seen) {
  JobControl job;
  for (const double noise :
       {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    WorthRequest request;
    request.noise = noise;
    const auto found = findWorthPlaces(steps(), request, job);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().kind, ErrorKind::kInput);
  }
  job.cancel();
  const auto found = findWorthPlaces(steps(), usual(), job);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
