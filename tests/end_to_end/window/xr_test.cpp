// `fettle view --xr` with a scripted headset (tests/xr_runtime): the field on a table before one, beside the window.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "render/png/png.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/xr_runtime/xr_stage.h"

namespace fettle::tests {
namespace {

using State = User::State;

class XrTest : public WindowTest {
 protected:
  std::unique_ptr<ViewProgram> startWith(const XrStage& stage, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {scan, "--xr"});
    return start(more, stage.environment());
  }
  static bool maps(const ViewProgram& program, const std::string& file) {
    std::ifstream maps("/proc/" + std::to_string(program.pid()) + "/maps");
    return std::string(std::istreambuf_iterator<char>(maps), {}).find(file) != std::string::npos;
  }
};

// Pixels that differ from the picture's upper left corner.
int drawnPixels(const render::Image& image) {
  int drawn = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    drawn += std::equal(&image.rgba[i], &image.rgba[i] + 3, image.rgba.data()) ? 0 : 1;
  return drawn;
}

// A head over a table, which looks down at it.
constexpr const char* kHead = "size 320 340\nrate 30\n0 head 0 1.45 0 0 0\n1 head 0 1.45 -0.05 0 -50\n";

TEST_F(XrTest, the_field_is_on_a_table_for_both_eyes_and_in_the_window) {
  std::string script = kHead;
  for (int frame = 10; frame <= 600; frame += 10) script += std::to_string(frame) + " keep\n";
  const XrStage stage(script);
  const auto program = startWith(stage);
  User user(display, *program, "xr");
  (void)opened(*program);
  (void)program->until("the headset shows it", [](const State& s) { return s["headset"] == "shown"; });
  EXPECT_TRUE(maps(*program, "libopenxr_loader"));
  (void)user.look("beside the headset");
  const State before = program->now();
  (void)user.key("Left");
  EXPECT_NE(program->now()["view"], before["view"]) << "the window goes on";
  const State report = quit(user);
  EXPECT_EQ(report["headset"], "Scripted headset");
  EXPECT_GT(report["headset_frames"].get<int>(), 3);
  EXPECT_EQ(stage.count("exit requested"), 1);
  EXPECT_EQ(stage.count("session ended"), 1);
  EXPECT_EQ(stage.count("instance destroyed"), 1);
  stage.expectLeftInOrder(XrStage::Session::kEnded);
  stage.expectSilence();
  // The last kept pictures have the field.
  int shown = 0;
  for (int frame = 10; frame <= 600; frame += 10) {
    const auto left = render::readPng(stage.file("frame" + std::to_string(frame) + ".left.png"));
    const auto right = render::readPng(stage.file("frame" + std::to_string(frame) + ".right.png"));
    if (!left || !right) continue;
    EXPECT_NE(left->rgba, right->rgba);
    // 0.6 m at about 0.9 m: more than a tenth of the picture.
    EXPECT_GT(drawnPixels(*left), 320 * 340 / 10);
    EXPECT_GT(drawnPixels(*right), 320 * 340 / 10);
    ++shown;
  }
  EXPECT_GT(shown, 0) << stage.log();
}

TEST_F(XrTest, a_lost_headset_is_said_once_and_the_window_goes_on) {
  const XrStage stage(std::string(kHead) + "40 lose\n");
  const auto program = startWith(stage);
  User user(display, *program, "xr lost");
  const State over =
      program->until("the headset is lost", [](const State& s) { return s["headset"] == "over"; });
  (void)opened(*program);
  int said = 0;
  const State now = program->now();
  for (const auto& notice : now["notices"])
    said += notice.get<std::string>().find("the headset was unplugged") != std::string::npos ? 1 : 0;
  EXPECT_EQ(said, 1) << now["notices"];
  (void)user.key("Left");
  const State report = quit(user);
  EXPECT_EQ(report["headset"], "Scripted headset");
  EXPECT_EQ(stage.count("instance destroyed"), 1);
  stage.expectSilence();
}

TEST_F(XrTest, a_headset_lost_before_a_scan_is_open_is_said_beside_the_start_page) {
  const XrStage stage(std::string(kHead) + "40 lose\n");
  const auto program = start({"--xr"}, stage.environment());
  User user(display, *program, "xr lost at the start");
  program->until("that it is lost", [](const State& s) {
    return s["texts"].dump().find("the headset was unplugged") != std::string::npos;
  });
  EXPECT_TRUE(user.reads("A sample part"));
  (void)user.look("start page");
  (void)user.click("Understood");
  user.at({40, 400});
  EXPECT_FALSE(user.reads("the headset was unplugged"));
  (void)quit(user);
}

TEST_F(XrTest, without_a_runtime_it_says_so_in_one_line_and_ends) {
  const std::string none = folder.file("none.json");
  const auto program = start({scan, "--xr"}, {{"XR_RUNTIME_JSON", none}});
  EXPECT_EQ(program->wait(), 1);
  const std::string& said = program->err();
  EXPECT_EQ(
      said.find(R"({"schema":"fettle.error/1","error":"no headset can be used: no runtime is installed)"), 0U)
      << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  for (const char* part : {"install the runtime", none.c_str()})
    EXPECT_NE(said.find(part), std::string::npos) << "'" << part << "' in " << said;
}

TEST_F(XrTest, without_the_option_nothing_of_it_is_loaded) {
  const XrStage stage(kHead);
  const auto program = start({scan}, stage.environment());
  User user(display, *program, "xr unused");
  const State shown = opened(*program);
  EXPECT_EQ(shown["headset"], "none");
  for (const char* file : {"openxr", "xr_runtime", "XrApiLayer"}) EXPECT_FALSE(maps(*program, file)) << file;
  const State report = quit(user);
  EXPECT_FALSE(report.contains("headset"));
  EXPECT_EQ(stage.log(), "") << "the runtime was asked";
}

}  // namespace
}  // namespace fettle::tests
