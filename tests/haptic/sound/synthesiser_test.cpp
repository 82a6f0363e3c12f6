// Ticks in, samples out: pitch, knocks, slips, silence, and bounds whatever the ticks hold.
#include "haptic/sound/synthesiser.h"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/haptic/sound/spectrum.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::amplitudeAt;
using tests::peakHz;
using tests::rms;
using tests::steepestStep;

constexpr std::size_t kTickSamples = 48;  // at 1 kHz

SoundTick touching(double speed_cells_s, double strength = 0.5) {
  SoundTick tick;
  tick.contact = true;
  tick.seconds = 1e-3F;
  tick.speed_cells_s = static_cast<float>(speed_cells_s);
  tick.strength = static_cast<float>(strength);
  return tick;
}

// A ridged surface, a sine of a pitch and an amplitude in cells, passed at a speed.
std::vector<float> ridges(double pitch, double speed_cells_s, double rate_hz, std::size_t ticks,
                          double amplitude = 0.05) {
  Synthesiser synthesiser{SoundParams{}};
  const auto samples = static_cast<std::size_t>(Synthesiser::kRate_hz / rate_hz);
  std::vector<float> sound(ticks * samples);
  const double way = speed_cells_s / rate_hz / SoundTick::kPieces;
  const auto height = [&](double x) { return amplitude * std::sin(2.0 * std::numbers::pi * x / pitch); };
  for (std::size_t t = 0; t < ticks; ++t) {
    SoundTick tick = touching(speed_cells_s);
    for (std::size_t i = 0; i < tick.rise_cells.size(); ++i) {
      const double x = way * static_cast<double>(t * SoundTick::kPieces + i);
      tick.rise_cells[i] = static_cast<float>(height(x + way) - height(x));
    }
    synthesiser.render(tick, std::span(sound).subspan(t * samples, samples));
  }
  return sound;
}

std::vector<float> renderOnce(Synthesiser& synthesiser, const SoundTick& first, std::size_t ticks,
                              const SoundTick& then) {
  std::vector<float> sound(ticks * kTickSamples);
  for (std::size_t t = 0; t < ticks; ++t)
    synthesiser.render(t == 0 ? first : then, std::span(sound).subspan(t * kTickSamples, kTickSamples));
  return sound;
}

TEST(Synthesiser, RidgesAreHeardAtSpeedOverPitchAndAnOctaveHigherAtTwiceTheSpeed) {
  for (const double pitch : {4.0, 10.0})
    for (const double speed : {1000.0, 2000.0, 4000.0}) {
      const std::vector<float> sound = ridges(pitch, speed, 1000.0, 1000);
      const std::span<const float> steady = std::span(sound).subspan(sound.size() / 2);
      EXPECT_NEAR(peakHz(steady, 40.0, 3000.0, 2.0), speed / pitch, 2.0) << pitch << " " << speed;
    }
}

TEST(Synthesiser, WhatIsHeardIsTheRidgesAndNotTheRateOfTheLoop) {
  // Beside the ridges and their overtones all is 50 dB below: the ticks at 1 kHz, the pieces at 16 kHz.
  const std::vector<float> sound = ridges(10.0, 4000.0, 1000.0, 1000);
  const std::span<const float> steady = std::span(sound).subspan(sound.size() / 2);
  const double ridge = amplitudeAt(steady, 400.0);
  EXPECT_GT(ridge, 0.01);
  for (const double hz : {600.0, 1000.0, 2000.0, 15600.0, 16000.0, 16400.0})
    EXPECT_LT(amplitudeAt(steady, hz), 0.003 * ridge) << hz;
}

TEST(Synthesiser, AnotherRateOfTheLoopSoundsTheSame) {
  const std::vector<float> slow = ridges(10.0, 4000.0, 1000.0, 1000);
  const std::vector<float> fast = ridges(10.0, 4000.0, 10000.0, 10000);
  const double at_1_khz = amplitudeAt(std::span(slow).subspan(24000), 400.0);
  // 48 kHz over 10 kHz is not whole here: four samples a tick, 1.2 times the pitch.
  const double at_10_khz = amplitudeAt(std::span(fast).subspan(20000), 480.0);
  EXPECT_NEAR(at_10_khz / at_1_khz, 1.2, 0.05);
}

TEST(Synthesiser, AFasterHandAndAHarderPressAreLouder) {
  const auto loud = [](double speed) { return rms(ridges(10.0, speed, 1000.0, 500)); };
  EXPECT_GT(loud(400.0), 1.5 * loud(200.0));
  const auto pressed = [&](double strength) {
    Synthesiser fresh{SoundParams{}};
    SoundTick tick = touching(1000.0, strength);
    for (std::size_t i = 0; i < tick.rise_cells.size(); ++i) tick.rise_cells[i] = i % 8 < 4 ? 0.01F : -0.01F;
    return rms(renderOnce(fresh, tick, 100, tick));
  };
  EXPECT_GT(pressed(1.0), 2.0 * pressed(0.0));
  EXPECT_GT(pressed(0.0), 0.0);
}

TEST(Synthesiser, AKnockBeginsWithContactAndDies) {
  Synthesiser synthesiser{SoundParams{}};
  SoundTick hit = touching(0.0);
  hit.approach_cells_s = 500.0F;
  const std::vector<float> sound = renderOnce(synthesiser, hit, 400, touching(0.0));
  const std::span<const float> all(sound);
  EXPECT_GT(rms(all.first(480)), 0.05);
  // T60 of 60 ms: 60 dB less after it.
  EXPECT_LT(rms(all.subspan(48 * 62, 480)), 2e-3 * rms(all.first(480)));
  EXPECT_NEAR(peakHz(all.first(4800), 400.0, 6000.0, 10.0), 1200.0, 30.0);
  for (const float s : all.subspan(48 * 300)) ASSERT_EQ(s, 0.0F);
}

TEST(Synthesiser, AHarderKnockIsLouderAndItsBodyIsTheScenes) {
  const auto knock = [](double speed, SoundParams params) {
    Synthesiser synthesiser{params};
    SoundTick hit = touching(0.0);
    hit.approach_cells_s = static_cast<float>(speed);
    return renderOnce(synthesiser, hit, 200, touching(0.0));
  };
  EXPECT_GT(rms(knock(2000.0, {})), 1.5 * rms(knock(200.0, {})));
  SoundParams bell;
  bell.body_hz = 600.0;
  bell.ring_ms = 500.0;
  EXPECT_NEAR(peakHz(knock(500.0, bell), 300.0, 6000.0, 10.0), 600.0, 15.0);
  EXPECT_GT(rms(std::span<const float>(knock(500.0, bell)).subspan(4800)),
            20.0 * rms(std::span<const float>(knock(500.0, {})).subspan(4800)));
  SoundParams mute;
  mute.knock = 0.0;
  EXPECT_EQ(rms(knock(500.0, mute)), 0.0);
}

TEST(Synthesiser, FrictionThatLetsGoIsABurstAndSlidingIsHeardWhileItLasts) {
  Synthesiser synthesiser{SoundParams{}};
  std::vector<float> sound(1000 * kTickSamples);
  // Every 100 ms it slips for 20.
  for (std::size_t t = 0; t < 1000; ++t) {
    SoundTick tick = touching(400.0);
    tick.slipping = t % 100 >= 50 && t % 100 < 70;
    tick.released = t % 100 == 50 ? 0.1F : 0.0F;
    synthesiser.render(tick, std::span(sound).subspan(t * kTickSamples, kTickSamples));
  }
  for (std::size_t burst = 0; burst < 10; ++burst) {
    const auto part = [&](std::size_t from_ms, std::size_t ms) {
      return rms(
          std::span<const float>(sound).subspan((100 * burst + from_ms) * kTickSamples, ms * kTickSamples));
    };
    EXPECT_GT(part(50, 15), 0.003) << burst;
    EXPECT_LT(part(40, 9), 0.02 * part(50, 15)) << "stuck, before burst " << burst;
  }
}

TEST(Synthesiser, LiftedOrAtRestItFallsToExactlyNothing) {
  for (const bool lifted : {true, false}) {
    Synthesiser synthesiser{SoundParams{}};
    SoundTick loud = touching(3000.0);
    loud.slipping = true;
    loud.approach_cells_s = 100.0F;
    for (std::size_t i = 0; i < loud.rise_cells.size(); ++i) loud.rise_cells[i] = i % 4 < 2 ? 0.3F : -0.3F;
    static_cast<void>(renderOnce(synthesiser, loud, 50, loud));
    SoundTick rest = lifted ? SoundTick{} : touching(0.0);
    const std::vector<float> sound = renderOnce(synthesiser, rest, 1000, rest);
    EXPECT_GT(rms(std::span<const float>(sound).first(48)), 0.001) << "it fades and is not cut";
    for (const float s : std::span(sound).subspan(40000)) ASSERT_EQ(s, 0.0F) << lifted;
  }
}

TEST(Synthesiser, ALiftAndALandingMakeNoStep) {
  std::vector<float> sound = ridges(20.0, 4000.0, 1000.0, 400);
  const double usual = steepestStep(sound);
  // The same, lifted for some ticks now and then, once for one alone.
  Synthesiser synthesiser{SoundParams{}};
  std::vector<float> cut;
  const double way = 4000.0 / 1000.0 / SoundTick::kPieces;
  for (std::size_t t = 0; t < 400; ++t) {
    SoundTick tick = touching(4000.0);
    for (std::size_t i = 0; i < tick.rise_cells.size(); ++i) {
      const double x = way * static_cast<double>(t * SoundTick::kPieces + i);
      const auto height = [](double at) { return 0.05 * std::sin(2.0 * std::numbers::pi * at / 20.0); };
      tick.rise_cells[i] = static_cast<float>(height(x + way) - height(x));
    }
    if (t / 50 % 2 == 1 || t == 20) tick = {};
    std::vector<float> part(kTickSamples);
    synthesiser.render(tick, part);
    cut.insert(cut.end(), part.begin(), part.end());
  }
  EXPECT_LT(steepestStep(cut), 2.0 * usual);
}

TEST(Synthesiser, OtherParametersWhileItSoundsMakeNoStep) {
  Synthesiser synthesiser{SoundParams{}};
  SoundTick tick = touching(4000.0);
  std::vector<float> sound(400 * kTickSamples);
  double usual = 0.0;
  for (std::size_t t = 0; t < 400; ++t) {
    for (std::size_t i = 0; i < tick.rise_cells.size(); ++i)
      tick.rise_cells[i] = 0.02F * std::sin(0.03F * static_cast<float>(t * SoundTick::kPieces + i));
    if (t >= 200 && t % 40 == 0) {
      SoundParams other;
      other.profile = t % 80 == 0 ? 0.0 : 1.0;
      other.body_hz = t % 80 == 0 ? 3000.0 : 300.0;
      synthesiser.set(other);
    }
    synthesiser.render(tick, std::span(sound).subspan(t * kTickSamples, kTickSamples));
    if (t == 199) usual = steepestStep(std::span<const float>(sound).first(200 * kTickSamples));
  }
  EXPECT_GT(usual, 0.0);
  EXPECT_LT(steepestStep(sound), 8.0 * usual) << "a body ten times as high is steeper itself";
}

void expectSane(std::span<const float> sound) {
  for (const float s : sound) ASSERT_TRUE(std::isfinite(s) && std::abs(s) <= 1.0F) << s;
}

TEST(Synthesiser, NotANumberInfinitiesAndHugeNumbersStayInBoundsAndDoNotLast) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), kInf, -kInf, 3e38F, -3e38F, 1e30F}) {
    Synthesiser synthesiser{SoundParams{10.0, 10.0, 10.0, 50.0, 2000.0}};
    SoundTick tick;
    tick.contact = tick.slipping = true;
    tick.rise_cells.fill(bad);
    tick.seconds = tick.speed_cells_s = tick.strength = tick.approach_cells_s = tick.released = bad;
    expectSane(renderOnce(synthesiser, tick, 200, tick));
    SoundTick alternating = tick;
    for (std::size_t i = 0; i < tick.rise_cells.size(); i += 2) alternating.rise_cells[i] = -bad;
    expectSane(renderOnce(synthesiser, alternating, 200, tick));
    const std::vector<float> after = renderOnce(synthesiser, {}, 10000, {});
    expectSane(after);
    EXPECT_EQ(after.back(), 0.0F) << bad;
  }
}

TEST(Synthesiser, AMillionRandomTicksOfAnyLengthStayInBounds) {
  Synthesiser synthesiser{SoundParams{}};
  std::mt19937_64 random(7);
  const auto next = [&] { return fettle::tests::uniform(random, 0.0, 1.0); };
  std::vector<float> made(200);
  double loudest = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    SoundTick tick;
    tick.contact = next() < 0.9;
    tick.slipping = next() < 0.3;
    const double size = std::pow(10.0, 6.0 * next() - 5.0);
    for (float& rise : tick.rise_cells) rise = static_cast<float>(size * (next() - 0.5));
    tick.speed_cells_s = static_cast<float>(5000.0 * next());
    tick.strength = static_cast<float>(next());
    tick.approach_cells_s = next() < 0.1 ? static_cast<float>(1000.0 * next()) : 0.0F;
    tick.released = next() < 0.05 ? static_cast<float>(next()) : 0.0F;
    const auto n = static_cast<std::size_t>(next() < 0.99 ? 5.0 * next() : 199.0 * next());
    const std::span<float> part = std::span(made).first(n);
    synthesiser.render(tick, part);
    for (const float s : part) {
      ASSERT_TRUE(std::isfinite(s) && std::abs(s) <= 1.0F) << i;
      loudest = std::max(loudest, std::abs(static_cast<double>(s)));
    }
  }
  EXPECT_GT(loudest, 0.9) << "the bound was tried";
}

}  // namespace
}  // namespace fettle::haptic
