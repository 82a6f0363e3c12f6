// What hands do in one frame, while it takes long: no dialog is open that is not on the screen.
#include "tests/end_to_end/window/frame_gate.h"
#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

bool isWritten(const State& s, const std::string& text) {
  return s["texts"].dump().find(text) != std::string::npos;
}

class LockTest : public WindowTest {
 protected:
  LockTest() : WindowTest(Frames::kThroughVulkan) {}

  std::unique_ptr<ViewProgram> startOpened() {
    auto program = start({scan}, gate_.environment());
    (void)opened(*program);
    return program;
  }
  // All of it in one frame.
  void inOneFrame(const std::vector<std::string>& words) {
    ASSERT_TRUE(gate_.hold());
    display.hands(words);
    ASSERT_TRUE(gate_.step());
    gate_.release();
  }
  // The list of keys is on the screen, Esc leaves it, and tools come.
  static void listIsLeftByEsc(User& user) {
    ViewProgram& program = user.program();
    program.skipToNewest();
    program.until("the list on the screen", [](const State& s) {
      return s["dialog"] == "shortcuts" && s["settled"] == true && isWritten(s, "Ctrl+Shift+Z");
    });
    (void)user.press("Escape");
    program.until("no list", [](const State& s) {
      return s["dialog"] == "none" && s["settled"] == true && !isWritten(s, "Ctrl+Shift+Z");
    });
    EXPECT_EQ(user.key("s")["tool"], "smooth");
    EXPECT_EQ(user.key("Escape")["tool"], "view");
  }

  FrameGate gate_{folder.file("gate")};
};

TEST_F(LockTest, a_dialog_asked_for_with_the_keyboard_of_the_panels_is_on_the_screen_and_is_left) {
  const auto program = startOpened();
  User user(display, *program, "lock");
  user.at({20, 740});
  inOneFrame({"key", "--delay", "0", "F6", "F1"});
  listIsLeftByEsc(user);
  inOneFrame({"key", "--delay", "0", "F1", "F6"});
  listIsLeftByEsc(user);
  // From the menu, with the keyboard in the panels: Esc takes it from both.
  (void)user.press("F6");
  user.tap("Help");
  program->until("the menu", [](const State& s) { return isWritten(s, "This list"); });
  user.tap("This list");
  listIsLeftByEsc(user);
  // A click on nothing that can be clicked on, when it comes.
  const State now = program->now();
  const int left = now["picture"][0].get<int>() + now["picture"][2].get<int>();
  for (const char* button : {"1", "3"}) {
    inOneFrame({"mousemove", std::to_string(left + 3), "760", "click", button, "key", "--delay", "0", "F1"});
    user.at({20, 740});
    listIsLeftByEsc(user);
  }
  const State report = quit(user);
  EXPECT_EQ(report["unsaved_changes"], false);
}

TEST_F(LockTest, what_comes_after_the_answer_in_a_frame_is_done_after_it) {
  const auto program = startOpened();
  User user(display, *program, "after");
  user.at({20, 740});
  (void)user.press("F1");
  program->until("a list", [](const State& s) { return s["dialog"] == "shortcuts" && s["settled"] == true; });
  inOneFrame({"key", "--delay", "0", "Escape", "m"});
  program->until("a tool", [](const State& s) { return s["dialog"] == "none" && s["tool"] == "mark"; });
  // A camera that is turned when a question comes is not turned by a hand that has let go.
  (void)user.key("Escape");
  user.at({330, 400});
  user.down(2);
  (void)user.press("F1");
  program->until("a list", [](const State& s) { return s["dialog"] == "shortcuts" && s["settled"] == true; });
  user.up(2);
  const State before = user.key("Escape");
  user.at({390, 460});
  EXPECT_EQ(user.rest()["view"], before["view"]);
  (void)quit(user);
}

// A frame with Ctrl in it takes no text: what is typed in a slow frame comes to the next one, in its order.
TEST_F(LockTest, what_is_typed_after_a_key_with_ctrl_in_one_frame_is_all_there) {
  const auto program = startOpened();
  User user(display, *program, "typed");
  user.at({20, 740});
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) {
    return s["dialog"] == "export" && s["settled"] == true && s["text_field"] == true;
  });
  const auto typed = [&](const std::string& path) {
    program->until(path, [&](const State& s) { return s["dialog_path"] == path; });
  };
  inOneFrame({"key", "--delay", "0", "ctrl+a", "type", "--delay", "0", "/tmp/see.tif"});
  typed("/tmp/see.tif");
  // Keys that are pressed again and again take a frame each; text does not wait for them.
  inOneFrame({"key", "--delay", "0", "End", "BackSpace", "BackSpace", "type", "--delay", "0", "eeeee"});
  inOneFrame({"key", "--delay", "0", "ctrl+a", "type", "--delay", "0", "/tmp/again.tif"});
  typed("/tmp/again.tif");
  (void)user.press("Escape");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  (void)quit(user);
}

// Keys that nothing in the panels waits for do not come to a dialog that opens after them.
TEST_F(LockTest, what_was_pressed_before_a_dialog_does_not_come_to_it) {
  const auto program = startOpened();
  User user(display, *program, "before a dialog");
  user.at({20, 740});
  for (const std::vector<std::string>& keys :
       {std::vector<std::string>{"Escape", "Escape", "Escape", "ctrl+e"},
        {"s", "Down", "Escape", "s", "Down", "Escape", "s", "Escape", "ctrl+e"}}) {
    std::vector<std::string> hands{"key", "--delay", "0"};
    hands.insert(hands.end(), keys.begin(), keys.end());
    inOneFrame(hands);
    program->until("where to", [](const State& s) {
      return s["dialog"] == "export" && s["settled"] == true && s["text_field"] == true;
    });
    EXPECT_EQ(program->now()["dialog_path"], program->now()["field_text"]);
    EXPECT_TRUE(program->now()["dialog_path"].get<std::string>().ends_with("part_fettled.tif"))
        << program->now()["dialog_path"];
    (void)user.key("ctrl+a");
    user.type("/tmp/see.tif");
    (void)user.press("Escape");
    program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  }
  (void)quit(user);
}

// In a slow frame a click acts where it was, wherever the cursor is when the frame begins; a second one that waits when a dialog
// comes does not act on what the dialog has there.
TEST_F(LockTest, a_click_acts_where_it_was_and_not_on_a_dialog_that_came_after_it) {
  const auto program = startOpened();
  User user(display, *program, "click");
  const auto middle = [&](const std::string& text) {
    const State now = program->now();
    for (const State& t : now["texts"])
      if (t["text"].get<std::string>().starts_with(text))
        return User::Place{t["at"][0].get<int>() + t["at"][2].get<int>() / 2,
                           t["at"][1].get<int>() + t["at"][3].get<int>() / 2};
    ADD_FAILURE() << text << " is not written in " << now["texts"].dump();
    return User::Place{};
  };
  const auto at = [](User::Place p) {
    return std::vector<std::string>{"mousemove", std::to_string(p.x), std::to_string(p.y)};
  };
  const auto then = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  user.at({20, 740});
  (void)user.rest();
  const User::Place smooth = middle("Smooth");
  inOneFrame(then(then(at(smooth), {"click", "1"}), at({20, 740})));
  program->until("the tool", [](const State& s) { return s["tool"] == "smooth" && s["settled"] == true; });
  const auto is_asked = [](const State& s) {
    return s["dialog"] == "export" && s["settled"] == true && s["text_field"] == true;
  };
  const auto leave = [&] {
    (void)user.press("Escape");
    program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  };
  (void)user.press("ctrl+e");
  program->until("where to", is_asked);
  const User::Place cancel = middle("Cancel");
  leave();
  inOneFrame(then({"key", "--delay", "0", "ctrl+e"}, then(at(cancel), {"click", "1"})));
  program->until("where to", is_asked);
  user.at({20, 740});
  EXPECT_EQ(user.rest()["dialog"], "export");
  leave();
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
