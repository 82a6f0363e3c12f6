#include "app/work/scene_text_file.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

TEST(SceneTextFile, what_is_written_is_read_back_to_the_same_scene) {
  const tests::TempFolder folder;
  haptic::Scene scene;
  scene.effects = {haptic::EffectKind::kSpring, haptic::EffectKind::kTexture};
  scene.params.texture = {0.0123456789, 3.0, haptic::TexturePattern::kGrating};
  scene.brush_falloff = haptic::Falloff::kSmooth;
  scene.max_change = 0.25;
  const std::string path = folder.file("s.toml");
  ASSERT_TRUE(writeScene(path, scene));
  const auto back = readSceneFor(path, tests::fieldOf(
                                           8, 8, [](int, int) { return 0.0; }, 1.0, 1.0)
                                           .grid());
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(*back, scene);
}

TEST(SceneTextFile, what_cannot_be_written_leaves_what_is_there) {
  const tests::TempFolder folder;
  const std::string path = folder.file("s.toml");
  std::ofstream(path) << "tip = \"point\"\n";
  haptic::Scene wrong;
  wrong.force_limit_n = 0.0;
  EXPECT_FALSE(writeScene(path, wrong));
  EXPECT_EQ(std::filesystem::file_size(path), 14U);
  EXPECT_FALSE(writeScene(folder.file("no/such/s.toml"), {}));
}

TEST(SceneTextFile, a_ball_that_is_too_large_for_the_field_is_refused) {
  const tests::TempFolder folder;
  const std::string path = folder.file("s.toml");
  std::ofstream(path) << "tip = \"sphere\"\ntip_radius_mm = 20\n";
  const auto fields = [](double spacing) {
    return tests::fieldOf(
               8, 8, [](int, int) { return 0.0; }, spacing, spacing)
        .grid();
  };
  EXPECT_TRUE(readSceneFor(path, fields(2.0)));
  const auto refused = readSceneFor(path, fields(0.1));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, path);
  std::ofstream(path) << "\n[friction]\nstatic = 9\n";
  const auto line = readSceneFor(path, fields(2.0));
  ASSERT_FALSE(line);
  EXPECT_EQ(line.error().what, "line 3: static in [friction] must be 0 to 2");
}

}  // namespace
}  // namespace fettle::app
