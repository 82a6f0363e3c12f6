#include "engine/fill/fill.h"

#include <new>
#include <span>

#include "engine/fill/hole_filler.h"
#include "engine/fill/holes.h"

namespace fettle::engine {

Result<Filled> fillHoles(const Version& field, const FillOptions& options, JobControl& job) try {
  if (field.reader().bounds().empty())
    return inputError("every sample is a hole, so there is nothing to fill from", "the field",
                      "give a scan with heights");
  const auto holes = findHoles(field, job);
  if (!holes) return tl::unexpected(holes.error());
  Filled filled;
  const ChosenHoles chosen = chooseHoles(*holes, options, field.grid(), filled);
  filled.field = field;
  job.begin("filling holes", static_cast<std::uint64_t>(chosen.samples));
  if (chosen.holes.empty()) return job.cancelled() ? Result<Filled>(cancelled()) : filled;
  HoleFiller filler(field, options);
  if (auto done = filler.fill(*holes, chosen.holes, filled, job); !done) return tl::unexpected(done.error());
  filled.field = filler.snapshot();
  return filled;
} catch (const std::bad_alloc&) {
  return failure("there is not enough memory for the equations of a hole", "fill",
                 "fill smaller holes alone");
}

BeyondBefore beyondBefore(const Version& before, const Version& filled) noexcept {
  const HeightBounds old = before.reader().bounds(), now = filled.reader().bounds();
  if (old.empty() || now.empty()) return {};
  const double worth_saying = 0.05 * (double{old.max} - double{old.min});
  const auto far = [&](double beyond) { return beyond > worth_saying ? beyond : 0.0; };
  return {far(double{old.min} - double{now.min}), far(double{now.max} - double{old.max})};
}

}  // namespace fettle::engine
