#include "app/sound/loop_sound.h"

#include <utility>

namespace fettle::app {

engine::Status LoopSound::follow(const haptic::Scene& scene) {
  if (!scene.lists(haptic::EffectKind::kSound)) {
    player_.reset();
    ring_.reset();
    silent_ = false;
    return {};
  }
  if (player_ != nullptr) player_->set(scene.params.sound);
  if (player_ != nullptr || silent_) return {};
  auto ring = std::make_shared<haptic::SoundRing>(haptic::SoundStream::kRingTicks);
  auto player = SoundPlayer::open(ring, scene.params.sound, loudness_);
  silent_ = !player.has_value();
  if (silent_) return tl::unexpected(player.error());
  ring_ = std::move(ring);
  player_ = std::move(*player);
  return {};
}

void LoopSound::setLoudness(Loudness loudness) noexcept {
  loudness_ = loudness;
  if (player_ != nullptr) player_->setLoudness(loudness);
}

}  // namespace fettle::app
