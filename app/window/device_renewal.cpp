#include "app/window/device_renewal.h"

#include <array>

namespace fettle::app {
namespace {

using namespace std::chrono_literals;

// Before each attempt: a driver that restarts takes a second or two.
constexpr std::array<std::chrono::milliseconds, 6> kPauses{0ms, 100ms, 300ms, 800ms, 1500ms, 2500ms};
constexpr std::uint64_t kLasts = 3;  // frames shown after a loss until a new loss counts as another one

}  // namespace

bool DeviceRenewal::lost(std::uint64_t frames, Clock::time_point now) {
  ++losses_;
  if (frames >= renewed_frame_ + kLasts) tries_ = 0;
  if (static_cast<std::size_t>(tries_) >= kPauses.size()) return false;
  next_ = now + kPauses.at(static_cast<std::size_t>(tries_++));
  return true;
}

}  // namespace fettle::app
