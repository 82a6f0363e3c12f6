#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/subjects.h"
#include "engine/base/statistics.h"
#include "engine/base/stopwatch.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/devices/virtual/simulated_hand.h"
#include "haptic/tick/tick.h"

namespace fettle::bench {
namespace {

constexpr double kReferenceHz = 40'000.0;
constexpr double kStiffness = 2.0;  // N/mm: stable on a good hand device at 1 kHz
constexpr double kRates[] = {500.0, 1000.0, 2000.0, 5000.0, 10'000.0};

struct Pressed {
  std::vector<glm::dvec3> force_n;            // per tick
  std::vector<haptic::StrokeSample> strokes;  // inputs of the ticks
  double work_mj = 0.0;                       // of the surface on the hand, from free space to free space
};

// From free space, a tap, a press and a slide of 5 mm, and back into free space.
Pressed press(const engine::Version& field, double rate_hz, double seconds) {
  haptic::Scene scene = haptic::defaultScene();
  scene.effects = {haptic::EffectKind::kSpring};
  scene.stiffness_n_per_mm = kStiffness;
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  haptic::HandSpec spec;
  spec.rate_hz = rate_hz;
  const double x = 0.25 * (field.grid().width - 1) * field.grid().spacingXMm();
  const double y = 0.5 * (field.grid().height - 1) * field.grid().spacingYMm();
  const double s = seconds;
  haptic::SimulatedHand hand({{0.0, {x, y, 2.0}},
                              {0.1 * s, {x, y, -1.0}},
                              {0.2 * s, {x, y, 2.0}},
                              {0.35 * s, {x, y, -1.0}},
                              {0.75 * s, {x + 5.0, y + 0.4, -1.0}},
                              {0.9 * s, {x + 5.0, y + 0.4, 4.0}},
                              {s, {x + 5.0, y + 0.4, 4.0}}},
                             spec);
  Pressed out;
  while (!hand.finished()) {
    const glm::dvec3 at = hand.read().position_mm;
    out.strokes.push_back({hand.seconds(), at, haptic::Tool::kFeel});
    const haptic::ForceSample felt = tick.run(out.strokes.back());
    hand.write(felt.force_n);
    out.force_n.push_back(felt.force_n);
  }
  out.work_mj = hand.workOnHandMj();
  return out;
}

// The work of the held forces over the recorded positions [mJ]: each is constant while it is held.
double heldWork(const Pressed& pressed) {
  double work_mj = 0.0;
  for (std::size_t i = 0; i + 1 < pressed.strokes.size(); ++i)
    work_mj += glm::dot(pressed.force_n[i], pressed.strokes[i + 1].tip_mm - pressed.strokes[i].tip_mm);
  return work_mj;
}

// Nanoseconds per tick over the recorded strokes, without the simulated hand.
std::vector<double> times(const engine::Version& field, const Pressed& pressed) {
  haptic::Scene scene = haptic::defaultScene();
  scene.effects = {haptic::EffectKind::kSpring};
  scene.stiffness_n_per_mm = kStiffness;
  const haptic::DenormalScope as_in_the_loop;
  std::vector<double> ns;
  for (int i = 0; i < 5; ++i) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, field);
    const engine::Stopwatch watch;
    for (const haptic::StrokeSample& s : pressed.strokes) (void)tick.run(s);
    ns.push_back(watch.ns() / static_cast<double>(pressed.strokes.size()));
  }
  return ns;
}

// The row of a rate, without its error.
AccuracyRow rowAt(double rate, const Subject& subject, const Pressed& pressed) {
  AccuracyRow row{subject.name, fmt::format("{:g} kHz", rate / 1000.0)};
  std::vector<double> shares = times(subject.field, pressed);
  for (double& ns : shares) ns *= rate * 1e-9 * 100.0;
  spread(std::move(shares), row);
  row.wrong = std::numeric_limits<double>::quiet_NaN();
  return row;
}

// Force between two ticks of the reference, as a hold of its last one.
const glm::dvec3& heldAt(const Pressed& pressed, double t) {
  const auto i = static_cast<std::size_t>(std::max(0.0, t * kReferenceHz + 1e-6));
  return pressed.force_n[std::min(i, pressed.force_n.size() - 1)];
}

}  // namespace

engine::Result<Study> rateStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"rate",
              "Rate: how often the surface answers",
              "Is 1 kHz enough?",
              {"share of a processor", "%"},
              {"mean force error", "N"}};
  auto subjects = hardSubjects(256);
  if (!subjects) return tl::unexpected(subjects.error());
  const double seconds = std::max(0.5, 4.0 * options.effort);
  job.begin("loop rates", subjects->size() * (std::size(kRates) + 1));
  double check = 0.0;
  for (const Subject& subject : *subjects) {
    const Pressed reference = press(subject.field, kReferenceHz, seconds);
    // Doubling the reference's own rate: the remaining change of its result.
    if (subject.name == "flat") {
      const Pressed doubled = press(subject.field, 2.0 * kReferenceHz, seconds);
      double sum = 0.0;
      for (std::size_t i = 0; i < reference.force_n.size(); ++i)
        sum +=
            glm::length(reference.force_n[i] - doubled.force_n[std::min(2 * i, doubled.force_n.size() - 1)]);
      check = sum / static_cast<double>(reference.force_n.size());
    }
    job.advance();
    for (const double rate : kRates) {
      if (job.cancelled()) return engine::cancelled();
      const Pressed pressed = press(subject.field, rate, seconds);
      AccuracyRow row = rowAt(rate, subject, pressed);
      std::vector<double> errors, flat;
      for (std::size_t i = 0; i < pressed.strokes.size(); ++i) {
        errors.push_back(glm::length(pressed.force_n[i] - heldAt(reference, pressed.strokes[i].t)));
        flat.push_back(pressed.force_n[i].z);
      }
      summarise(std::move(errors), row);
      row.hash = engine::hashOf(flat);
      study.rows.push_back(std::move(row));
      job.advance();
    }
  }
  study.reference = fmt::format(
      "The same hand (0.15 kg on 0.3 N/mm, closed loop, {:g} N/mm surface) at {:g} kHz. Checked on the flat "
      "by doubling that once more: its force moves by {:.1e} N on average.",
      kStiffness, kReferenceHz / 1000.0, check);
  const AccuracyRow& usual = rowOf(study, "flat", "1 kHz");
  const AccuracyRow& noise = rowOf(study, "noise", "1 kHz");
  const AccuracyRow& fast = rowOf(study, "noise", "10 kHz");
  study.answer = fmt::format(
      "At 1 kHz the force of the whole movement is off by {:.3f} N on average on the flat and {:.3f} N on "
      "noise of 20 um; 10 kHz brings the latter to {:.3f} N for {:.2f} % of a processor instead of {:.2f} %. "
      "Where hand and noise meet, two runs part as soon as one slides into another pit: errors there do not "
      "vanish with the rate.",
      usual.error, noise.error, fast.error, fast.cost, noise.cost);
  return study;
}

engine::Result<Study> energyStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"energy",
              "Energy: what a sampled surface gives out",
              "Does the surface put energy into the hand, and how much less at a higher rate?",
              {"share of a processor", "%"},
              {"energy gained by the hand, from free air to free air", "mJ"}};
  auto subjects = hardSubjects(256);
  if (!subjects) return tl::unexpected(subjects.error());
  const double seconds = std::max(0.5, 4.0 * options.effort);
  job.begin("energy", subjects->size() * std::size(kRates));
  double check = 0.0;
  for (const Subject& subject : *subjects)
    for (const double rate : kRates) {
      if (job.cancelled()) return engine::cancelled();
      const Pressed pressed = press(subject.field, rate, seconds);
      if (subject.name == "flat") check = std::max(check, std::abs(pressed.work_mj - heldWork(pressed)));
      AccuracyRow row = rowAt(rate, subject, pressed);
      row.error = std::max(0.0, pressed.work_mj);
      row.error_p99 = row.error_worst = std::numeric_limits<double>::quiet_NaN();
      row.hash = engine::hashOf({&pressed.work_mj, 1});
      if (pressed.work_mj < 0.0) row.note = fmt::format("the surface took {:.3f} mJ", -pressed.work_mj);
      study.rows.push_back(std::move(row));
      job.advance();
    }
  study.reference = fmt::format(
      "A spring is conservative: from free air to free air it gives nothing. The work is that of the held "
      "force over the hand's own steps within a tick; summed again from the recorded ticks it is the same to "
      "{:.1e} mJ. A hand holds its own: 0.15 kg on 0.3 N/mm with damping takes up what is given out, which "
      "is why it does not buzz (fettle bench stability).",
      check);
  const AccuracyRow *slow = nullptr, *usual = nullptr;  // the worst subjects
  for (const AccuracyRow& row : study.rows) {
    if (row.method == "0.5 kHz" && (slow == nullptr || row.error > slow->error)) slow = &row;
    if (row.method == "1 kHz" && (usual == nullptr || row.error > usual->error)) usual = &row;
  }
  study.answer = fmt::format(
      "Tapping, pressing and sliding on the flat, the hand gains {:.4f} mJ at 1 kHz and {:.4f} at 10 kHz: "
      "the force of a tick is held while the hand already leaves. Worst is the {}: {:.3f} mJ at 1 kHz, "
      "{:.3f} at 0.5 kHz on the {}. The effect \"passivity\" counts it and takes it out.",
      rowOf(study, "flat", "1 kHz").error, rowOf(study, "flat", "10 kHz").error, usual->subject, usual->error,
      slow->error, slow->subject);
  return study;
}

}  // namespace fettle::bench
