#include "app/work/filter_compute.h"

#include <fmt/format.h>

#include "app/terminal.h"
#include "engine/filter/pass.h"

namespace fettle::app {

engine::Result<engine::Filtered> FilterCompute::apply(const engine::Version& input,
                                                      const engine::Version& original,
                                                      const engine::FilterSpec& spec, engine::JobControl& job,
                                                      engine::FilterWork* work) {
  engine::FilterTuning tuning;
  tuning.work = work;
  if (!device_) return engine::applyFilter(input, original, spec, tuning, job);
  auto filtered = engine::applyFilter(input, original, spec, *device_, job, work);
  if (filtered || where_ == Compute::kGpu || work != nullptr ||
      filtered.error().kind != engine::ErrorKind::kFailed)
    return filtered;
  warn(fmt::format("{}: the processor filters instead, from the beginning", filtered.error().line()));
  device_.reset();
  return engine::applyFilter(input, original, spec, job);
}

const std::string& FilterCompute::device() const noexcept {
  static const std::string none;
  return device_ ? device_->name() : none;
}

}  // namespace fettle::app
