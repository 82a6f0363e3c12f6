// fettle replay --sound: strokes and sessions as WAV files.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class SoundOfReplay : public testing::Test {
 protected:
  // Ridges of 0.5 mm, and a hand that lands and passes them at 50 mm/s: 100 Hz.
  void SetUp() override {
    std::ofstream scan(file("ridges.asc"));
    scan << "ncols 1400\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 0.05\n";
    for (int row = 0; row < 20; ++row)
      for (int c = 0; c < 1400; ++c)
        scan << 0.01 * std::sin(0.2 * 3.14159265358979 * c) << (c < 1399 ? ' ' : '\n');
    std::ofstream strokes(file("strokes.csv"));
    strokes << "t,x,y,z,tool\n";
    for (int i = 0; i < 1200; ++i)
      strokes << 0.001 * i << ',' << 5.0 + 0.05 * i << ",0.5," << (i < 100 ? 1.0 - 0.012 * i : -0.2)
              << ",feel\n";
    std::ofstream(file("scene.toml")) << "effects = [\"spring\", \"sound\"]\n[sound]\nbody_hz = 400\n";
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  nlohmann::json replay(std::vector<std::string> more) {
    std::vector<std::string> arguments{
        "replay", file("ridges.asc"), file("strokes.csv"), file("touched.tif"), "--unit", "mm"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fettleJson(arguments);
  }

  TempFolder folder_;
};

TEST_F(SoundOfReplay, StrokesGiveTheSameBytesEachTimeAndTheSameField) {
  const auto silent = replay({});
  const auto one = replay({"--sound", file("one.wav")});
  const auto two = replay({"--sound", file("two.wav")});
  EXPECT_EQ(one["hash"], silent["hash"]);
  EXPECT_EQ(one["max_force_n"], silent["max_force_n"]);
  EXPECT_FALSE(silent.contains("sound_hash"));
  EXPECT_EQ(one["sound_hash"], two["sound_hash"]);
  EXPECT_NEAR(one["sound_seconds"].get<double>(), 1.2, 0.002);
  EXPECT_GT(one["sound_peak"], 0.05);
  const std::string bytes = bytesOf(file("one.wav"));
  EXPECT_EQ(bytes.substr(0, 4), "RIFF");
  EXPECT_NEAR(static_cast<double>(bytes.size()), 1.2 * 96000.0 + 44.0, 200.0);
  EXPECT_TRUE(bytes == bytesOf(file("two.wav")));
  // The body is the scene's.
  EXPECT_NE(replay({"--sound", file("low.wav"), "--scene", file("scene.toml")})["sound_hash"],
            one["sound_hash"]);
}

TEST_F(SoundOfReplay, ASessionThatWasRecordedWithoutSoundIsHeardToo) {
  const std::string session = file("work.fettle");
  std::filesystem::copy_file(inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle"),
                             session);
  const auto silent = fettleJson({"replay", session, file("out.tif")});
  const auto one = fettleJson({"replay", session, file("out.tif"), "--sound", file("one.wav")});
  const auto two = fettleJson({"replay", session, file("out.tif"), "--sound", file("two.wav")});
  EXPECT_EQ(one["hash"], silent["hash"]);
  EXPECT_EQ(one["sound_hash"], two["sound_hash"]);
  EXPECT_GT(one["sound_seconds"], 0.0);
  EXPECT_GT(one["sound_peak"], 0.0);
  EXPECT_TRUE(bytesOf(file("one.wav")) == bytesOf(file("two.wav")));
}

TEST_F(SoundOfReplay, PlacesThatCannotBeWrittenAreRefusedFirst) {
  const std::vector<std::string> words{"replay", file("ridges.asc"), file("strokes.csv"),
                                       file("touched.tif")};
  for (const std::string& to : {file("no/such/folder.wav"), file("strokes.csv"), file("touched.tif")}) {
    std::vector<std::string> arguments = words;
    arguments.insert(arguments.end(), {"--sound", to});
    EXPECT_EQ(fettle(arguments).status, 2) << to;
  }
  EXPECT_FALSE(std::filesystem::exists(file("touched.tif")));
}

}  // namespace
}  // namespace fettle::tests
