#pragma once

#include <memory>

#include "app/sound/sound_player.h"
#include "engine/base/error.h"
#include "haptic/base/sound_tick.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// The sound of a loop's scenes, one after the other: an audio device while the scene lists sound, and nothing of it otherwise.
/// Threading: main.
class LoopSound {
 public:
  explicit LoopSound(Loudness loudness) noexcept : loudness_(loudness) {}

  /// To be called before a scene is prepared for the loop. Errors: those of SoundPlayer::open, once: the scene is felt without sound, and
  /// a device is looked for again after a scene without it.
  [[nodiscard]] engine::Status follow(const haptic::Scene& scene);

  /// For PreparedScene; null while nothing plays.
  [[nodiscard]] const std::shared_ptr<haptic::SoundRing>& ring() const noexcept { return ring_; }
  /// Null while nothing plays.
  [[nodiscard]] const SoundPlayer* player() const noexcept { return player_.get(); }

  void setLoudness(Loudness loudness) noexcept;

 private:
  Loudness loudness_;
  bool silent_ = false;  // no device answered
  std::shared_ptr<haptic::SoundRing> ring_;
  std::unique_ptr<SoundPlayer> player_;
};

}  // namespace fettle::app
