// A graphics device that is lost, in every place where a driver can say so: the picture comes back, and
// nothing else was ever gone.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

class LossTest : public WindowTest {
 protected:
  LossTest() : WindowTest(Frames::kThroughVulkan) {}

  // The program with the layer that takes devices away, with a smoothed and a marked band.
  std::unique_ptr<ViewProgram> startWithWork() {
    auto program = start({scan}, {{"VK_ADD_LAYER_PATH", FETTLE_LAYER_FOLDER},
                                  {"VK_INSTANCE_LAYERS", "VK_LAYER_FETTLE_lose_device"},
                                  {"FETTLE_LOSE_DEVICE", orders_path}});
    User user(display, *program, "loss");
    (void)opened(*program);
    (void)user.key("7");
    (void)user.key("s");
    (void)user.stroke({240, 360}, {400, 360}, 5);
    (void)user.key("m");
    (void)user.stroke({590, 320}, {590, 410}, 5);
    (void)user.key("Escape");
    user.at({20, 790});
    (void)user.rest();
    return program;
  }
  void order(const std::string& lines) const {
    const std::string temporary = orders_path + ".all";
    std::ofstream(temporary) << lines;
    std::filesystem::rename(temporary, orders_path);
  }
  static State lost(ViewProgram& program, int times) {
    return program.until("the device was lost and works again",
                         [&](const State& s) { return s["device_losses"] == times && s["settled"] == true; });
  }

  std::string orders_path = folder.file("orders.txt");
};

TEST_F(LossTest, a_lost_device_comes_back_with_everything_in_its_place) {
  const auto program = startWithWork();
  User user(display, *program, "loss");
  const Screen marked = user.look("with marks");
  const State before = program->now();
  (void)user.key("ctrl+z");
  const Screen unmarked = user.changed("without marks", marked);
  (void)user.key("ctrl+shift+z");
  int losses = 0;
  for (const char* where : {"surface", "upload", "panels", "acquire", "present"}) {
    // Undo brings tiles over, so that each of these places is come by.
    order(std::string("lose ") + where + "\n");
    (void)user.press("ctrl+z");
    const State after = lost(*program, ++losses);
    EXPECT_EQ(after["view"], before["view"]) << where;
    EXPECT_EQ(after["steps"], 1) << where;
    EXPECT_TRUE(user.reads("graphics device was lost")) << where;
    (void)user.same(std::string("unmarked after the loss at ") + where, unmarked);
    (void)user.key("ctrl+shift+z");
    (void)user.same(std::string("marked after the loss at ") + where, marked);
  }
  (void)user.look("after five losses");
  // A second loss right away, in the middle of the first uploads; then two refusals to start.
  order("lose surface\nlose upload\nlose present\nrefuse\nrefuse\n");
  (void)user.press("Left");
  (void)lost(*program, losses + 5);
  (void)user.changed("turned after losses in a row", marked, 2000);
  (void)user.key("7");
  (void)user.same("marked after losses in a row", marked);

  // A stroke that runs when the device goes is kept, and is one.
  (void)user.key("s");
  user.at({250, 186});
  user.down(1);
  user.at({270, 186});
  order("lose surface\n");
  user.at({290, 186});
  program->until("lost in a stroke", [&](const State& s) { return s["device_losses"] == losses + 6; });
  user.at({340, 186});
  user.up(1);
  EXPECT_EQ(user.rest()["steps"], 3);
  (void)user.key("Escape");
  user.at({20, 790});
  (void)user.changed("smoothed across a loss", marked);

  (void)user.press("ctrl+q");
  program->until("a question", [](const State& s) { return s["dialog"] == "unsaved"; });
  (void)user.press("Delete");
  EXPECT_EQ(program->wait(), 0) << program->err();
  EXPECT_EQ(program->report()["steps"], 3);
  expectSilence(*program);
}

TEST_F(LossTest, a_device_that_stays_away_ends_the_program_with_the_work_kept) {
  const auto program = startWithWork();
  User user(display, *program, "gone");
  order("lose present\ngone\n");
  display.hands({"key", "Left"});
  EXPECT_EQ(program->wait(), 1);
  EXPECT_EQ(program->err().rfind("{\"schema\":\"fettle.error/1\",\"error\":\"", 0), 0U) << program->err();
  EXPECT_EQ(std::count(program->err().begin(), program->err().end(), '\n'), 1) << program->err();
  EXPECT_NE(program->err().find("unsaved work is stored"), std::string::npos) << program->err();

  // With the device back the work is where it was left.
  order("");
  const auto again = start({scan});
  again->until("a question", [](const State& s) { return s["dialog"] == "recover" && s["settled"] == true; });
  User later(display, *again, "gone");
  (void)later.look("work is found again");
  (void)later.press("Return");
  EXPECT_EQ(opened(*again)["steps"], 2);
  (void)later.look("gone on with");
  again->signal(SIGTERM);
  EXPECT_EQ(again->wait(), 0) << again->err();
  expectSilence(*again);
}

TEST_F(LossTest, too_little_memory_for_a_preview_costs_the_preview_alone) {
  const auto program = startWithWork();
  User user(display, *program, "memory");
  // The panels' own buffers have grown before, so that the next ones are the preview's.
  (void)user.key("F1");
  (void)user.key("Escape");
  const Screen before = user.look("before");
  order("memory\n");
  (void)user.press("p");
  program->until("a message",
                 [](const State& s) { return s["dialog"] == "message" && s["settled"] == true; });
  (void)user.look("message");
  (void)user.press("Return");
  program->until("no message", [](const State& s) { return s["dialog"] == "none"; });
  (void)user.key("Escape");
  (void)user.same("the field", before);
  EXPECT_EQ(program->now()["device_losses"], 0);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0);
  expectSilence(*program);
}

TEST_F(LossTest, a_swap_chain_that_no_longer_fits_is_made_anew) {
  const auto program = startWithWork();
  User user(display, *program, "swapchain");
  const Screen before = user.look("before");
  for (const char* what :
       {"outdated acquire", "suboptimal acquire", "outdated present", "suboptimal present"}) {
    order(std::string(what) + "\n");
    (void)user.key("c");
    (void)user.changed(std::string("contours after ") + what, before, 300);
    (void)user.key("c");
    (void)user.same(std::string("the field after ") + what, before);
    EXPECT_EQ(std::filesystem::file_size(orders_path), 0U) << what;
  }
  EXPECT_EQ(program->now()["device_losses"], 0);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0);
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
