#include "bench/measure_bench.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <random>
#include <utility>
#include <variant>
#include <vector>

#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/measure/align.h"
#include "engine/measure/areal.h"
#include "engine/measure/form.h"
#include "engine/measure/line_offsets.h"
#include "engine/measure/line_suggestion.h"
#include "engine/measure/lowered.h"
#include "engine/measure/scale_filter.h"
#include "engine/measure/section.h"
#include "engine/remove/remove.h"
#include "engine/transform/rearrange.h"
#include "engine/transform/resample.h"

namespace fettle::bench {

namespace {

using engine::JobControl;
using engine::Result;
using engine::Version;
using Bits = std::uint64_t;

constexpr double kCutOffMm = 25 * kSpacingMm;

// Waves of 0.5 mm on a tilt, a wall of 2 mm, noise of 5 um.
Result<Version> wavedField(std::int32_t side) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = kSpacingMm;
  auto builder = engine::FieldBuilder::create(grid, "the field");
  if (!builder) return tl::unexpected(builder.error());
  std::vector<float> row(static_cast<std::size_t>(side));
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0F, 0.005F);
  for (std::int32_t r = 0; r < side; ++r) {
    const double along = std::cos(r * 0.013) + 0.0002 * r;
    for (std::int32_t c = 0; c < side; ++c)
      row[static_cast<std::size_t>(c)] =
          static_cast<float>(0.5 * (std::sin(c * 0.01) + along) + 0.0001 * c + (c > side / 3 ? 2.0 : 0.0)) +
          noise(random);
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return std::move(*builder).build();
}

Bits mixed(Bits sum, double figure) {
  return (std::rotl(sum, 5) ^ std::bit_cast<Bits>(figure)) * 0x9E3779B97F4A7C15U;
}

Bits bitsOf(const std::vector<double>& figures) {
  Bits sum = 0;
  for (const double figure : figures) sum = mixed(sum, figure);
  return sum;
}

/// What a step makes or finds. Its hash is none of the step's time.
using Outcome = std::variant<Version, std::vector<double>>;

Bits hashOf(const Outcome& outcome) {
  if (const Version* const field = std::get_if<Version>(&outcome)) return engine::contentHash(*field);
  return bitsOf(std::get<std::vector<double>>(outcome));
}

Result<Outcome> outcomeOf(Result<Version> field) {
  if (!field) return tl::unexpected(field.error());
  return *std::move(field);
}

Result<Outcome> levelled(const Version& field, const engine::FormOptions& options, JobControl& job) {
  const auto fit = engine::fitForm(field, options, job);
  if (!fit) return tl::unexpected(fit.error());
  return outcomeOf(engine::withoutForm(field, fit->form, job));
}

Result<Outcome> linesTaken(const Version& field, const engine::LineOptions& options, JobControl& job) {
  const auto lines = engine::findLineOffsets(field, options, job);
  if (!lines) return tl::unexpected(lines.error());
  return outcomeOf(engine::lowered(
      field, "taking lines out", [&](const auto& rect, double* out) { lines->readHeights(rect, out); }, job));
}

Result<Outcome> suggested(const Version& field, JobControl& job) {
  const auto found = engine::suggestLevelling(field, {}, job);
  if (!found) return tl::unexpected(found.error());
  std::vector<double> apart{found->before};
  for (const auto& tried : found->tried) apart.push_back(tried.apart);
  return apart;
}

Result<Outcome> sectioned(const Version& field, double width_mm, JobControl& job) {
  const engine::Grid& grid = field.grid();
  const glm::dvec2 end((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  const glm::dvec2 points[] = {end * 0.1, end * 0.9};
  const auto section = engine::sectionAlong(field, points, {.width_mm = width_mm}, job);
  if (!section) return tl::unexpected(section.error());
  return section->height;
}

Result<Outcome> parameters(const Version& field, const engine::ArealOptions& options, JobControl& job) {
  const auto fit = engine::fitForm(field, {}, job);
  if (!fit) return tl::unexpected(fit.error());
  const auto found = engine::measureAreal(field, fit->form, options, job);
  if (!found) return tl::unexpected(found.error());
  return std::vector{found->sq,  found->ssk, found->sku,        found->sa,
                     found->sdq, found->sdr, found->feature.spd};
}

// The field shifted and turned, brought back onto it.
Result<Outcome> aligned(const Version& field, const Version& moved, JobControl& job) {
  const auto found = engine::alignFields(field, moved, {}, job);
  if (!found) return tl::unexpected(found.error());
  return std::vector{found->motion.shift.x, found->motion.shift.y, found->motion.shift.z,
                     found->angles.rotation_z};
}

// A marked row through every tile.
Result<Version> markedField(const Version& field) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  for (std::int32_t r = engine::kTileSide / 2; r < field.grid().height; r += engine::kTileSide)
    for (std::int32_t c = 0; c < field.grid().width; ++c)
      if (!live.setMark(c, r, true))
        return engine::failure("memory for marks could not be had", "bench measure");
  return live.snapshot();
}

Result<Outcome> removed(const Version& field, const engine::RemoveOptions& options, JobControl& job) {
  auto done = engine::removeSamples(field, options, job);
  if (!done) return tl::unexpected(done.error());
  return std::move(done->field);
}

struct Step {
  const char* name;
  std::function<Result<Outcome>(const Version&, JobControl&)> run;
};

std::vector<Step> steps(const Version& moved, const Version& marked) {
  const auto form = [](int degree, bool robust) {
    return [=](const Version& f, JobControl& job) {
      return levelled(f, {.degree = degree, .robust = robust}, job);
    };
  };
  const auto section = [](double width_mm) {
    return [=](const Version& f, JobControl& job) { return sectioned(f, width_mm, job); };
  };
  const auto measured = [](bool spatial_and_features) {
    return [=](const Version& f, JobControl& job) {
      return parameters(f, {.spatial = spatial_and_features, .feature = spatial_and_features}, job);
    };
  };
  return {
      {"level, plane", form(1, false)},
      {"level, plane, robust", form(1, true)},
      {"level, degree 5", form(5, false)},
      {"level, rows by median", [](const Version& f, JobControl& job) { return linesTaken(f, {}, job); }},
      {"level, way suggested", suggested},
      {"section", section(0.0)},
      {"section, 100 lanes wide", section(99 * kSpacingMm)},
      {"S-filter, 25 samples",
       [](const Version& f, JobControl& job) {
         engine::FilterSpec gaussian;
         gaussian.kind = engine::FilterKind::kArealGaussian;
         gaussian.nesting_mm = kCutOffMm;
         return outcomeOf(engine::scaleFiltered(f, gaussian, engine::Waves::kLong, job));
       }},
      {"height, hybrid, functional", measured(false)},
      {"all parameters", measured(true)},
      {"quarter turn",
       [](const Version& f, JobControl& job) { return outcomeOf(engine::turned(f, {.quarters = 1}, job)); }},
      {"turned by 7 degrees",
       [](const Version& f, JobControl& job) {
         return outcomeOf(
             engine::resampled(f, {.angle_deg = 7.0, .spacing_x = kSpacingMm, .spacing_y = kSpacingMm}, job));
       }},
      {"align", [&moved](const Version& f, JobControl& job) { return aligned(f, moved, job); }},
      {"remove above 2 mm", [](const Version& f, JobControl& job) { return removed(f, {.low = 2.0}, job); }},
      {"remove marked rows",
       [&marked](const Version&, JobControl& job) {
         return removed(marked, {.region = engine::Region::kMarked}, job);
       }},
  };
}

}  // namespace

Result<MeasureBenchReport> benchMeasure(const MeasureBenchOptions& options, JobControl& job) {
  if (options.side < 512 || options.side > 32768 || options.repeats < 1 || options.repeats > 100)
    return engine::inputError("these options cannot be measured", "bench measure",
                              "give 512 to 32768 samples");
  MeasureBenchReport report;
  report.machine = machine();
  report.samples = std::int64_t{options.side} * options.side;
  const auto field = wavedField(options.side);
  if (!field) return tl::unexpected(field.error());
  const auto moved =
      engine::resampled(*field, {.angle_deg = 2.0, .spacing_x = kSpacingMm, .spacing_y = kSpacingMm}, job);
  if (!moved) return tl::unexpected(moved.error());
  const auto marked = markedField(*field);
  if (!marked) return tl::unexpected(marked.error());
  std::vector<float> copy(static_cast<std::size_t>(report.samples));
  for (const Step& step : steps(*moved, *marked)) {
    MeasureBenchRow row;
    row.step = step.name;
    std::vector<double> plain, seconds;
    for (int k = 0; k < options.repeats; ++k) {
      plain.push_back(secondsOf(
          [&] { field->reader().readHeights(0, 0, options.side, options.side, copy.data(), options.side); }));
      Result<Outcome> outcome;
      seconds.push_back(secondsOf([&] { outcome = step.run(*field, job); }));
      if (!outcome) return tl::unexpected(outcome.error());
      const Bits bits = hashOf(*outcome);
      if (k > 0 && bits != row.bits) return engine::failure("two repeats differ", step.name);
      row.bits = bits;
    }
    row.plain = median(plain);
    row.median = median(seconds);
    row.fastest = *std::ranges::min_element(seconds);
    row.slowest = *std::ranges::max_element(seconds);
    report.rows.push_back(std::move(row));
  }
  return report;
}

}  // namespace fettle::bench
