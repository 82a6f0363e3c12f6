#pragma once

#include <atomic>

#include "tests/haptic/devices/fake_vendor/rules.h"

namespace fettle::fake {

/// Two devices behind a replacement of libdhd.so, written from what is published of the interface. Its calls block for a part of a
/// millisecond. Lengths and forces are the library's: m, N, x towards the user, y to the right, z up.
struct FakeDhd {
  struct Unit {
    Triple position;  ///< [m]
    std::atomic<int> buttons{0};
    Frame turned;  ///< of the stylus: x runs away from its tip
    Triple force;
    std::atomic<double> strongest_n{0.0};
    std::atomic<bool> open{false};
  };
  std::atomic<int> count{1};           ///< plugged in, 0 to 2
  std::atomic<bool> stalled{false};    ///< calls block until it ends
  std::atomic<bool> garbage{false};    ///< positions are NaN and 1e30 in turn
  std::atomic<bool> too_early{false};  ///< forces are skipped: the last one was too short ago
  std::atomic<bool> wrist{false};      ///< its joints are measured: an omega.6
  const char* name = "omega.3";
  double limit_n = 12.0;
  Unit units[2];
  std::atomic<unsigned long> exchanges{0};
  Rules rules;
};

}  // namespace fettle::fake

extern "C" fettle::fake::FakeDhd* fake_dhd();
