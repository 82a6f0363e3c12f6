#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/subjects.h"
#include "haptic/trials/contact_trial.h"

namespace fettle::bench {
namespace {

constexpr int kRepeats = 5;
constexpr double kCellMm = 0.05;  // of the subjects made here; others are scaled to it

AccuracyRow rowFor(const std::string& subject, const trials::ContactChoice& choice,
                   const trials::ContactFigures& figures, double newtons_a_mm) {
  AccuracyRow row{subject, choice.name};
  row.cost = figures.ns;
  row.cost_worst = figures.ns_worst;
  row.error = figures.mean_mm * newtons_a_mm;
  row.error_p99 = figures.p99_mm * newtons_a_mm;
  row.error_worst = figures.worst_mm * newtons_a_mm;
  row.wrong = figures.wrong;
  row.hash = figures.hash;
  if (figures.beyond > 0)
    row.note = fmt::format("{} ticks deeper than the reference looks, left out", figures.beyond);
  return row;
}

}  // namespace

engine::Result<Study> contactStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"contact",
              "Contact: which point of the surface is felt",
              "What is the error of the fast level?",
              {"time per tick", "ns"},
              {"mean force error, 1 N/mm, cells of 0.05 mm", "N"}};
  study.wrong_name = "ticks not at the closest point";
  auto made = hardSubjects(512);
  if (!made) return tl::unexpected(made.error());
  std::vector<Subject> subjects = *std::move(made);
  if (options.scan) subjects.push_back({options.scan->name, options.scan->field});
  const std::span<const trials::ContactChoice> choices = trials::contactChoices();
  job.begin("contact levels", subjects.size() * choices.size());
  const std::int64_t ticks = std::max<std::int64_t>(200, std::llround(50'000 * options.effort));
  double point_truth_error = 0.0, ball_truth_error = 0.0;
  for (const Subject& subject : subjects) {
    const double newtons_a_mm = kCellMm / subject.field.grid().spacingXMm();
    std::optional<trials::ContactTrial> trial;
    double tried = -1.0;  // the tip of the trial
    for (const trials::ContactChoice& choice : choices) {
      if (choice.ball_radius_cells != tried) {
        tried = choice.ball_radius_cells;
        // A ball takes a hundred times as long as a point.
        auto next =
            trials::ContactTrial::make(subject.field, tried, tried > 0.0 ? (ticks + 9) / 10 : ticks, job);
        if (!next) return tl::unexpected(next.error());
        trial = *std::move(next);
        if (trial && tried > 0.0)
          ball_truth_error = std::max(ball_truth_error, trial->truthError() * newtons_a_mm);
        else if (trial)
          point_truth_error = std::max(point_truth_error, trial->truthError());
      }
      job.advance();
      if (!trial) continue;
      const auto figures = trial->measure(choice, kRepeats, job);
      if (!figures) return tl::unexpected(figures.error());
      study.rows.push_back(rowFor(subject.name, choice, *figures, newtons_a_mm));
    }
  }
  study.reference = fmt::format(
      "For a point, the true closest point of all cells within 16 cells (level certified, branch and bound "
      "in double; proved against long double brute force by ctest -R Certified). Checked here by looking at "
      "33 x 33 points of every cell in that radius, for twelve ticks of each subject: none was nearer by "
      "more than {:.1e} mm. For a ball, the same on the field grown by the ball, 8 x 8 samples per cell, "
      "over 96 x 96 cells: its centres stand one radius from the surface to within {:.1e} mm of cells of "
      "0.05 mm, so errors below that are the reference's own. There a ball is at the closest point when it "
      "is within 0.02 cells of it.",
      point_truth_error, ball_truth_error);
  const AccuracyRow& fast = rowOf(study, "noise", "paper");
  const AccuracyRow& sure = rowOf(study, "noise", "certified, 8 cells");
  const AccuracyRow& flat = rowOf(study, "flat", "paper");
  const AccuracyRow& ball = rowOf(study, "noise", "ball, radius 2 cells");
  study.answer = fmt::format(
      "The fast level (paper) loses nothing on smooth surfaces (flat: {:.1e} N) and rests in a "
      "minimum that is not the nearest in {:.1f} % of the ticks on noise of 20 um: force is off by {:.3f} N "
      "on average, {:.3f} N at worst, with 1 N/mm. Being certain within 8 cells costs {:.1f} times its time; "
      "a ball of 2 cells, which slides and never jumps, is off by {:.3f} N for {:.0f} times.",
      flat.error, 100 * fast.wrong, fast.error, fast.error_worst, sure.cost / fast.cost, ball.error,
      ball.cost / fast.cost);
  return study;
}

}  // namespace fettle::bench
