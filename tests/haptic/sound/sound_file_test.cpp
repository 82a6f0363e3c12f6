// The sound of recorded ticks, as bytes of a WAV file.
#include "haptic/sound/sound_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "haptic/tick/replay.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
std::uint32_t numberAt(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return number;
}

SoundFile soundOf(std::int64_t ticks) {
  const engine::Version field = trials::workpiece(200, 0.05);
  trials::HandMotion motion;
  motion.ticks = ticks;
  const std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  Scene scene = defaultScene();
  scene.effects = {EffectKind::kSpring, EffectKind::kFriction, EffectKind::kSound};
  SoundFile sound(scene.params.sound);
  ReplayOptions options;
  options.listen = [&](const SoundTick* heard, const StrokeSample& input) {
    return sound.add(*heard, input.t);
  };
  engine::JobControl job;
  EXPECT_TRUE(replay(field, field, strokes, scene, options, job));
  return sound;
}

TEST(SoundFile, TheSameStrokesGiveTheSameBytes) {
  const fettle::tests::TempFolder folder;
  const SoundFile one = soundOf(5000), two = soundOf(5000);
  ASSERT_TRUE(one.write(folder.file("one.wav")));
  ASSERT_TRUE(two.write(folder.file("two.wav")));
  EXPECT_EQ(bytesOf(folder.file("one.wav")), bytesOf(folder.file("two.wav")));
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_NE(one.hash(), soundOf(4000).hash());
  EXPECT_GT(one.peak(), 0.02) << "something is heard";
}

TEST(SoundFile, IsAWavFileOfThisLength) {
  const fettle::tests::TempFolder folder;
  const SoundFile sound = soundOf(2000);
  EXPECT_NEAR(sound.seconds(), 2.0, 0.002);
  ASSERT_TRUE(sound.write(folder.file("s.wav")));
  const std::string bytes = bytesOf(folder.file("s.wav"));
  EXPECT_EQ(bytes.substr(0, 4), "RIFF");
  EXPECT_EQ(bytes.substr(8, 8), "WAVEfmt ");
  EXPECT_EQ(numberAt(bytes, 4), bytes.size() - 8);
  EXPECT_EQ(numberAt(bytes, 24), 48000U);
  EXPECT_EQ(numberAt(bytes, 28), 96000U);
  EXPECT_EQ(bytes.substr(36, 4), "data");
  EXPECT_EQ(numberAt(bytes, 40), bytes.size() - 44);
}

TEST(SoundFile, APauseIsAsLongAsItWasAndOddTimesAreATick) {
  SoundFile sound{SoundParams{}};
  ASSERT_TRUE(sound.add({}, 0.0));
  ASSERT_TRUE(sound.add({}, 2.0));
  EXPECT_NEAR(sound.seconds(), 2.0, 0.002);
  for (const double t : {1.0, static_cast<double>(NAN), 1.0, 1e300, -5.0, 1e9}) ASSERT_TRUE(sound.add({}, t));
  EXPECT_NEAR(sound.seconds(), 2.0, 0.01);
}

TEST(SoundFile, APlaceThatCannotBeWrittenIsAnError) {
  EXPECT_FALSE(soundOf(10).write("/no/such/folder/s.wav"));
}

}  // namespace
}  // namespace fettle::haptic
