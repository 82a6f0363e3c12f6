#include "haptic/sound/modal_body.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fettle::haptic {

namespace {

constexpr std::array kFreeBar = {1.0, 2.756, 5.404, 8.933};
constexpr double kBand = 0.42;         // of the rate: modes above it alias or cannot be heard
constexpr double kThousandth = 6.908;  // ln 1000
constexpr double kRungOut = 1e-9;      // 90 dB below the last bit of 16

}  // namespace

void ModalBody::set(double lowest_hz, double ring_s, double rate_hz) noexcept {
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    Mode& mode = modes_[i];
    const double hz = lowest_hz * kFreeBar[i];
    if (hz > kBand * rate_hz) {
      mode = {};
      continue;
    }
    const double turn = 2.0 * std::numbers::pi * hz / rate_hz;
    const double decay = std::exp(-kThousandth * std::sqrt(kFreeBar[i]) / (ring_s * rate_hz));
    mode.feedback = 2.0 * decay * std::cos(turn);
    mode.decay2 = decay * decay;
    const double share = 1.0 / static_cast<double>(i + 1);
    mode.from_blow = share * std::sin(turn);
    // Of a sine at its own frequency a resonator gathers 1 / (2 (1 - decay)) of what a blow is.
    mode.from_drive = 2.0 * (1.0 - decay) * mode.from_blow;
  }
}

double ModalBody::next(double blow, double drive) noexcept {
  double sum = 0.0;
  for (Mode& mode : modes_) {
    const double y =
        mode.feedback * mode.y1 - mode.decay2 * mode.y2 + mode.from_blow * blow + mode.from_drive * drive;
    mode.y2 = mode.y1;
    mode.y1 = y;
    sum += y;
  }
  return sum;
}

void ModalBody::settle() noexcept {
  for (Mode& mode : modes_)
    if (std::max(std::abs(mode.y1), std::abs(mode.y2)) < kRungOut) mode.y1 = mode.y2 = 0.0;
}

}  // namespace fettle::haptic
