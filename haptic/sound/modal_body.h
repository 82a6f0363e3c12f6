#pragma once

#include <array>

namespace fettle::haptic {

/// A bar that rings: modes as second-order resonators, each a damped sine after a blow.
///
/// Sources: van den Doel, Pai, "The sounds of physical shapes" (1998), modal synthesis by such resonators; frequencies of a bar with free
/// ends: Fletcher, Rossing, "The physics of musical instruments" (1998), 2.16; higher modes ring shorter, as internal friction does.
///
/// Threading: one thread; noexcept, allocates nothing.
class ModalBody {
 public:
  /// `lowest_hz` > 0: modes above the band that can be heard at `rate_hz` are left out. `ring_s` > 0: until the lowest has fallen to a
  /// thousandth.
  ModalBody(double lowest_hz, double ring_s, double rate_hz) noexcept { set(lowest_hz, ring_s, rate_hz); }

  /// Another body; what rings goes on in its modes.
  void set(double lowest_hz, double ring_s, double rate_hz) noexcept;

  /// The next sample. `blow`: its sum over time is the amplitude of the lowest mode. `drive`: a sustained sound, about as loud at the
  /// resonance of a mode as it is.
  [[nodiscard]] double next(double blow, double drive) noexcept;

  /// Ends what is too quiet ever to be heard: the state is then exactly zero.
  void settle() noexcept;

 private:
  struct Mode {
    double feedback = 0.0, decay2 = 0.0;  // y = feedback y' - decay2 y'' + x
    double from_blow = 0.0, from_drive = 0.0;
    double y1 = 0.0, y2 = 0.0;
  };
  std::array<Mode, 4> modes_;
};

}  // namespace fettle::haptic
