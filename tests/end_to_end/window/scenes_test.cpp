// Scenes by hand: effects with their numbers in the panel, a problem beside the value while it is typed, files opened and
// saved, and the question at the end where something felt was changed.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "haptic/scene/scene.h"
#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

class ScenesTest : public WindowTest {
 protected:
  ScenesTest() : WindowTest(1200, 1000) {}
  void SetUp() override {
    WindowTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    const std::filesystem::path settings = folder.path() / "fettle";
    std::filesystem::create_directories(settings);
    State panels;
    for (const char* each : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[each] = false;
    panels["Haptics"] = true;
    std::ofstream(settings / "window.json") << State{{"panels", panels}};
  }
  // A hand that rests over the field.
  std::unique_ptr<ViewProgram> startHand() {
    const std::string strokes = folder.file("strokes.csv");
    std::ofstream(strokes) << "t,x,y,z,tool\n0,60,51,20,feel\n600,60,51,20,feel\n";
    auto program = start({scan, "--device", "hand:" + strokes});
    program->until("the hand",
                   [](const State& s) { return s.value("device", "") != "" && s["connected"] == true; });
    return program;
  }
  static void dialogIs(ViewProgram& program, const char* name) {
    program.until(name, [&](const State& s) { return s["dialog"] == name && s["settled"] == true; });
  }
  // Into the dialog of a path that is on the screen.
  static void answerPath(User& user, const std::string& path) {
    user.program().until("a field for the path", [](const State& s) { return s["text_field"] == true; });
    (void)user.key("ctrl+a");
    user.type(path);
    (void)user.press("Return");
  }
  static std::string textOf(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
};

TEST_F(ScenesTest, effects_show_their_numbers_and_a_problem_stands_beside_the_value_that_is_typed) {
  const auto program = startHand();
  User user(display, *program, "effects numbers");
  EXPECT_FALSE(user.readsScrolled("dynamic")) << "friction is not listed";
  (void)user.click("friction");
  (void)user.look("friction");
  EXPECT_TRUE(user.readsScrolled("dynamic"));
  EXPECT_EQ(user.enter("static", "0.5")["scene_numbers"]["friction.static"], 0.5);
  // Out of its range: said while it is typed, clamped when it is left.
  ASSERT_TRUE(user.typeIn("static", "3"));
  program->until("the range beside it", [](const State& s) {
    return s["texts"].dump().find("must be 0 to 2: 2 is taken") != std::string::npos;
  });
  (void)user.look("out of range");
  EXPECT_EQ(program->now()["scene_numbers"]["friction.static"], 0.5) << "typing changes nothing";
  (void)user.press("Escape");
  program->until("left", [](const State& s) {
    return s["text_field"] == false && s["texts"].dump().find("2 is taken") == std::string::npos;
  });
  const State clamped = user.enter("static", "3");
  EXPECT_EQ(clamped["scene_numbers"]["friction.static"], 2.0);
  EXPECT_NE(clamped["notices"].dump().find("static: 2 is taken, it must be 0 to 2"), std::string::npos);
  // More than the hand holds: said at once, refused, and the largest that it holds is taken when typed.
  ASSERT_TRUE(user.typeIn("grip", "500"));
  program->until("the device's limit beside it", [](const State& s) {
    return s["texts"].dump().find("friction with a stiffness of 500") != std::string::npos;
  });
  (void)user.look("more than it holds");
  (void)user.press("Return");
  const State refused = program->until("refused", [](const State& s) {
    return s["notices"].dump().find("stiffness of 500") != std::string::npos && s["settled"] == true;
  });
  EXPECT_EQ(refused["scene_numbers"]["friction.stiffness_n_per_mm"], 1.0) << "what was there stays";
  EXPECT_EQ(user.enter("grip", "6")["scene_numbers"]["friction.stiffness_n_per_mm"], 6.0);
  (void)user.click("viscosity");
  EXPECT_TRUE(user.readsScrolled("speed filter"));
  (void)user.look("viscosity");
  // Without the effect there is no field of it.
  (void)user.click("friction");
  EXPECT_FALSE(user.readsScrolled("dynamic"));
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(ScenesTest, a_scene_is_saved_opened_and_a_broken_one_named_with_its_line) {
  const std::string saved = folder.file("mine.toml"), broken = folder.file("broken.toml");
  std::ofstream(broken) << "# a scene\n[friction]\nstatic = 9\n";
  const auto program = start({scan});
  User user(display, *program, "scene files");
  EXPECT_EQ(opened(*program)["scene"], "no file");
  (void)user.click("gravity");
  EXPECT_EQ(user.enter("mass", "0.2")["scene"], "no file, changed");
  (void)user.press("alt+s");
  dialogIs(*program, "save scene");
  (void)user.look("save");
  answerPath(user, folder.file("mine"));
  const State written = program->until(
      "written", [&](const State& s) { return s["status"] == "written: " + saved && s["settled"] == true; });
  EXPECT_EQ(written["scene"], "mine.toml");
  const auto scene = haptic::loadScene(saved);
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_TRUE(scene->lists(haptic::EffectKind::kGravity));
  EXPECT_EQ(scene->params.gravity.stylus_kg, 0.2);
  (void)user.look("saved");

  // Changed, and the file opened again.
  EXPECT_EQ(user.enter("mass", "0.3")["scene"], "mine.toml, changed");
  (void)user.press("alt+o");
  dialogIs(*program, "open scene");
  (void)user.look("open");
  EXPECT_TRUE(user.reads("broken.toml"));
  EXPECT_FALSE(user.reads("part.tif")) << "a scan is no scene";
  answerPath(user, saved);
  const State again = program->until(
      "opened", [](const State& s) { return s["scene"] == "mine.toml" && s["settled"] == true; });
  EXPECT_EQ(again["scene_numbers"]["gravity.stylus_kg"], 0.2);

  // One with a wrong number changes nothing.
  (void)user.press("alt+o");
  dialogIs(*program, "open scene");
  answerPath(user, broken);
  // The dialog stays, and says what is wrong.
  const State refused = program->until("what is wrong", [](const State& s) {
    return s["dialog"] == "open scene" && s["message"] != "" && s["settled"] == true;
  });
  EXPECT_EQ(refused["message"], "broken.toml: line 3: static in [friction] must be 0 to 2");
  EXPECT_EQ(refused["notices"], State::array());
  EXPECT_EQ(refused["scene"], "mine.toml");
  (void)user.look("broken");
  (void)user.key("Escape");

  // A file that is there is replaced after a question alone.
  const std::string before = textOf(broken);
  (void)user.press("alt+s");
  dialogIs(*program, "save scene");
  answerPath(user, broken);
  dialogIs(*program, "replace");
  (void)user.look("replace");
  EXPECT_EQ(textOf(broken), before);
  (void)user.press("Escape");
  dialogIs(*program, "save scene");
  (void)user.key("Escape");
  EXPECT_EQ(textOf(broken), before);
  (void)user.press("alt+s");
  dialogIs(*program, "save scene");
  answerPath(user, broken);
  dialogIs(*program, "replace");
  (void)user.press("r");
  program->until("replaced",
                 [&](const State& s) { return s["scene"] == "broken.toml" && s["settled"] == true; });
  EXPECT_EQ(textOf(broken), textOf(saved));
  (void)quit(user);
}

TEST_F(ScenesTest, a_scene_that_was_changed_is_asked_for_at_the_end_and_only_then) {
  const std::string saved = folder.file("asked.toml");
  const auto program = start({scan});
  User user(display, *program, "unsaved scene");
  (void)opened(*program);
  (void)user.key("bracketright");  // a brush is a tool's, nothing to ask for
  EXPECT_EQ(program->now()["scene"], "no file");
  (void)user.click("gravity");
  EXPECT_EQ(user.enter("mass", "0.1")["scene"], "no file, changed");
  (void)user.press("ctrl+q");
  dialogIs(*program, "unsaved scene");
  (void)user.look("question");
  (void)user.key("Escape");
  EXPECT_EQ(program->now()["dialog"], "none");
  (void)user.press("ctrl+q");
  dialogIs(*program, "unsaved scene");
  (void)user.press("Return");
  dialogIs(*program, "save scene");
  answerPath(user, saved);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  const auto scene = haptic::loadScene(saved);
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->params.gravity.stylus_kg, 0.1);

  // Given on the command line it has its name, and is left as it is.
  const auto given = start({scan, "--scene", saved});
  User later(display, *given, "given scene");
  EXPECT_EQ(opened(*given)["scene"], "asked.toml");
  (void)later.enter("mass", "0.2");
  (void)later.press("ctrl+q");
  dialogIs(*given, "unsaved scene");
  (void)later.press("Delete");
  EXPECT_EQ(given->wait(), 0) << given->err();
  expectSilence(*given);
  EXPECT_EQ(haptic::loadScene(saved)->params.gravity.stylus_kg, 0.1);
}

}  // namespace
}  // namespace fettle::tests
