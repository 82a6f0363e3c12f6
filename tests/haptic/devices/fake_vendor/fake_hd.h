#pragma once

#include <atomic>

#include "tests/haptic/devices/fake_vendor/rules.h"

namespace fettle::fake {

/// A Touch behind a replacement of libHD.so, written from what is published of the interface. It has its own servo thread of 1 kHz. Lengths
/// and forces are the library's: mm, N, x to the right, y up, z towards the user.
struct FakeHd {
  std::atomic<bool> plugged{true};
  std::atomic<bool> stalled{false};  ///< the servo thread calls nobody
  std::atomic<bool> garbage{false};  ///< positions are NaN and 1e30 in turn
  std::atomic<bool> warm{false};     ///< each frame with a force reports motors too warm
  std::atomic<int> buttons{0};
  Triple position;                     ///< of the default device [mm]
  Triple other_position;               ///< of the device "right"
  Frame turned;                        ///< of the stylus: z runs away from its tip
  std::atomic<bool> has_gimbal{true};  ///< else it knows no transform
  double nominal_n = 3.3;
  double low[3] = {-80.0, -60.0, -35.0}, high[3] = {80.0, 60.0, 35.0};

  // What arrived.
  Triple force;
  std::atomic<unsigned long> frames{0};
  std::atomic<double> strongest_n{0.0};
  std::atomic<int> open_devices{0};
  std::atomic<bool> scheduler_runs{false};
  Rules rules;
};

}  // namespace fettle::fake

extern "C" fettle::fake::FakeHd* fake_hd();
