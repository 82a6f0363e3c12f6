// A loop and a device of two clocks: no gap while both run, none heard as a step, nothing piles up.
#include "haptic/sound/sound_stream.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/haptic/sound/spectrum.h"

namespace fettle::haptic {
namespace {

// A loop that passes ridges of 400 Hz, by its own clock.
class Ridges {
 public:
  Ridges(std::shared_ptr<SoundRing> ring, double rate_hz)
      : ring_(std::move(ring)), period_s_(1.0 / rate_hz) {}

  void until(double t_s) {
    for (; t_s_ < t_s; t_s_ += period_s_) {
      SoundTick tick;
      tick.contact = true;
      tick.strength = 0.5F;
      tick.speed_cells_s = 4000.0F;
      tick.seconds = static_cast<float>(period_s_);
      for (std::size_t i = 0; i < tick.rise_cells.size(); ++i) {
        const auto at = [&](std::size_t piece) {
          return std::sin(2.0 * std::numbers::pi * 400.0 *
                          (t_s_ + period_s_ * static_cast<double>(piece) / SoundTick::kPieces));
        };
        tick.rise_cells[i] = static_cast<float>(0.05 * (at(i + 1) - at(i)));
      }
      refused_ += ring_->push(std::move(tick)) ? 0 : 1;
    }
  }
  [[nodiscard]] int refused() const { return refused_; }
  void skipTo(double t_s) { t_s_ = t_s; }

 private:
  std::shared_ptr<SoundRing> ring_;
  double period_s_;
  double t_s_ = 0.0;
  int refused_ = 0;
};

struct Played {
  std::shared_ptr<SoundRing> ring = std::make_shared<SoundRing>(SoundStream::kRingTicks);
  SoundStream stream{ring, SoundParams{}};
  std::vector<float> sound;
  double t_s = 0.0;
  void piece(std::size_t samples = 512, double clock = 1.0) {
    sound.resize(sound.size() + samples);
    stream.fill(std::span(sound).last(samples));
    t_s += clock * static_cast<double>(samples) / Synthesiser::kRate_hz;
  }
};

TEST(SoundStream, ClocksThatDifferByAThousandthNeverRunDryOrPileUp) {
  for (const double rate_hz : {1000.0, 4000.0, 10000.0})
    for (const double clock : {0.999, 1.0, 1.001}) {
      Played played;
      Ridges loop(played.ring, rate_hz);
      while (played.t_s < 60.0) {
        loop.until(played.t_s);
        played.piece(512, clock);
      }
      EXPECT_EQ(played.stream.counters().gaps, 0U) << rate_hz << " " << clock;
      EXPECT_EQ(played.stream.counters().skipped, 0U) << rate_hz << " " << clock;
      EXPECT_LT(static_cast<double>(played.ring->waiting()) / rate_hz, 0.06);
      EXPECT_EQ(loop.refused(), 0);
      // The pitch is that of the loop.
      const std::span<const float> late = std::span<const float>(played.sound).last(48000);
      EXPECT_NEAR(tests::peakHz(late, 350.0, 450.0, 0.5), 400.0 * clock, 3.0);
    }
}

TEST(SoundStream, ALoopThatIsLateNowAndThenMakesNoGap) {
  Played played;
  Ridges loop(played.ring, 1000.0);
  for (int i = 0; played.t_s < 20.0; ++i) {
    // Late by up to 8 ms.
    loop.until(played.t_s - (i % 7 == 0 ? 0.008 : 0.0));
    played.piece(256);
  }
  EXPECT_EQ(played.stream.counters().gaps, 0U);
}

TEST(SoundStream, ALoopThatStopsFadesAndComesBackWithoutAStep) {
  Played played;
  Ridges loop(played.ring, 1000.0);
  while (played.t_s < 2.0) {
    loop.until(played.t_s);
    played.piece();
  }
  const std::span<const float> before(played.sound);
  const double usual = tests::steepestStep(before.last(24000));
  while (played.t_s < 3.0) played.piece();
  EXPECT_EQ(played.stream.counters().gaps, 1U);
  for (const float s : std::span<const float>(played.sound).last(4800)) ASSERT_EQ(s, 0.0F);
  loop.skipTo(3.0);
  while (played.t_s < 4.0) {
    loop.until(played.t_s);
    played.piece();
  }
  EXPECT_EQ(played.stream.counters().gaps, 1U);
  EXPECT_GT(tests::rms(std::span<const float>(played.sound).last(24000)), 0.01);
  EXPECT_LT(tests::steepestStep(played.sound), 2.0 * usual);
}

TEST(SoundStream, ADeviceThatStoodStillGoesOnWithTheNewestTicks) {
  Played played;
  Ridges loop(played.ring, 1000.0);
  while (played.t_s < 2.0) {
    loop.until(played.t_s);
    played.piece();
  }
  const double usual = tests::steepestStep(std::span<const float>(played.sound).last(24000));
  played.t_s += 30.0;  // longer than the ring holds
  loop.until(played.t_s);
  EXPECT_GT(loop.refused(), 20000);
  const std::size_t stood = played.sound.size();
  for (int i = 0; i < 200; ++i) {
    loop.until(played.t_s);
    played.piece();
  }
  EXPECT_GT(played.stream.counters().skipped, 8000U);
  EXPECT_LT(played.ring->waiting(), 60U);
  EXPECT_LT(tests::steepestStep(std::span<const float>(played.sound).subspan(stood - 1)), 2.0 * usual);
}

TEST(SoundStream, AnEmptyRingIsSilence) {
  Played played;
  for (int i = 0; i < 50; ++i) played.piece(1 + static_cast<std::size_t>(i) * 37);
  for (const float s : played.sound) ASSERT_EQ(s, 0.0F);
  EXPECT_EQ(played.stream.counters().gaps, 0U);
}

TEST(SampleClock, LosesNoSampleAndTakesAnyTime) {
  SampleClock clock;
  std::size_t sum = 0;
  for (int i = 0; i < 30000; ++i) sum += clock.samplesOf(1.0 / 7000.0);
  EXPECT_NEAR(static_cast<double>(sum), 30000.0 / 7000.0 * 48000.0, 1.5);
  for (const double odd : {0.0, -1.0, 5.0, static_cast<double>(NAN), static_cast<double>(INFINITY), 1e300})
    EXPECT_NEAR(static_cast<double>(clock.samplesOf(odd)), 48.0, 1.0) << odd;
}

}  // namespace
}  // namespace fettle::haptic
