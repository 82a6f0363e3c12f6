// An audio device without hardware: SDL's own "disk", which writes what is played to a file.
#include <cmath>
#include <cstdlib>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "app/sound/loop_sound.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using namespace std::chrono_literals;

bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 2000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

class SoundPlayerTest : public testing::Test {
 protected:
  SoundPlayerTest() {
    setenv("SDL_AUDIODRIVER", "disk", 1);
    setenv("SDL_DISKAUDIOFILE", path().c_str(), 1);
  }
  [[nodiscard]] std::string path() const { return folder_.file("heard.raw"); }

  // Loudest sample of ridges that are passed for a second, and the last one after they ended.
  struct Heard {
    float loudest = 0.0F, last = 0.0F;
  };
  Heard ridges(Loudness loudness) {
    const auto ring = std::make_shared<haptic::SoundRing>(haptic::SoundStream::kRingTicks);
    auto player = SoundPlayer::open(ring, {}, loudness);
    EXPECT_TRUE(player) << player.error().line();
    if (!player) return {};
    // All at once within what may wait, then as the device takes them.
    for (std::uint64_t t = 0; t < 1000; ++t) {
      haptic::SoundTick tick;
      tick.contact = true;
      tick.seconds = 1e-3F;
      tick.speed_cells_s = 4000.0F;
      for (std::size_t i = 0; i < tick.rise_cells.size(); ++i)
        tick.rise_cells[i] = 0.02F * std::sin(0.4F * static_cast<float>(t * 16 + i));
      EXPECT_TRUE(eventually([&] { return t < (*player)->counters().ticks + 100; }));
      EXPECT_TRUE(ring->push(std::move(tick)));
    }
    EXPECT_TRUE(eventually([&] { return (*player)->counters().ticks == 1000; }));
    const std::uint64_t ended = (*player)->counters().samples;
    EXPECT_TRUE(eventually([&] { return (*player)->counters().samples > ended + 24000; }));
    EXPECT_EQ((*player)->driver(), "disk");
    player->reset();
    Heard heard;
    std::ifstream file(path(), std::ios::binary);
    for (float sample = 0.0F; file.read(reinterpret_cast<char*>(&sample), sizeof(sample));
         heard.last = sample)
      heard.loudest = std::max(heard.loudest, std::abs(sample));
    return heard;
  }

  fettle::tests::TempFolder folder_;
};

TEST_F(SoundPlayerTest, PlaysTheTicksOfItsRingAtItsVolume) {
  const Heard full = ridges({1.0F, false});
  EXPECT_GT(full.loudest, 0.05F);
  EXPECT_EQ(full.last, 0.0F) << "silent without ticks";
  // The square of the volume.
  EXPECT_NEAR(ridges({0.5F, false}).loudest / full.loudest, 0.25, 0.01);
  EXPECT_EQ(ridges({1.0F, true}).loudest, 0.0F);
  EXPECT_EQ(ridges({0.0F, false}).loudest, 0.0F);
}

TEST_F(SoundPlayerTest, ALoopsSoundFollowsItsScene) {
  LoopSound sound{Loudness{}};
  haptic::Scene scene;
  EXPECT_TRUE(sound.follow(scene));
  EXPECT_EQ(sound.ring(), nullptr);
  EXPECT_EQ(sound.player(), nullptr);
  EXPECT_FALSE(std::filesystem::exists(path()));
  scene.effects.push_back(haptic::EffectKind::kSound);
  ASSERT_TRUE(sound.follow(scene));
  ASSERT_NE(sound.player(), nullptr);
  const auto ring = sound.ring();
  scene.params.sound.body_hz = 500.0;
  EXPECT_TRUE(sound.follow(scene));
  EXPECT_EQ(sound.ring(), ring) << "another scene with sound goes on in the same ring";
  scene.effects.pop_back();
  EXPECT_TRUE(sound.follow(scene));
  EXPECT_EQ(sound.ring(), nullptr);
  EXPECT_EQ(sound.player(), nullptr);
}

TEST_F(SoundPlayerTest, WithoutADeviceItIsSaidOnceAndAskedAgainAfterASceneWithoutSound) {
  setenv("SDL_AUDIODRIVER", "none_such", 1);
  LoopSound sound{Loudness{}};
  haptic::Scene scene;
  scene.effects.push_back(haptic::EffectKind::kSound);
  const engine::Status first = sound.follow(scene);
  ASSERT_FALSE(first);
  EXPECT_NE(first.error().what.find("no audio device answers"), std::string::npos) << first.error().line();
  EXPECT_EQ(sound.ring(), nullptr) << "the loop sends nothing";
  EXPECT_TRUE(sound.follow(scene));
  scene.effects.pop_back();
  EXPECT_TRUE(sound.follow(scene));
  scene.effects.push_back(haptic::EffectKind::kSound);
  EXPECT_FALSE(sound.follow(scene));
  setenv("SDL_AUDIODRIVER", "disk", 1);
  scene.effects.pop_back();
  EXPECT_TRUE(sound.follow(scene));
  scene.effects.push_back(haptic::EffectKind::kSound);
  EXPECT_TRUE(sound.follow(scene)) << "a device that was connected meanwhile";
}

TEST_F(SoundPlayerTest, WhatAlsaTriesIsNotWrittenToStandardError) {
  // ALSA without any device, whatever the machine has.
  setenv("SDL_AUDIODRIVER", "alsa", 1);
  setenv("ALSA_CONFIG_PATH", "/dev/null", 1);
  testing::internal::CaptureStderr();
  const auto player = SoundPlayer::open(std::make_shared<haptic::SoundRing>(16), {}, {});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(player);
}

}  // namespace
}  // namespace fettle::app
