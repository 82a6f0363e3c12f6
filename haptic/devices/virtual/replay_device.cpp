#include "haptic/devices/virtual/replay_device.h"

#include <utility>

#include "engine/base/stopwatch.h"

namespace fettle::haptic {

ReplayDevice::ReplayDevice(std::vector<StrokeSample> strokes, ReplayPace pace)
    : strokes_(std::move(strokes)), pace_(pace) {
  profile_.name = "replay";
  profile_.space = DeviceSpace::kField;
  profile_.workspace_radius_mm = 1e9;
  profile_.max_force_n = 0.0;
  profile_.gives_force = false;
}

engine::Status ReplayDevice::start() {
  read_rows_ = 0;
  started_ = false;
  const std::uint64_t sequence = input_.sequence;  // never goes back
  input_ = {};
  input_.sequence = sequence;
  return {};
}

DeviceInput ReplayDevice::read() noexcept {
  return readAt(engine::steadyNs());
}

DeviceInput ReplayDevice::readAt(std::int64_t now_ns) noexcept {
  if (strokes_.empty()) return input_;
  if (!started_) {
    started_ = true;
    started_ns_ = now_ns;
  }
  if (pace_ == ReplayPace::kEachRead) {
    if (read_rows_ < strokes_.size()) ++read_rows_;
  } else {
    const double t = strokes_.front().t + 1e-9 * static_cast<double>(now_ns - started_ns_);
    if (read_rows_ == 0) read_rows_ = 1;
    // Half a nanosecond of tolerance: a row whose time is now is due, however the subtraction rounds.
    while (read_rows_ < strokes_.size() && !(strokes_[read_rows_].t > t + 5e-10)) ++read_rows_;
  }
  const StrokeSample& row = strokes_[read_rows_ - 1];
  input_.position_mm = row.tip_mm;
  input_.tool = row.tool;
  input_.buttons = row.tool == Tool::kFeel ? 0 : kPrimaryButton;
  input_.link = LinkState::kConnected;
  input_.arrival_ns = now_ns;
  ++input_.sequence;
  return input_;
}

}  // namespace fettle::haptic
