#include "haptic/tick/replay.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>

#include <glm/geometric.hpp>

#include "engine/base/stopwatch.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/contact/certified.h"
#include "haptic/tick/tick.h"

namespace fettle::haptic {

namespace {

// Ticks between two checks for cancellation: about a millisecond.
constexpr std::size_t kTicksAStep = 4096;

std::int64_t countChangedSamples(const engine::Version& before, const engine::Version& after) {
  std::int64_t changed = 0;
  for (const engine::TileChange& change : engine::changedTiles(before, after))
    for (std::size_t i = 0; i < change.before->samples.size(); ++i) {
      const float a = change.before->samples[i];
      const float b = change.after->samples[i];
      changed += std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b) &&
                         !(std::isnan(a) && std::isnan(b))
                     ? 1
                     : 0;
    }
  return changed;
}

std::int64_t countMarked(const engine::FieldReader& reader) noexcept {
  std::int64_t marked = 0;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) marked += reader.tile(tc, tr).marked_samples;
  return marked;
}

// Compares a tick's proxy with the certified closest point on the surface that the tick felt.
class ContactMeasure {
 public:
  ContactMeasure(const engine::Version& felt, int radius_cells) noexcept
      : radius_mm_(radius_cells * std::max(felt.grid().spacingXMm(), felt.grid().spacingYMm())) {}

  void add(const engine::Version& felt, const Contact& contact, const glm::dvec3& endpoint,
           ReplayReport& report) const noexcept {
    Surface surface(felt.reader());
    SurfacePoint closest;
    if (!certifiedClosest(surface, endpoint, radius_mm_, closest)) return;
    const double paper = std::sqrt(contact.proxy.distance2_mm2);
    const double certified = std::sqrt(closest.distance2_mm2);
    if (!(paper - certified > 1e-9 * paper)) return;
    ++report.above_certified;
    report.worst_excess_mm = std::max(report.worst_excess_mm, paper - certified);
  }

 private:
  double radius_mm_;
};

engine::Result<ReplayResult> run(const engine::Version& start, const engine::Version& original,
                                 std::span<const StrokeSample> strokes, const Scene& scene,
                                 const ReplayOptions& options, engine::JobControl& job) {
  const engine::Version felt = scene.invert ? start.inverted() : start;
  const engine::Version reference = scene.invert ? original.inverted() : original;
  engine::LiveField field(felt, engine::Growth::kAllowed);
  Tick tick(scene, field, reference);
  const ContactMeasure measure(felt, scene.certified_radius_cells);
  const bool measured = options.measure == MeasureContact::kYes;

  ReplayResult result;
  ReplayReport& report = result.report;
  if (options.record_forces == RecordForces::kYes) result.forces.reserve(strokes.size());
  double max_force2 = 0.0;
  job.begin("replaying", strokes.size());
  const engine::Stopwatch watch;
  {
    const DenormalScope as_in_the_loop;  // bit-identical to the loop
    for (std::size_t i = 0; i < strokes.size(); i += kTicksAStep) {
      if (job.cancelled()) return engine::cancelled();
      const std::span<const StrokeSample> part =
          strokes.subspan(i, std::min(kTicksAStep, strokes.size() - i));
      for (const StrokeSample& sample : part) {
        // The surface before the tick's own edit: a version is O(1) to take.
        const engine::Version before = measured ? field.snapshot() : engine::Version();
        const ForceSample force = tick.run(sample);
        report.contact_ticks += force.contact ? 1 : 0;
        max_force2 = std::max(max_force2, glm::dot(force.force_n, force.force_n));
        if (measured && force.contact) measure.add(before, tick.contact(), sample.tip_mm, report);
        if (options.record_forces == RecordForces::kYes) result.forces.push_back(force);
        if (options.listen)
          if (auto status = options.listen(tick.heard(), sample); !status)
            return tl::unexpected(status.error());
      }
      job.advance(part.size());
    }
  }
  report.ticks = static_cast<std::int64_t>(strokes.size());
  report.max_force_n = std::sqrt(max_force2);
  report.seconds = watch.seconds();
  report.ticks_per_second = report.seconds > 0.0 ? static_cast<double>(report.ticks) / report.seconds : 0.0;
  report.counters = tick.counters();
  if (report.counters.refused_edits > 0)
    return engine::failure("memory for the edited tiles could not be allocated", "replay",
                           "close other programs");

  const engine::Version after = field.snapshot();
  report.samples_changed = countChangedSamples(felt, after);
  report.marked = countMarked(after.reader());
  result.field = scene.invert ? after.inverted() : after;
  return result;
}

}  // namespace

engine::Result<ReplayResult> replay(const engine::Version& start, const engine::Version& original,
                                    std::span<const StrokeSample> strokes, const Scene& scene,
                                    const ReplayOptions& options, engine::JobControl& job) {
  if (const std::optional<std::string> problem = sceneProblem(scene))
    return engine::inputError(*problem, "scene");
  if (scene.tip == TipShape::kSphere) {
    if (const std::optional<std::string> problem = sphereProblem(scene.tip_radius_mm, start.grid()))
      return engine::inputError(*problem, "scene");
    if (options.measure == MeasureContact::kYes)
      return engine::inputError("a ball's contact has no certified one to be measured by", "scene",
                                "measure with the tip \"point\"");
  }
  if (start.grid().width != original.grid().width || start.grid().height != original.grid().height)
    return engine::inputError("the original field has another size than the field", "replay",
                              "give the scan that the field was made from");
  try {
    return run(start, original, strokes, scene, options, job);
  } catch (const std::bad_alloc&) {
    return engine::failure("memory for the forces could not be allocated", "replay", "replay without forces");
  }
}

}  // namespace fettle::haptic
