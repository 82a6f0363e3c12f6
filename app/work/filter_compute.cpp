#include "app/work/filter_compute.h"

#include <fmt/format.h>

#include "app/terminal.h"

namespace fettle::app {

engine::Result<engine::Filtered> FilterCompute::apply(const engine::Version& input,
                                                      const engine::Version& original,
                                                      const engine::FilterSpec& spec,
                                                      engine::JobControl& job) {
  if (!device_) return engine::applyFilter(input, original, spec, job);
  auto filtered = engine::applyFilter(input, original, spec, *device_, job);
  if (filtered || where_ == Compute::kGpu || filtered.error().kind != engine::ErrorKind::kFailed)
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
