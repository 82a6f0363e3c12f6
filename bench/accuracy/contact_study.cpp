#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/subjects.h"
#include "bench/hand_stroke.h"
#include "engine/field/live_field.h"
#include "haptic/certified.h"
#include "haptic/loop/rt_thread.h"
#include "haptic/scene.h"
#include "haptic/tick.h"

namespace fettle::bench {
namespace {

using haptic::Surface;

constexpr int kReferenceCells = 16;
constexpr int kRepeats = 5;
constexpr double kCellMm = 0.05;  // of the subjects made here

struct Level {
  const char* name;
  haptic::ContactLevel level;
  int rounds;        // of a search, level paper; the last only looks
  int radius_cells;  // level certified
};

constexpr Level kLevels[] = {
    {"paper, 1 Newton step a tick", haptic::ContactLevel::kPaper, 2, 1},
    {"paper, 2 steps a tick", haptic::ContactLevel::kPaper, 3, 1},
    {"paper, 4 steps a tick", haptic::ContactLevel::kPaper, 5, 1},
    {"paper, 8 steps a tick", haptic::ContactLevel::kPaper, 9, 1},
    {"paper, to rest", haptic::ContactLevel::kPaper, 2048, 1},
    {"certified, 1 cell", haptic::ContactLevel::kCertified, 2048, 1},
    {"certified, 2 cells", haptic::ContactLevel::kCertified, 2048, 2},
    {"certified, 4 cells", haptic::ContactLevel::kCertified, 2048, 4},
    {"certified, 8 cells", haptic::ContactLevel::kCertified, 2048, 8},
};

// The truth of one tick. Beyond: the closest point is farther than the reference looks.
struct Truth {
  glm::dvec3 penetration_mm{0.0};  // zero: no contact
  double distance_mm = 0.0;
  bool beyond = false;
};

std::vector<Truth> truthsOf(const engine::Version& field, const std::vector<haptic::StrokeSample>& strokes) {
  Surface surface(field.reader());
  const double radius = kReferenceCells * std::max(surface.spacingX(), surface.spacingY());
  std::vector<Truth> truths;
  truths.reserve(strokes.size());
  for (const haptic::StrokeSample& s : strokes) {
    Truth& truth = truths.emplace_back();
    haptic::CellIndex own;
    haptic::Patch patch;
    if (!surface.cellUnder(s.tip_mm, own) || !surface.patch(own, patch)) continue;
    const double u = s.tip_mm.x / surface.spacingX() - own.column;
    const double v = s.tip_mm.y / surface.spacingY() - own.row;
    if (!(s.tip_mm.z < patch.heightAt(u, v))) continue;
    haptic::SurfacePoint closest;
    truth.beyond = !haptic::certifiedClosest(surface, s.tip_mm, radius, closest) ||
                   closest.distance2_mm2 >= radius * radius;
    truth.penetration_mm = closest.position_mm - s.tip_mm;
    truth.distance_mm = std::sqrt(closest.distance2_mm2);
  }
  return truths;
}

// How much nearer a plain look at 33 x 33 points of every cell within the radius comes than the reference, at
// worst [mm]: above rounding, the reference is wrong.
double beatenBy(const engine::Version& field, const std::vector<haptic::StrokeSample>& strokes,
                const std::vector<Truth>& truths) {
  Surface surface(field.reader());
  double worst = -std::numeric_limits<double>::infinity();
  int looked = 0;
  for (std::size_t i = 0; i < truths.size() && looked < 12;
       i += std::max<std::size_t>(1, truths.size() / 97)) {
    if (truths[i].beyond || truths[i].distance_mm == 0.0) continue;
    ++looked;
    const glm::dvec3& e = strokes[i].tip_mm;
    haptic::CellIndex own;
    if (!surface.cellUnder(e, own)) continue;
    double nearest2 = std::numeric_limits<double>::infinity();
    for (int dr = -kReferenceCells; dr <= kReferenceCells; ++dr)
      for (int dc = -kReferenceCells; dc <= kReferenceCells; ++dc) {
        const haptic::CellIndex cell{own.column + dc, own.row + dr};
        haptic::Patch patch;
        if (!surface.hasCell(cell) || !surface.patch(cell, patch)) continue;
        for (int k = 0; k < 33 * 33; ++k) {
          const glm::dvec3 d = patch.at(k % 33 / 32.0, k / 33 / 32.0) - e;
          nearest2 = std::min(nearest2, glm::dot(d, d));
        }
      }
    worst = std::max(worst, truths[i].distance_mm - std::sqrt(nearest2));
  }
  return worst;
}

AccuracyRow measure(const std::string& subject, const engine::Version& field, const Level& level,
                    const std::vector<haptic::StrokeSample>& strokes, const std::vector<Truth>& truths) {
  haptic::Scene scene = haptic::defaultScene();
  scene.effects = {haptic::EffectKind::kSpring};
  scene.level = level.level;
  scene.search_rounds = level.rounds;
  scene.certified_radius_cells = level.radius_cells;
  AccuracyRow row;
  row.subject = subject;
  row.method = level.name;
  const haptic::DenormalScope as_in_the_loop;
  std::vector<double> ns;
  for (int i = 0; i < kRepeats; ++i) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, field);
    const auto begin = std::chrono::steady_clock::now();
    for (const haptic::StrokeSample& s : strokes) (void)tick.run(s);
    ns.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() /
                 static_cast<double>(strokes.size()));
  }
  spread(std::move(ns), row);

  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  std::vector<double> errors, results;
  std::size_t wrong = 0, beyond = 0;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    (void)tick.run(strokes[i]);
    const haptic::Contact& contact = tick.contact();
    const glm::dvec3 felt = contact.touching ? contact.penetration_mm : glm::dvec3(0.0);
    results.insert(results.end(), {felt.x, felt.y, felt.z});
    if (truths[i].beyond) {
      ++beyond;
      continue;
    }
    const bool touches = truths[i].distance_mm > 0.0;
    if (!touches && !contact.touching) continue;
    errors.push_back(glm::length(felt - truths[i].penetration_mm) * kCellMm / field.grid().spacingXMm());
    // More than rounding farther than the closest point, or there where nothing is to be felt, or not.
    wrong += touches != contact.touching || glm::length(felt) > truths[i].distance_mm * (1.0 + 1e-9) + 1e-12;
  }
  row.wrong = errors.empty() ? 0.0 : static_cast<double>(wrong) / static_cast<double>(errors.size());
  summarise(std::move(errors), row);
  row.hash = hashOf(results);
  if (beyond > 0) row.note = fmt::format("{} ticks deeper than the reference looks, left out", beyond);
  return row;
}

}  // namespace

engine::Result<Study> contactStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study;
  study.id = "contact";
  study.title = "Contact: which point of the surface is felt";
  study.question = "What do I lose if I choose the fast level?";
  study.cost_name = "time a tick";
  study.cost_unit = "ns";
  study.error_name = "mean force error, 1 N/mm, cells of 0.05 mm";
  study.error_unit = "N";
  study.wrong_name = "ticks not at the closest point";
  auto made = hardSubjects(512);
  if (!made) return tl::unexpected(made.error());
  std::vector<Subject> subjects = *std::move(made);
  if (options.scan) subjects.push_back({options.scan->name, options.scan->field});
  job.begin("contact levels", subjects.size() * std::size(kLevels));
  double beaten = -std::numeric_limits<double>::infinity();
  for (const Subject& subject : subjects) {
    HandMotion motion;
    motion.ticks = std::max<std::int64_t>(200, std::llround(50'000 * options.effort));
    // Another grid is gone over in the same cells.
    const double scale = subject.field.grid().spacingXMm() / kCellMm;
    motion.speed_mm_s = 20.0 * scale;
    motion.press_mm = 0.3 * scale;
    motion.lift_mm = 0.05 * scale;
    motion.tremor_mm = 0.02 * scale;
    const std::vector<haptic::StrokeSample> strokes = handStroke(subject.field, motion);
    const std::vector<Truth> truths = truthsOf(subject.field, strokes);
    beaten = std::max(beaten, beatenBy(subject.field, strokes, truths));
    for (const Level& level : kLevels) {
      if (job.cancelled()) return engine::cancelled();
      study.rows.push_back(measure(subject.name, subject.field, level, strokes, truths));
      job.advance();
    }
  }
  study.reference = fmt::format(
      "The true closest point of all cells within {} cells (level certified, branch and bound in double; "
      "proved "
      "against long double brute force by ctest -R Certified). Checked here by looking at 33 x 33 points of "
      "every "
      "cell in that radius, for twelve ticks of each subject: none was nearer by more than {:.1e} mm.",
      kReferenceCells, std::max(beaten, 0.0));
  const AccuracyRow& fast = rowOf(study, "noise", "paper, to rest");
  const AccuracyRow& sure = rowOf(study, "noise", "certified, 8 cells");
  const AccuracyRow& flat = rowOf(study, "flat", "paper, to rest");
  study.answer = fmt::format(
      "The fast level (paper, to rest) loses nothing on smooth surfaces (flat: {:.1e} N) and rests in a "
      "minimum "
      "that is not the nearest in {:.1f} % of the ticks on noise of 20 um: force is off by {:.3f} N on "
      "average, "
      "{:.3f} N at worst, with 1 N/mm. Being certain within 8 cells costs {:.1f} times its time.",
      flat.error, 100 * fast.wrong, fast.error, fast.error_worst, sure.cost / fast.cost);
  return study;
}

}  // namespace fettle::bench
