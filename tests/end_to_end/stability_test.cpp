// Scenes that ask more of a device than it holds: refused where force goes to a hand, said where none does.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class Stability : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(fettle({"synth", scan, "--size", "128x96", "--part", "plate"}).status, 0);
    std::ofstream strokes(path);
    strokes << "t,x,y,z,tool\n0,3,3,20,feel\n0.05,5,5,-1,smooth\n0.2,8,5,-1,smooth\n0.25,8,5,20,feel\n";
  }
  std::string scene(const std::string& text) const {
    std::ofstream(folder.file("scene.toml")) << text;
    return folder.file("scene.toml");
  }
  [[nodiscard]] Outcome record(const std::string& device, std::vector<std::string> more) const {
    std::vector<std::string> all{"record", scan, recorded, "--device", device + path};
    all.insert(all.end(), more.begin(), more.end());
    return fettle(all);
  }

  TempFolder folder;
  std::string scan = folder.file("scan.tif"), path = folder.file("path.csv"), out = folder.file("out.tif"),
              recorded = folder.file("recorded.csv");
};

TEST_F(Stability, RecordRefusesWhatTheHandDoesNotHoldAndNamesTheLargestThatItDoes) {
  // The largest stiffness there is, which made the hand jump to and fro between no force and all of it.
  const Outcome stiff = record("hand:", {"--scene", scene("[force]\nstiffness_n_per_mm = 1000\n")});
  expectRefused(stiff, "at most 6 N/mm");
  EXPECT_NE(stiff.err.find("scene.toml"), std::string::npos) << stiff.err;
  EXPECT_NE(stiff.err.find("simulated hand"), std::string::npos) << stiff.err;
  EXPECT_FALSE(std::filesystem::exists(recorded));
  // A faster loop holds more, an effect takes its part, and damping is reported as well.
  expectRefused(record("hand:", {"--rate", "4000", "--scene", folder.file("scene.toml")}), "at most 24 N/mm");
  expectRefused(record("hand:", {"--scene", scene("effects = [\"spring\", \"texture\"]\n")}), "texture");
  expectRefused(record("hand:", {"--scene", scene("effects = [\"spring\", \"viscosity\"]\n"
                                                  "[viscosity]\ndamping_n_s_per_mm = 0.5\n")}),
                "at most 0.3 N s/mm");
  // 4 F over the reach of this scene would be nothing, but the field cuts it to 63 samples.
  expectRefused(record("hand:", {"--scene", scene("effects = [\"spring\", \"friction\", \"edge_snap\"]\n"
                                                  "[friction]\nstiffness_n_per_mm = 5.9\n"
                                                  "[edge_snap]\nforce_n = 20\nreach_mm = 1000000\n")}),
                "5.9 N/mm with this edge snap");
  // What is named is taken.
  const Outcome held = record("hand:", {"--scene", scene("[force]\nstiffness_n_per_mm = 6\n")});
  EXPECT_EQ(held.status, 0) << held.err;
  EXPECT_TRUE(std::filesystem::exists(recorded));
  // A force device that is not plugged in is one, all the same.
  expectRefused(fettle({"record", scan, recorded, "--device", "woodenhaptics", "--scale", "1", "--scene",
                        scene("[force]\nstiffness_n_per_mm = 4\n")}),
                "at most 1 N/mm");
}

// A scene that was given is felt as it is, and what is wrong with it at the scan's size is said, with what helps.
TEST_F(Stability, RecordSaysWhyAGivenSceneIsFeltBadlyAndFitsItWhenAsked) {
  const std::string own = scene("[force]\nstiffness_n_per_mm = 20\n[brush]\nradius_samples = 3\n");
  const auto recordWith = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"record",        scan,        recorded, "--device",
                                 "woodenhaptics", "--seconds", "0.1",    "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return fettle(all);
  };
  const auto corner = nlohmann::json::parse(recordWith({"--scene", own}).out);
  const std::string said = corner.value("warnings", nlohmann::json::array()).dump();
  EXPECT_NE(said.find("the hand reaches"), std::string::npos) << said;
  EXPECT_NE(said.find("give --fit, or at most"), std::string::npos) << said;
  EXPECT_FALSE(corner.contains("scene"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("recorded.csv.scene.toml")));
  const auto fitted =
      nlohmann::json::parse(recordWith({"--scene", own, "--fit", "--scene-out", out + ".toml"}).out);
  EXPECT_FALSE(fitted.contains("warnings")) << fitted["warnings"];
  EXPECT_EQ(fitted["scene"], out + ".toml");
  std::ifstream written(out + ".toml");
  const std::string text((std::istreambuf_iterator<char>(written)), std::istreambuf_iterator<char>());
  EXPECT_NE(text.find("radius_samples = 3"), std::string::npos) << text;
  EXPECT_EQ(text.find("stiffness_n_per_mm = 20"), std::string::npos) << text;
}

std::string textIn(const std::string& path) {
  std::ifstream file(path);
  return {(std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()};
}

class SceneBeside : public Stability {
 protected:
  [[nodiscard]] Outcome onADesk(std::vector<std::string> more, const ProcessOptions& how = {}) const {
    std::vector<std::string> all{"record", scan, recorded, "--device", "woodenhaptics"};
    all.insert(all.end(), more.begin(), more.end());
    return fettle(all, how);
  }
  [[nodiscard]] nlohmann::json replayed() const { return fettleJson({"replay", scan, recorded, out}); }
  std::string beside = recorded + ".scene.toml";
};

TEST_F(SceneBeside, AReplayTakesItAndSaysSo) {
  const auto report = nlohmann::json::parse(onADesk({"--json", "--seconds", "0.1"}).out);
  EXPECT_EQ(report["scene"], beside);
  const auto again = replayed();
  EXPECT_EQ(again["scene"], beside);
  EXPECT_EQ(again["hash"], report["hash"]);
  EXPECT_FALSE(fettleJson({"replay", scan, recorded, out, "--scene", beside}).contains("scene"));
  // It is read, and so not replaced by what is written.
  expectRefused(fettle({"replay", scan, recorded, out, "--forces", beside}), "would replace an input");
}

TEST_F(SceneBeside, ItIsReplacedTogetherWithItsRecordingOrNot) {
  ASSERT_EQ(onADesk({"--seconds", "0.1"}).status, 0);
  const std::string fitted = textIn(beside), strokes = textIn(recorded);
  const std::string own = scene("[force]\nstiffness_n_per_mm = 0.9\n[brush]\nradius_samples = 3\n");
  ProcessOptions full;
  full.file_limit = 8192;
  ASSERT_LT(fitted.size(), *full.file_limit);
  const Outcome failed = onADesk({"--scene", own, "--fit", "--seconds", "1"}, full);
  EXPECT_EQ(failed.status, 1);
  EXPECT_NE(failed.err.find("limit on file sizes"), std::string::npos) << failed.err;
  EXPECT_EQ(textIn(beside), fitted);
  EXPECT_EQ(textIn(recorded), strokes);
  // One that was not fitted lies there as well, instead of that of the recording before.
  const auto plain =
      nlohmann::json::parse(onADesk({"--json", "--scene", own, "--scale", "0.5", "--seconds", "0.1"}).out);
  EXPECT_EQ(plain["scene"], beside);
  EXPECT_NE(textIn(beside), fitted);
  EXPECT_NE(textIn(beside).find("stiffness_n_per_mm = 0.9"), std::string::npos) << textIn(beside);
  EXPECT_EQ(replayed()["scene"], beside);
  // And is the scene of another recording, where it lies.
  EXPECT_EQ(onADesk({"--scene", beside, "--scale", "0.5", "--seconds", "0.1"}).status, 0);
}

TEST_F(SceneBeside, WhatSomebodyWroteThereIsReplacedWithForceAlone) {
  const std::string text = "# by hand\n[force]\nstiffness_n_per_mm = 0.25\n";
  std::ofstream(beside) << text;
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{}, {"--scene-out", folder.file("other.toml")}}) {
    std::vector<std::string> arguments = {"--seconds", "0.1"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    expectRefused(onADesk(arguments), beside);
    EXPECT_EQ(textIn(beside), text);
    EXPECT_FALSE(std::filesystem::exists(recorded));
  }
  EXPECT_EQ(onADesk({"--seconds", "0.1", "--force"}).status, 0);
  EXPECT_NE(textIn(beside), text);
  // By its name it is replaced as other outputs are.
  std::ofstream(beside) << text;
  EXPECT_EQ(onADesk({"--seconds", "0.1", "--scene-out", beside}).status, 0);
  EXPECT_NE(textIn(beside), text);
}

TEST_F(SceneBeside, IsNeverWrittenOverWhatIsRead) {
  const std::string strokes = textIn(path);
  expectRefused(record("hand:", {"--scene-out", path}), "would replace an input");
  EXPECT_EQ(textIn(path), strokes);
}

TEST_F(Stability, FitIsRefusedWhereNothingIsFittedAndIsForTheScaleThatIsGiven) {
  expectRefused(record("hand:", {"--fit"}), "--fit");
  const auto stiffnessAt = [&](const std::string& scale) {
    const Outcome done = fettle({"record", scan, recorded, "--device", "woodenhaptics", "--seconds", "0.1",
                                 "--json", "--fit", "--scale", scale});
    const auto report = nlohmann::json::parse(done.out);
    EXPECT_FALSE(report.contains("warnings")) << report["warnings"];
    return report["felt_stiffness_n_per_mm"].get<double>();
  };
  const double coarse = stiffnessAt("0.5");
  EXPECT_GT(coarse, 0.2);
  EXPECT_NEAR(stiffnessAt("0.05") / coarse, 1.0, 2e-3);
}

TEST_F(Stability, RecordSaysThatItWaitsForADeviceThatIsNotThereAndHowToEnd) {
  const Outcome waited =
      fettle({"record", scan, recorded, "--device", "woodenhaptics", "--seconds", "0.3", "-q", "--json"});
  const Outcome shown = fettle({"record", scan, recorded, "--device", "woodenhaptics", "--seconds", "0.3"});
  const auto report = nlohmann::json::parse(waited.out, nullptr, false);
  if (report["device"]["connects"] != 0) GTEST_SKIP() << "a device is plugged in";
  EXPECT_NE(shown.err.find("device not plugged in: plug it in, it is waited for; Ctrl-C ends"),
            std::string::npos)
      << shown.err;
}

TEST_F(Stability, WithoutADeviceASceneThatNoneHoldsIsTakenWithAWarning) {
  const std::string stiff = scene("[force]\nstiffness_n_per_mm = 1000\n");
  const std::string warning = "fettle: warning: " + stiff;
  const Outcome replayed = fettle({"replay", scan, path, out, "--scene", stiff});
  EXPECT_EQ(replayed.status, 0);
  EXPECT_NE(replayed.err.find(warning), std::string::npos) << replayed.err;
  EXPECT_NE(replayed.err.find("1000 N/mm"), std::string::npos) << replayed.err;
  EXPECT_NE(replayed.err.find("at most "), std::string::npos) << replayed.err;
  EXPECT_TRUE(std::filesystem::exists(out));
  const Outcome played = record("replay:", {"--scene", stiff});
  EXPECT_EQ(played.status, 0);
  EXPECT_NE(played.err.find(warning), std::string::npos) << played.err;
  // The project's own say nothing.
  for (const char* name : {"default", "everything", "gentle_clean", "listen", "trace_edges"}) {
    const std::string own = inSourceTree(std::string("assets/scenes/") + name + ".toml");
    EXPECT_EQ(fettle({"replay", scan, path, out, "--scene", own}).err, "") << name;
  }
  EXPECT_EQ(fettle({"replay", scan, path, out}).err, "");
}

}  // namespace
}  // namespace fettle::tests
