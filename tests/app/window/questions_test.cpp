#include "app/window/questions.h"

#include <functional>
#include <optional>

#include <gtest/gtest.h>
#include <imgui.h>

#include "render/plan/font_data.h"

namespace fettle::app {
namespace {

using Kind = Question::Kind;
using render::Key;

// ImGui without a window, and frames in which a panel is laid out before the dialog, as the window does it.
class QuestionsTest : public testing::Test {
 protected:
  QuestionsTest() {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = ImVec2(800.0F, 600.0F);
    io.DeltaTime = 0.02F;
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    io.KeyMap[ImGuiKey_Space] = 0;  // which that asks for
    ImFontConfig font;
    font.FontDataOwnedByAtlas = false;
    const std::span<const std::uint8_t> regular = render::regularFont();
    io.Fonts->AddFontFromMemoryTTF(const_cast<std::uint8_t*>(regular.data()),
                                   static_cast<int>(regular.size()), 15.0F, &font);
    unsigned char* pixels = nullptr;
    io.Fonts->GetTexDataAsAlpha8(&pixels, nullptr, nullptr);
  }
  ~QuestionsTest() override { ImGui::DestroyContext(); }

  void frame(const std::function<void()>& in_panel = {}) {
    ImGui::NewFrame();
    ImGui::SetNextWindowPos(ImVec2(500.0F, 0.0F));
    ImGui::SetNextWindowSize(ImVec2(300.0F, 600.0F));
    ImGui::Begin("Panels", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBringToFrontOnFocus);
    if (in_panel) in_panel();
    ImGui::Button("Undo");
    ImGui::End();
    laid_out_.reset();
    if (const Question* const question = questions_.next(); question != nullptr && questions_.begin()) {
      laid_out_ = question->kind;
      ImGui::Button("OK");
      if (questions_.take(Key::kEscape)) answered_ = questions_.close();
      questions_.end();
    }
    ImGui::Render();
  }
  void frames(int count) {
    for (int i = 0; i < count; ++i) frame();
  }
  void press(Key key) {
    render::InputEvent event;
    event.kind = render::InputKind::kKeyDown;
    event.key = key;
    questions_.press(event);
  }
  [[nodiscard]] std::optional<Kind> shown() const {
    const Question* const question = questions_.shown();
    return question != nullptr ? std::optional(question->kind) : std::nullopt;
  }

  Questions questions_;
  std::optional<Kind> laid_out_;      // in the last frame
  std::optional<Question> answered_;  // by Esc
};

Question message(const char* what) {
  Question question;
  question.said.what = what;
  return question;
}
Question of(Kind kind) {
  Question question;
  question.kind = kind;
  return question;
}

TEST_F(QuestionsTest, a_dialog_is_put_up_though_the_panels_take_the_keyboard_in_the_same_frame) {
  frames(3);
  questions_.ask(of(Kind::kShortcuts));
  EXPECT_TRUE(questions_.pending());
  frame([] {
    ImGui::SetWindowFocus();
    ImGui::SetKeyboardFocusHere();
  });
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(questions_.pending()) << i;
    frame();
    EXPECT_EQ(laid_out_, Kind::kShortcuts) << i;
  }
  EXPECT_EQ(shown(), Kind::kShortcuts);
  press(Key::kEscape);
  frame();
  ASSERT_TRUE(answered_);
  EXPECT_EQ(answered_->kind, Kind::kShortcuts);
  EXPECT_FALSE(questions_.pending());
  frames(2);
  EXPECT_EQ(laid_out_, std::nullopt);
}

TEST_F(QuestionsTest, a_dialog_that_was_seen_and_that_imgui_closed_is_none) {
  questions_.ask(of(Kind::kUnsaved));
  frames(3);
  EXPECT_EQ(shown(), Kind::kUnsaved);
  ImGui::SetWindowFocus(nullptr);  // the keyboard goes elsewhere
  EXPECT_EQ(shown(), std::nullopt);
  EXPECT_FALSE(questions_.pending());
  press(Key::kEscape);
  EXPECT_FALSE(questions_.answering());
  frames(2);
  EXPECT_EQ(laid_out_, std::nullopt);
  EXPECT_FALSE(answered_);
  // The next one is as the first.
  questions_.ask(of(Kind::kOpen));
  frames(3);
  EXPECT_EQ(shown(), Kind::kOpen);
}

TEST_F(QuestionsTest, two_in_one_frame_are_one_after_the_other_or_the_later_one_alone) {
  // Of what the user asks for the later one is meant; what the program says is not lost.
  questions_.ask(message("first"));
  questions_.ask(of(Kind::kShortcuts));
  questions_.ask(message("second"));
  questions_.ask(message("first"));
  Question open = of(Kind::kUnsaved);
  open.afterwards = {Afterwards::What::kOpen, "next.tif"};
  questions_.ask(open);
  std::vector<std::string> seen;
  for (int i = 0; i < 5 && questions_.pending(); ++i) {
    frames(3);
    const Question* const question = questions_.shown();
    ASSERT_NE(question, nullptr) << i;
    seen.push_back(question->kind == Kind::kMessage ? question->said.what : name(question->kind));
    press(Key::kEscape);
    frame();
  }
  EXPECT_EQ(seen, (std::vector<std::string>{"first", "second", "unsaved"}));
  EXPECT_EQ(answered_->afterwards.path, "next.tif");

  // On the screen already, it makes room for what is asked for next; a message does not.
  questions_.ask(of(Kind::kSaveAs));
  frames(3);
  questions_.ask(of(Kind::kUnsaved));
  frames(3);
  EXPECT_EQ(shown(), Kind::kUnsaved);
  questions_.ask(message("third"));
  frames(3);
  EXPECT_EQ(shown(), Kind::kUnsaved);
  press(Key::kEscape);
  frames(3);
  EXPECT_EQ(shown(), Kind::kMessage);
  questions_.ask(of(Kind::kOpen));
  frames(3);
  EXPECT_EQ(shown(), Kind::kMessage);
}

TEST_F(QuestionsTest, a_key_answers_only_what_was_on_the_screen_when_it_was_pressed) {
  questions_.ask(of(Kind::kUnsaved));
  press(Key::kEscape);
  EXPECT_FALSE(questions_.answering());
  frames(2);
  EXPECT_EQ(shown(), Kind::kUnsaved);
  // Keys that mean nothing to it, and those with Ctrl, are no answer.
  for (const Key key : {render::letter('X'), Key::kF1, Key::kPageUp}) press(key);
  render::InputEvent event;
  event.key = render::letter('D');
  event.modifiers.control = true;
  questions_.press(event);
  EXPECT_FALSE(questions_.answering());
  press(Key::kKeypadEnter);
  EXPECT_TRUE(questions_.answering());
  frame();
  EXPECT_FALSE(questions_.answering()) << "a key is there for one frame";
}

TEST_F(QuestionsTest, what_was_asked_about_a_field_goes_with_it) {
  questions_.ask(message("stays"));
  questions_.ask(of(Kind::kExport));
  questions_.dropOfField();
  frames(3);
  EXPECT_EQ(shown(), Kind::kMessage);
  press(Key::kEscape);
  frames(3);
  EXPECT_FALSE(questions_.pending());
  questions_.ask(of(Kind::kSaveAs));
  frames(3);
  questions_.dropOfField();
  EXPECT_FALSE(questions_.pending());
  EXPECT_FALSE(ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel));
  frames(2);
  EXPECT_EQ(laid_out_, std::nullopt);
}

TEST(FeedbackTest, a_notice_that_asks_for_nothing_goes_by_itself_once_it_was_seen_long_enough) {
  using namespace std::chrono_literals;
  Feedback feedback;
  feedback.notices.push_back({"as you said", "", "", 1, true, true});
  feedback.notices.push_back({"the unit is guessed", ""});
  const std::chrono::steady_clock::time_point start{100s};
  feedback.dropPassed(start);
  // One that comes later goes later.
  feedback.dropPassed(start + 5s);
  feedback.notices.push_back({"later", "", "", 1, false, true});
  feedback.dropPassed(start + 6s);
  feedback.dropPassed(start + Feedback::kPassing - 1ms);
  EXPECT_EQ(feedback.notices.size(), 3U);
  feedback.dropPassed(start + Feedback::kPassing);
  ASSERT_EQ(feedback.notices.size(), 2U);
  EXPECT_EQ(feedback.notices.back().what, "later");
  feedback.dropPassed(start + 6s + Feedback::kPassing);
  ASSERT_EQ(feedback.notices.size(), 1U);
  EXPECT_EQ(feedback.notices.front().what, "the unit is guessed") << "until it is understood";
}

TEST(FeedbackTest, what_stands_there_is_not_said_again_and_what_stays_as_it_is_once) {
  Feedback feedback;
  const Notice fault{"fault", "arm again"}, rights{.what = "not granted", .remedy = "memory", .once = true};
  for (int i = 0; i < 3; ++i) {
    feedback.take(fault);
    feedback.take(rights);
  }
  EXPECT_EQ(feedback.notices.size(), 2U);
  feedback.notices.clear();
  feedback.take(fault);
  feedback.take(rights);
  feedback.take({.what = "not granted", .remedy = "priority", .once = true});
  ASSERT_EQ(feedback.notices.size(), 2U);
  EXPECT_EQ(feedback.notices[0].what, "fault") << "it happened again";
  EXPECT_EQ(feedback.notices[1].remedy, "priority");
}

}  // namespace
}  // namespace fettle::app
