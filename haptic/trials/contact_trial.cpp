#include "haptic/trials/contact_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "engine/base/statistics.h"
#include "engine/base/stopwatch.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/contact/certified.h"
#include "haptic/contact/surface.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::trials {

namespace {

// A square of a field without holes, as near to its middle as can be found in steps of half a side: at most
// `side` samples each way, fewer where the field has fewer. A separate field, beginning at 0, 0. Empty: none
// without holes. Throws std::bad_alloc.
std::optional<engine::Version> wholeSquare(const engine::Version& field, std::int32_t side) {
  const engine::FieldReader reader = field.reader();
  const std::int32_t columns = std::min(side, reader.width()), rows = std::min(side, reader.height());
  const std::int32_t last_column = reader.width() - columns, last_row = reader.height() - rows;
  struct Place {
    std::int32_t column, row;
    [[nodiscard]] std::int64_t from(std::int32_t c, std::int32_t r) const {
      return std::int64_t{c - column} * (c - column) + std::int64_t{r - row} * (r - row);
    }
  };
  std::vector<Place> places;
  const std::int32_t step = std::max(1, side / 2);
  for (std::int32_t r = last_row / 2 % step; r <= last_row; r += step)
    for (std::int32_t c = last_column / 2 % step; c <= last_column; c += step) places.push_back({c, r});
  std::stable_sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    return a.from(last_column / 2, last_row / 2) < b.from(last_column / 2, last_row / 2);
  });
  std::vector<float> z(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (const Place& place : places) {
    reader.readHeights(place.column, place.row, columns, rows, z.data(), columns);
    if (std::any_of(z.begin(), z.end(), [](float v) { return std::isnan(v); })) continue;
    engine::Grid grid = field.grid();
    grid.width = columns;
    grid.height = rows;
    return engine::makeField(grid, z);
  }
  return std::nullopt;
}

// The field grown by a ball of `radius_mm`: H(x, y) = max over |d| <= radius of h((x, y) + d) +
// sqrt(radius^2 - |d|^2), where the centre of a ball is that rests on the surface. `finer` samples for each
// of the field's, for surface and ball: H is too low by about (spacing / finer)^2 / (4 radius), the rise of
// a ball's foot within half such a step, and by more only where the surface is sharper than the ball. Cost:
// (2 radius / spacing finer)^2 per sample. `field` has cells and no holes. Throws std::bad_alloc.
engine::Version grownByBall(const engine::Version& field, double radius_mm, int finer) {
  const engine::FieldReader reader = field.reader();
  engine::Grid grid = field.grid();
  grid.width = (grid.width - 1) * finer + 1;
  grid.height = (grid.height - 1) * finer + 1;
  grid.spacing_x /= finer;
  grid.spacing_y /= finer;
  const auto at = [&](std::int32_t c, std::int32_t r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(c);
  };
  std::vector<double> surface(at(0, grid.height));
  for (std::int32_t r = 0; r < grid.height; ++r)
    for (std::int32_t c = 0; c < grid.width; ++c) {
      const std::int32_t c0 = std::min(c / finer, reader.width() - 2),
                         r0 = std::min(r / finer, reader.height() - 2);
      const double u = static_cast<double>(c) / finer - c0, v = static_cast<double>(r) / finer - r0;
      const double low = (1.0 - u) * reader.heightAt(c0, r0) + u * reader.heightAt(c0 + 1, r0);
      const double high = (1.0 - u) * reader.heightAt(c0, r0 + 1) + u * reader.heightAt(c0 + 1, r0 + 1);
      surface[at(c, r)] = (1.0 - v) * low + v * high;
    }
  // Row by row of the ball: how much higher the centre is than a point at that offset, in height units.
  const double unit = grid.height_unit.mm, sx = grid.spacingXMm(), sy = grid.spacingYMm();
  const auto reach_x = static_cast<std::int32_t>(radius_mm / sx),
             reach_y = static_cast<std::int32_t>(radius_mm / sy);
  std::vector<double> grown(surface.size(), -std::numeric_limits<double>::infinity());
  std::vector<double> cap(static_cast<std::size_t>(2 * reach_x + 1));
  for (std::int32_t dr = -reach_y; dr <= reach_y; ++dr) {
    int columns = 0;
    for (std::int32_t dc = 0; dc <= reach_x; ++dc) {
      const double left = radius_mm * radius_mm - dr * sy * dr * sy - dc * sx * dc * sx;
      if (left < 0.0) break;
      cap[static_cast<std::size_t>(dc)] = std::sqrt(left) / unit;
      columns = dc + 1;
    }
    for (std::int32_t r = std::max(0, -dr); r < std::min(grid.height, grid.height - dr); ++r)
      for (std::int32_t dc = 1 - columns; dc < columns; ++dc) {
        const double up = cap[static_cast<std::size_t>(std::abs(dc))];
        const std::int32_t first = std::max(0, -dc), end = std::min(grid.width, grid.width - dc);
        const double* from = surface.data() + at(first + dc, r + dr);
        double* to = grown.data() + at(first, r);
        for (std::int32_t i = 0; i < end - first; ++i) to[i] = std::max(to[i], from[i] + up);
      }
  }
  return engine::makeField(grid, std::vector<float>(grown.begin(), grown.end()));
}

using haptic::ContactLevel;
using haptic::Surface;

constexpr int kReachCells = 16;
constexpr std::int32_t kBallSide = 97;  // samples of the square that a ball is tried on
constexpr int kFiner = 8;               // of the grown surface
constexpr int kCheckedTicks = 12;       // ticks

constexpr ContactChoice kChoices[] = {
    {"descent, 1 Newton step per tick", ContactLevel::kDescent, 2},
    {"descent, 2 steps per tick", ContactLevel::kDescent, 3},
    {"descent, 4 steps per tick", ContactLevel::kDescent, 5},
    {"descent, 8 steps per tick", ContactLevel::kDescent, 9},
    {"descent, to rest", ContactLevel::kDescent, 2048},
    {"paper", ContactLevel::kPaper},
    {"certified, 1 cell", ContactLevel::kCertified, 2048, 1},
    {"certified, 2 cells", ContactLevel::kCertified, 2048, 2},
    {"certified, 4 cells", ContactLevel::kCertified, 2048, 4},
    {"certified, 6 cells", ContactLevel::kCertified, 2048, 6},  // used by the window for a mouse
    {"certified, 8 cells", ContactLevel::kCertified, 2048, 8},
    {"ball, radius 1 cell", ContactLevel::kPaper, 2048, 2, 1.0},
    {"ball, 2 cells, 4 steps per tick", ContactLevel::kPaper, 5, 2, 2.0},
    {"ball, radius 2 cells", ContactLevel::kPaper, 2048, 2, 2.0},
};

double cellMm(const engine::Grid& grid) {
  return std::max(grid.spacingXMm(), grid.spacingYMm());
}

// The patch above or below a point, where there is one.
bool patchAt(Surface& surface, const glm::dvec3& point, haptic::Patch& patch, double& height_mm) {
  haptic::CellIndex cell;
  if (!surface.cellUnder(point, cell) || !surface.patch(cell, patch)) return false;
  height_mm = patch.heightAt((point.x - patch.x0) / patch.sx, (point.y - patch.y0) / patch.sy);
  return true;
}

}  // namespace

haptic::Scene ContactChoice::in(haptic::Scene scene, const engine::Grid& grid) const {
  scene.tip = ball_radius_cells > 0.0 ? haptic::TipShape::kSphere : haptic::TipShape::kPoint;
  if (ball_radius_cells > 0.0) {
    scene.tip_radius_mm = ball_radius_cells * cellMm(grid);
    scene.search_rounds = search_rounds;
    if (before_revision_4) {
      scene.ball_searches = 64;
      scene.ball_minima = haptic::BallMinima::kPieces;
      scene.ball_steps = haptic::BallSteps::kInSpace;
    }
    return scene;
  }
  scene.level = level;
  scene.search_rounds = search_rounds;
  if (level == ContactLevel::kCertified) scene.certified_radius_cells = certified_radius_cells;
  return scene;
}

std::span<const ContactChoice> contactChoices() {
  return kChoices;
}

engine::Result<std::optional<ContactTrial>> ContactTrial::make(const engine::Version& field,
                                                               double ball_radius_cells, std::int64_t ticks,
                                                               const engine::JobControl& job) {
  ContactTrial trial;
  trial.field_ = trial.surface_ = field;
  const double cell = cellMm(field.grid());
  trial.reach_mm_ = kReachCells * cell;
  if (field.grid().width < 2 || field.grid().height < 2) return std::nullopt;
  if (ball_radius_cells > 0.0) {
    const auto square = wholeSquare(field, kBallSide);
    if (!square) return std::nullopt;
    trial.radius_mm_ = ball_radius_cells * cell;
    trial.field_ = *square;
    trial.surface_ = grownByBall(*square, trial.radius_mm_, kFiner);
  }
  HandMotion motion;
  motion.ticks = ticks;
  motion.speed_mm_s = 400.0 * cell;
  motion.press_mm = 6.0 * cell;
  motion.lift_mm = cell;
  motion.tremor_mm = 0.4 * cell;
  trial.strokes_ = handStroke(trial.surface_, motion);
  Surface surface(trial.surface_.reader());
  trial.truths_.reserve(trial.strokes_.size());
  for (const haptic::StrokeSample& s : trial.strokes_) {
    if (trial.truths_.size() % 64 == 0 && job.cancelled()) return engine::cancelled();
    Truth& truth = trial.truths_.emplace_back();
    haptic::Patch patch;
    double height_mm = 0.0;
    if (!patchAt(surface, s.tip_mm, patch, height_mm) || !(s.tip_mm.z < height_mm)) continue;
    haptic::SurfacePoint closest;
    truth.beyond = !haptic::certifiedClosest(surface, s.tip_mm, trial.reach_mm_, closest) ||
                   closest.distance2_mm2 >= trial.reach_mm_ * trial.reach_mm_;
    truth.penetration_mm = closest.position_mm - s.tip_mm;
    truth.distance_mm = std::sqrt(closest.distance2_mm2);
  }
  return trial;
}

engine::Result<ContactFigures> ContactTrial::measure(const ContactChoice& choice, int repeats,
                                                     const engine::JobControl& job) const {
  haptic::Scene scene = haptic::defaultScene();
  scene.effects = {haptic::EffectKind::kSpring};
  scene = choice.in(scene, field_.grid());
  if (radius_mm_ > 0.0) scene.tip_radius_mm = radius_mm_;
  ContactFigures figures;
  const haptic::DenormalScope as_in_the_loop;
  std::vector<double> ns;
  for (int i = 0; i < repeats; ++i) {
    engine::LiveField live(field_, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, field_);
    const engine::Stopwatch watch;
    for (const haptic::StrokeSample& s : strokes_) (void)tick.run(s);
    ns.push_back(watch.ns() / static_cast<double>(strokes_.size()));
    if (job.cancelled()) return engine::cancelled();
  }
  const engine::TimeSpread times = engine::timeSpread(std::move(ns));
  figures.ns = times.median;
  figures.ns_worst = times.worst;

  // The error of the grown surface, see truthError(): a millionth of a cell for a point.
  const double rounding = radius_mm_ > 0.0 ? 0.02 * cellMm(field_.grid()) : 1e-12;
  engine::LiveField live(field_, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field_);
  std::vector<double> errors, results;
  std::int64_t wrong = 0;
  for (std::size_t i = 0; i < strokes_.size(); ++i) {
    (void)tick.run(strokes_[i]);
    const haptic::Contact& contact = tick.contact();
    const glm::dvec3 felt = contact.touching ? contact.penetration_mm : glm::dvec3(0.0);
    results.insert(results.end(), {felt.x, felt.y, felt.z});
    if (truths_[i].beyond) {
      ++figures.beyond;
      continue;
    }
    const double distance_mm = truths_[i].distance_mm;
    if (!(distance_mm > 0.0) && !contact.touching) continue;
    errors.push_back(glm::length(felt - truths_[i].penetration_mm));
    // More than rounding farther than the closest point, or contact in only one of the two.
    const bool same =
        contact.touching == (distance_mm > 0.0) || std::max(glm::length(felt), distance_mm) <= rounding;
    wrong += !same || glm::length(felt) > distance_mm * (1.0 + 1e-9) + rounding;
  }
  figures.ticks = static_cast<std::int64_t>(errors.size());
  figures.wrong = errors.empty() ? 0.0 : static_cast<double>(wrong) / static_cast<double>(errors.size());
  const engine::ErrorSummary summary = engine::errorSummary(std::move(errors));
  figures.mean_mm = summary.mean;
  figures.p99_mm = summary.p99;
  figures.worst_mm = summary.worst;
  figures.hash = engine::hashOf(results);
  return figures;
}

double ContactTrial::truthError() const {
  Surface surface(field_.reader());
  double worst = 0.0;
  int checked = 0;
  for (std::size_t i = 0; i < truths_.size() && checked < kCheckedTicks;
       i += std::max<std::size_t>(1, truths_.size() / 97)) {
    if (truths_[i].beyond || truths_[i].distance_mm == 0.0) continue;
    ++checked;
    const glm::dvec3& e = strokes_[i].tip_mm;
    if (radius_mm_ > 0.0) {
      haptic::SurfacePoint foot;
      if (haptic::certifiedClosest(surface, e + truths_[i].penetration_mm, reach_mm_, foot))
        worst = std::max(worst, std::abs(std::sqrt(foot.distance2_mm2) - radius_mm_));
      continue;
    }
    haptic::CellIndex own;
    if (!surface.cellUnder(e, own)) continue;
    double nearest2 = std::numeric_limits<double>::infinity();
    for (int dr = -kReachCells; dr <= kReachCells; ++dr)
      for (int dc = -kReachCells; dc <= kReachCells; ++dc) {
        const haptic::CellIndex cell{own.column + dc, own.row + dr};
        haptic::Patch patch;
        if (!surface.hasCell(cell) || !surface.patch(cell, patch)) continue;
        for (int k = 0; k < 33 * 33; ++k) {
          const int row = k / 33;
          const glm::dvec3 d = patch.at(k % 33 / 32.0, row / 32.0) - e;
          nearest2 = std::min(nearest2, glm::dot(d, d));
        }
      }
    worst = std::max(worst, truths_[i].distance_mm - std::sqrt(nearest2));
  }
  return worst;
}

}  // namespace fettle::trials
