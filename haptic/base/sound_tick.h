#pragma once

#include <array>

#include "haptic/base/rings.h"

namespace fettle::haptic {

/// What one tick of a scene with sound has to tell the ear: increments and rates, never heights, so that a tick that is left out
/// makes no jump. Lengths are in cells of the field (its larger spacing): a sound does not depend on the scale of a scan.
/// The default is silence: nothing touched.
struct SoundTick {
  /// Pieces of the way of the contact point in one tick: 16 kHz at 1000 ticks per second.
  static constexpr int kPieces = 16;

  /// Rise of the surface under the contact point over each piece of its way since the previous tick [cells].
  std::array<float, kPieces> rise_cells{};
  float seconds = 0.0F;           ///< since the previous tick
  float speed_cells_s = 0.0F;     ///< of the contact point along the surface, in plan, >= 0
  float strength = 0.0F;          ///< pressing force over the limit of the scene, 0 .. 1
  float approach_cells_s = 0.0F;  ///< speed into the surface in the tick in which contact begins, else 0
  float released = 0.0F;  ///< part of the limit by which friction let go as the tip began to slip, else 0
  bool contact = false;
  bool slipping = false;  ///< friction: the tip slides, else it sticks or there is no friction
};

/// From the haptic loop to the thread that plays: a full ring refuses a tick, an empty one fades (SoundStream).
using SoundRing = SpscRing<SoundTick>;

}  // namespace fettle::haptic
