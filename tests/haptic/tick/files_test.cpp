// Strokes, forces and scene files: round trips and refusals.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "haptic/base/strokes.h"
#include "haptic/effects/stability.h"
#include "haptic/scene/scene.h"
#include "haptic/scene/scene_numbers.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

void put(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(Strokes, EveryDoubleComesBack) {
  const tests::TempFolder folder;
  std::vector<StrokeSample> strokes;
  for (int i = 0; i < 50000; ++i)
    strokes.push_back({i * 1e-3, {i / 3.0, -1e-310 * i, 1e300 / (i + 1)}, static_cast<Tool>(i % kTools)});
  ASSERT_TRUE(writeStrokes(folder.file("s.csv"), strokes));
  const auto back = readStrokes(folder.file("s.csv"));
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, strokes);
}

TEST(Strokes, TakesWindowsLinesNoLastLineEndAndDropouts) {
  const tests::TempFolder folder;
  put(folder.file("s.csv"), "t,x,y,z,tool\r\n0,1,2,3,mark\r\n1e-3,nan,2,3,unmark");
  const auto strokes = readStrokes(folder.file("s.csv"));
  ASSERT_TRUE(strokes);
  ASSERT_EQ(strokes->size(), 2U);
  EXPECT_EQ((*strokes)[0].tool, Tool::kMark);
  EXPECT_TRUE(std::isnan((*strokes)[1].tip_mm.x));
  put(folder.file("empty.csv"), "t,x,y,z,tool\n\n\n");
  EXPECT_TRUE(readStrokes(folder.file("empty.csv"))->empty());
}

TEST(Strokes, RefusesBadFilesNamingTheLine) {
  const tests::TempFolder folder;
  const std::string path = folder.file("s.csv");
  for (const char* row : {"0,1,2,3", "0,1,2,3,", "0,1,2,3,feel,", "0,1,x,3,feel", "0,,2,3,feel",
                          "0,1,2,3,paint", "0,1,2,1e999,feel", "", "0 ,1,2,3,feel"}) {
    put(path, std::string("t,x,y,z,tool\n0,0,0,0,feel\n") + row + "\n0,0,0,0,feel\n");
    const auto strokes = readStrokes(path);
    ASSERT_FALSE(strokes) << row;
    EXPECT_EQ(strokes.error().kind, engine::ErrorKind::kInput);
    EXPECT_NE(strokes.error().what.find("line 3"), std::string::npos) << strokes.error().line();
  }
  put(path, "x,y\n");
  EXPECT_NE(readStrokes(path).error().what.find("line 1"), std::string::npos);
  EXPECT_FALSE(readStrokes(folder.file("none.csv")));
  EXPECT_FALSE(readStrokes(folder.path().string()));
}

TEST(Forces, AreWrittenAsDocumented) {
  const tests::TempFolder folder;
  const ForceSample samples[] = {{0.001, {1, 2, 3}, {0, 0, 0.5}, true}, {0.002, {1, 2, 4}, {0, 0, 0}, false}};
  ASSERT_TRUE(writeForces(folder.file("f.csv"), samples));
  std::stringstream text;
  text << std::ifstream(folder.file("f.csv")).rdbuf();
  EXPECT_EQ(text.str(),
            "t,proxy_x,proxy_y,proxy_z,fx,fy,fz,contact\n0.001,1,2,3,0,0,0.5,1\n0.002,1,2,4,0,0,0,0\n");
  EXPECT_FALSE(writeForces(folder.file("no/such/folder.csv"), samples));
}

TEST(SceneFile, TheDocumentedDefaultIsTheDefaultAndAllExamplesLoad) {
  const std::string folder = tests::inSourceTree("assets/scenes/");
  const auto scene = loadScene(folder + "default.toml");
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(*scene, defaultScene());
  ASSERT_TRUE(loadScene(folder + "trace_edges.toml"));
  EXPECT_TRUE(loadScene(folder + "trace_edges.toml")->invert);
  const auto gentle = loadScene(folder + "gentle_clean.toml");
  ASSERT_TRUE(gentle);
  EXPECT_EQ(gentle->level, ContactLevel::kCertified);
  EXPECT_EQ(gentle->max_change, 0.05);
  const auto listen = loadScene(folder + "listen.toml");
  ASSERT_TRUE(listen);
  EXPECT_TRUE(listen->lists(EffectKind::kSound));
  EXPECT_EQ(listen->params.sound.knock, 0.6);
  EXPECT_FALSE(defaultScene().lists(EffectKind::kSound)) << "off unless a scene asks for it";
}

// A number of a scene, out of its range by a little, in a file and in a scene made by code: one sentence with key and range.
TEST(SceneNumbers, AreRefusedOutOfRangeByOneLine) {
  for (const SceneNumber& number : kSceneNumbers) {
    const std::string key = std::string(number.table) + "." + std::string(number.key);
    const double step = number.kind == NumberKind::kWhole ? 1.0 : 1e-3;
    for (const double wrong : {number.low - (number.low_end == LowEnd::kExcluded ? 0.0 : step),
                               number.high + step, -std::numeric_limits<double>::infinity()}) {
      EXPECT_FALSE(number.holds(wrong)) << key;
      Scene scene;
      number.set(scene, std::isfinite(wrong) ? wrong : number.low - 1.0);
      const auto problem = sceneProblem(scene);
      ASSERT_TRUE(problem) << key;
      EXPECT_EQ(*problem, rangeProblem(number));
      if (!std::isfinite(wrong)) continue;
      const std::string line = fmt::format("{} = {}", number.key, wrong);
      const std::string text = number.table.empty() ? line : fmt::format("[{}]\n{}", number.table, line);
      const auto read = parseScene(text, "scene.toml");
      ASSERT_FALSE(read) << text;
      EXPECT_EQ(read.error().what,
                fmt::format("line {}: {}", number.table.empty() ? 1 : 2, rangeProblem(number)));
    }
    EXPECT_TRUE(number.holds(number.high)) << key;
    EXPECT_EQ(number.holds(number.low), number.low_end == LowEnd::kIncluded) << key;
    EXPECT_TRUE(number.holds(number.of(defaultScene()))) << key;
    EXPECT_FALSE(number.holds(std::nan(""))) << key;
  }
}

TEST(SceneNumbers, TheNearestInRangeIsAnEndOrAWholeNumber) {
  const auto rowOfKey = [](std::string_view key) {
    return *std::ranges::find(kSceneNumbers, key, &SceneNumber::key);
  };
  const SceneNumber grip = rowOfKey("static"), limit = rowOfKey("limit_n"),
                    rounds = rowOfKey("search_rounds");
  EXPECT_EQ(nearestInRange(grip, 3.0), 2.0);
  EXPECT_EQ(nearestInRange(grip, -1.0), 0.0);
  EXPECT_EQ(nearestInRange(grip, 0.3), 0.3);
  EXPECT_EQ(nearestInRange(grip, std::numeric_limits<double>::infinity()), 2.0);
  EXPECT_EQ(nearestInRange(grip, std::nan("")), std::nullopt);
  EXPECT_EQ(nearestInRange(limit, 0.0), std::nullopt) << "zero does not belong to it";
  EXPECT_EQ(nearestInRange(limit, 2000.0), 1000.0);
  EXPECT_EQ(nearestInRange(rounds, 4.4), 4.0);
  EXPECT_EQ(rangeText(grip), "0 to 2");
  EXPECT_EQ(rangeText(limit), "above 0, at most 1000 N");
  EXPECT_EQ(rangeText(rounds), "a whole number from 2 to 2048");
}

// Both documents have every number and every word: default.toml with its default, docs/scenes.md with its range.
TEST(SceneNumbers, AreDocumentedWithDefaultAndRange) {
  const auto textOf = [](const char* path) {
    std::stringstream text;
    text << std::ifstream(tests::inSourceTree(path)).rdbuf();
    return text.str();
  };
  const std::string pattern = textOf("assets/scenes/default.toml"), page = textOf("docs/scenes.md");
  std::string table;
  const auto placeOf = [&](std::string_view name) {
    return name.empty() ? "" : fmt::format("`[{}]` ", name);
  };
  for (const SceneNumber& number : kSceneNumbers) {
    EXPECT_NE(pattern.find(fmt::format("\n{} = ", number.key)), std::string::npos) << number.key;
    const std::string row = fmt::format("| {}`{}` | {} | {} | {} |", placeOf(number.table), number.key,
                                        number.of(defaultScene()), rangeText(number), number.says);
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
  for (const SceneWord& word : kSceneWords) {
    EXPECT_NE(pattern.find(fmt::format("\n{} = \"{}\"", word.key, word.words[word.of(defaultScene())])),
              std::string::npos)
        << word.key;
    const std::string row =
        fmt::format("| {}`{}` | {} | {} | {} |", placeOf(word.table), word.key,
                    word.words[word.of(defaultScene())], fmt::join(word.words, ", "), word.says);
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

TEST(SceneFile, SoundIsReadBackAsItWasWritten) {
  Scene scene;
  scene.effects = {EffectKind::kSpring, EffectKind::kSound};
  scene.params.sound = {0.1, 2.5, 0.0, 777.7, 12.3};
  const auto again = parseScene(sceneText(scene), "text");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(*again, scene);
}

TEST(SceneFile, EverythingListsEveryEffectWithinWhatADeviceHolds) {
  const auto scene = loadScene(tests::inSourceTree("assets/scenes/everything.toml"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->effects.size(), static_cast<std::size_t>(kEffectKinds));
  EXPECT_EQ(scene->params.friction.dynamic_coefficient, 0.2);
  EXPECT_EQ(scene->params.texture.wavelength_mm, 2.0);
  EXPECT_EQ(sceneProblem(*scene), std::nullopt);
  DeviceProfile profile;
  profile.max_stiffness_n_per_mm = 1.0;
  profile.max_damping_n_s_per_mm = 0.005;
  EXPECT_EQ(stabilityProblem(*scene, profile, 1000.0), std::nullopt);
  // The weakest of devices does not hold it, at a fifth of the rate nothing does.
  EXPECT_NE(stabilityProblem(*scene, DeviceProfile{}, 1000.0), std::nullopt);
  EXPECT_NE(stabilityProblem(*scene, profile, 200.0), std::nullopt);
  profile.max_damping_n_s_per_mm = 0.003;
  EXPECT_NE(stabilityProblem(*scene, profile, 1000.0), std::nullopt);
}

TEST(SceneFile, EffectsThatStandOnTheSpringComeAfterIt) {
  Scene scene;
  for (const EffectKind kind : {EffectKind::kFriction, EffectKind::kTexture, EffectKind::kCoupling}) {
    scene.effects = {kind};
    EXPECT_NE(sceneProblem(scene), std::nullopt);
    scene.effects = {kind, EffectKind::kSpring};
    EXPECT_NE(sceneProblem(scene), std::nullopt);
    scene.effects = {EffectKind::kSpring, kind};
    EXPECT_EQ(sceneProblem(scene), std::nullopt);
  }
  scene.params.friction = {0.2, 0.3, 1.0};
  EXPECT_NE(sceneProblem(scene), std::nullopt);
  scene = {};
  scene.params.velocity.filter_ms = NAN;
  EXPECT_NE(sceneProblem(scene), std::nullopt);
}

TEST(SceneFile, RefusesUnknownKeysTypesAndRangesWithTheLine) {
  const tests::TempFolder folder;
  const std::string path = folder.file("s.toml");
  for (const char* line : {"colour = 1",
                           "invert = 1",
                           "effects = [\"glow\"]",
                           "effects = [\"spring\", \"spring\"]",
                           "effects = 3",
                           "tip = \"ball\"",
                           "force = { limit_n = 0 }",
                           "force = { limit_n = nan }",
                           "force = { stiffness = 1 }",
                           "force = { stiffness_n_per_mm = \"1\" }",
                           "contact = { certified_radius_cells = 1.5 }",
                           "contact = { search_rounds = 1 }",
                           "contact = { search_rounds = 2049 }",
                           "contact = { ball_searches = -1 }",
                           "contact = { ball_searches = 4097 }",
                           "contact = { ball_searches = 1.5 }",
                           "contact = { ball_work = -1 }",
                           "contact = { ball_work = 1000001 }",
                           "contact = { ball_minima = \"some\" }",
                           "contact = { ball_steps = \"level\" }",
                           "contact = { search_rounds = 5 }",
                           "contact = { level = \"paper\", search_rounds = 2047 }",
                           "contact = { level = \"best\" }",
                           "brush = { max_change = -1 }",
                           "friction = { static = 3 }",
                           "friction = { static = nan }",
                           "friction = { dynamic = 0.5 }",
                           "friction = { grip = 1 }",
                           "viscosity = { in = \"air\" }",
                           "viscosity = { damping_n_s_per_mm = -1 }",
                           "edge_snap = { reach_mm = 0 }",
                           "texture = { wavelength_mm = \"1\" }",
                           "texture = 3",
                           "texture = { pattern = \"wood\" }",
                           "gravity = { stylus_kg = inf }",
                           "coupling = { in = \"contact\" }",
                           "sound = 3",
                           "sound = { volume = 1 }",
                           "sound = { profile = 10.5 }",
                           "sound = { knock = -1 }",
                           "sound = { slip = \"loud\" }",
                           "sound = { body_hz = 0 }",
                           "sound = { body_hz = nan }",
                           "sound = { ring_ms = inf }",
                           "effects = [\"sound\", \"sound\"]",
                           "effects = [\"friction\", \"spring\"]",
                           "velocity = { filter_ms = 51 }",
                           "brush = { radius_samples = 65 }",
                           "= 3"}) {
    put(path, std::string("# a scene\n") + line + "\n");
    const auto scene = loadScene(path);
    ASSERT_FALSE(scene) << line;
    EXPECT_EQ(scene.error().kind, engine::ErrorKind::kInput);
    EXPECT_NE(scene.error().what.find("line 2"), std::string::npos) << scene.error().line();
  }
  EXPECT_FALSE(loadScene(folder.file("none.toml")));
}

}  // namespace
}  // namespace fettle::haptic
