// Tools and tips chosen by buttons of a device, in the window, through the driver and a replacement of the maker's library.
#include <chrono>
#include <csignal>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <thread>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/haptic/devices/fake_vendor/shared_page.h"

namespace fettle::tests {
namespace {

using State = User::State;

struct ButtonMaker {
  const char* word;
  const char* variable;
  const char* library;
};
void PrintTo(const ButtonMaker& maker, std::ostream* out) {
  *out << maker.word;
}

class DeviceButtons : public WindowTest, public testing::WithParamInterface<ButtonMaker> {
 protected:
  void SetUp() override {
    WindowTest::SetUp();
    if (IsSkipped()) return;
    const std::string page = folder.file("page");
    page_ = fake::SharedPage::map(page.c_str());
    ASSERT_NE(page_, nullptr);
    program_ = start({scan, "--device", GetParam().word}, {{GetParam().variable, GetParam().library},
                                                           {"FAKE_VENDOR_PAGE", page},
                                                           {"FAKE_VENDOR_LOG", folder.file("broken")}});
    program_->until("the device",
                    [](const State& s) { return s.contains("device") && s["connected"] == true; });
  }
  // Buttons by their numbers, held from now on; returns when the loop has seen them.
  State hold(std::initializer_list<int> numbers) {
    int mask = 0;
    for (const int number : numbers) mask |= 1 << (number - 1);
    return holdMask(mask);
  }
  // Pressed and released while the others are held.
  State press(std::initializer_list<int> others, int number) {
    (void)hold(others);
    (void)holdMask(page_->buttons | 1 << (number - 1));
    return hold(others);
  }
  State holdMask(int mask) {
    page_->buttons = mask;
    return program_->until("the buttons", [&](const State& s) { return s["device_buttons"] == mask; });
  }
  // At the speed of a hand, until it is there or the stylus touches.
  void moveTo(double up_mm) {
    const double step_mm = up_mm < page_->up_mm ? -0.05 : 0.05;
    while ((up_mm - page_->up_mm) * step_mm > 0.0) {
      page_->up_mm = page_->up_mm + step_mm;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (step_mm < 0.0 && program_->now()["touching"] == true) return;
    }
  }
  State tool(const std::string& word, const std::string& title) {
    return program_->until("the tool " + word, [&](const State& s) {
      return s["tool"] == word && s["status"] == "tool: " + title;
    });
  }
  void expectSteps(int steps) { EXPECT_EQ(program_->now()["steps"], steps); }

  fake::SharedPage* page_ = nullptr;
  std::unique_ptr<ViewProgram> program_;
};

TEST_P(DeviceButtons, choose_tools_and_tips_and_neither_begin_nor_lose_a_stroke) {
  // Two buttons are enough: the first under the second, held.
  (void)press({2}, 1);
  (void)tool("smooth", "Smooth");
  (void)press({2}, 1);
  (void)tool("mark", "Mark");
  (void)hold({});
  // The third of those that have it; past the last tool the first comes again.
  (void)press({}, 3);
  (void)tool("unmark", "Unmark");
  (void)press({}, 3);
  (void)tool("feel", "Feel");
  for (const char* name : {"ball, radius 1 cell", "ball, radius 2 cells", "point"}) {
    (void)press({}, 4);
    const State now = program_->until(
        "the tip", [&](const State& s) { return s["status"] == std::string("tip: ") + name; });
    EXPECT_EQ(now["contact_level"], name == std::string("point") ? "paper" : "ball");
  }
  expectSteps(0);

  // A stroke that marks: the choice of a button during it is none, and it is one step.
  for (const char* word : {"smooth", "mark"}) {
    (void)press({}, 3);
    program_->until("a tool", [&](const State& s) { return s["tool"] == word; });
  }
  User user(display, *program_, "buttons");
  (void)user.press("a");
  program_->until("an armed device",
                  [](const State& s) { return s["safety"] == "active" || s["safety"] == "ramping"; });
  (void)hold({1});
  moveTo(-40.0);
  (void)program_->until("contact", [](const State& s) { return s["touching"] == true; });
  (void)press({1}, 3);
  (void)press({1}, 4);
  moveTo(30.0);
  (void)hold({});
  const State after = program_->until("a step", [](const State& s) { return s["steps"] == 1; });
  EXPECT_EQ(after["tool"], "mark");
  EXPECT_EQ(after["contact_level"], "paper");
  EXPECT_EQ(after["last_step"], 1);
  // Under the clutch the first button is no stroke, even where the clutch is released first.
  (void)hold({2});
  (void)hold({1, 2});
  (void)hold({1});
  (void)tool("unmark", "Unmark");
  (void)hold({});
  expectSteps(1);
  program_->signal(SIGTERM);
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectSilence(*program_);
  // Rules of the maker's library that were broken; it writes the file when it ends.
  std::ifstream log(folder.file("broken"));
  EXPECT_TRUE(log.is_open());
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(log), {}), "");
}

TEST_P(DeviceButtons, the_second_opens_the_tools_around_the_tip_where_the_device_is_set_up_so) {
  User user(display, *program_, "tools around the tip");
  (void)user.press("ctrl+shift+d");
  program_->until("the page", [](const State& s) { return s["dialog"] == "device"; });
  (void)user.press("u");
  (void)user.press("Return");
  const State set = program_->until("it is used", [](const State& s) {
    return s["dialog"] == "none" && s["connected"] == true && s["device_check"]["menu_buttons"] == 2;
  });
  EXPECT_EQ(set["device_check"]["clutch_buttons"], 0) << "a button has one duty";

  const auto radial = [&](const State& is) {
    return program_->until("the menu at " + is.dump(), [&](const State& s) { return s["radial"] == is; });
  };
  (void)hold({2});
  (void)radial("");
  // The first button is no stroke meanwhile.
  (void)hold({1, 2});
  (void)hold({2});
  for (int i = 0; i < 200; ++i) {
    page_->right_mm = page_->right_mm + 0.1;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  (void)radial("Unmark");
  (void)user.look("the tip points at a tool");
  (void)hold({});
  (void)program_->until("unmark",
                        [](const State& s) { return s["tool"] == "unmark" && s["radial"].is_null(); });
  // A tap leaves it open; Escape ends it, and nothing was chosen.
  (void)hold({2});
  (void)radial("");
  (void)hold({});
  (void)user.press("Escape");
  EXPECT_EQ(radial(nullptr)["tool"], "unmark");
  expectSteps(0);
  program_->signal(SIGTERM);
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectSilence(*program_);
}

INSTANTIATE_TEST_SUITE_P(Makers, DeviceButtons,
                         testing::Values(ButtonMaker{"touch", "FETTLE_LIBHD", FETTLE_FAKE_HD},
                                         ButtonMaker{"forcedimension", "FETTLE_LIBDHD", FETTLE_FAKE_DHD}),
                         [](const auto& made) { return made.param.word; });

}  // namespace
}  // namespace fettle::tests
