#pragma once

#include <memory>
#include <string>
#include <utility>

#include "engine/filter/filter_work.h"
#include "engine/filter/tgv_device.h"

namespace fettle::app {

/// Where the steps of a filter are carried out.
enum class Compute {
  kAuto,  ///< on a hardware graphics device where there is one and the filter can use it, else on the processor
  kCpu,
  kGpu,  ///< on a graphics device, one that runs on the processor (lavapipe) included; an error where it cannot
};

/// Applies a filter to any number of fields, on a device that was chosen before.
/// Threading: one thread at a time.
class FilterCompute {
 public:
  /// `device`: null for the processor.
  FilterCompute(Compute where, std::unique_ptr<engine::TgvDevice> device)
      : where_(where), device_(std::move(device)) {}

  /// engine::applyFilter. A device that fails meanwhile is an error with kGpu; with kAuto a warning, and the whole filter
  /// runs on the processor instead, for this field and all that follow: no result is of both. `work`
  /// (engine::FilterTuning::work) belongs to one of them: with it a device that fails is an error.
  [[nodiscard]] engine::Result<engine::Filtered> apply(const engine::Version& input,
                                                       const engine::Version& original,
                                                       const engine::FilterSpec& spec,
                                                       engine::JobControl& job,
                                                       engine::FilterWork* work = nullptr);

  /// That the last result is of; empty: the processor.
  [[nodiscard]] const std::string& device() const noexcept;

 private:
  Compute where_;
  std::unique_ptr<engine::TgvDevice> device_;
};

}  // namespace fettle::app
