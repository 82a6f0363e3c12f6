#include "app/window/questions.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <imgui.h>
#include <imgui_internal.h>  // a popup by its number, at any level

#include "app/texts/texts.h"

namespace fettle::app {
namespace {

using Kind = Question::Kind;
using render::Key;

struct KindInfo {
  Kind kind;
  const char* name;
  const char* title;
  std::string_view
      letters;  // that answer it, in addition to Esc and (where there is something to confirm) Enter
  bool enter;
  bool of_field;  // about the open field
  ImGuiWindowFlags flags;
  Key other_key = Key::kNone;  // that answers it
};

constexpr std::array kKinds{
    KindInfo{Kind::kOpen, "open", textOf("Open a scan"), "", true, false, ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kImport, "import", textOf("Read a scan as"), "", true, false, ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kCompare, "compare", textOf("Compare with a scan"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kJoin, "join", textOf("Join with a scan"), "", true, true, ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kSaveAs, "save as", textOf("Save as"), "", true, true, ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kExport, "export", textOf("Export"), "", true, true, ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kOpenScene, "open scene", textOf("Open a scene"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kSaveScene, "save scene", textOf("Save the scene"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kUnsavedScene, "unsaved scene", textOf("Unsaved scene"), "N", true, true,
             ImGuiWindowFlags_AlwaysAutoResize, Key::kDelete},
    KindInfo{Kind::kExportSections, "export sections", textOf("Export sections"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kExportReport, "export report", textOf("Export a report"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kExportFits, "export fits", textOf("Export fits"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kExportFeatures, "export features", textOf("Export features"), "", true, true,
             ImGuiWindowFlags_NoResize},
    KindInfo{Kind::kUnsaved, "unsaved", textOf("Unsaved changes"), "N", true, true,
             ImGuiWindowFlags_AlwaysAutoResize, Key::kDelete},
    KindInfo{Kind::kReplace, "replace", textOf("Replace?"), "R", false, true,
             ImGuiWindowFlags_AlwaysAutoResize},
    KindInfo{Kind::kRecover, "recover", textOf("Unsaved work"), "S", true, false,
             ImGuiWindowFlags_AlwaysAutoResize},
    KindInfo{Kind::kDevice, "device", textOf("Set up the device"), "RMT123CU+-", true, true,
             ImGuiWindowFlags_AlwaysAutoResize},
    KindInfo{Kind::kShortcuts, "shortcuts", textOf("Shortcuts"), "", false, false, ImGuiWindowFlags_None},
    KindInfo{Kind::kMessage, "message", textOf("Fettle"), "", true, false, ImGuiWindowFlags_AlwaysAutoResize},
};

const KindInfo& infoOf(Kind kind) {
  return *std::find_if(kKinds.begin(), kKinds.end(), [&](const KindInfo& k) { return k.kind == kind; });
}

bool isMessage(const Question& question) {
  return question.kind == Kind::kMessage;
}

bool sameMessage(const Question& a, const Question& b) {
  return isMessage(a) && isMessage(b) && a.said.what == b.said.what && a.said.remedy == b.said.remedy;
}

}  // namespace

const char* name(Question::Kind kind) {
  return infoOf(kind).name;
}

const Question* Questions::shown() const {
  return shown_ && ImGui::IsPopupOpen(id_, ImGuiPopupFlags_AnyPopupLevel) ? &*shown_ : nullptr;
}

void Questions::ask(Question question) {
  asked_ = true;
  if (isMessage(question)) {
    const auto same = [&](const Question& other) { return sameMessage(other, question); };
    if ((shown_ && same(*shown_)) || std::any_of(waiting_.begin(), waiting_.end(), same)) return;
  } else {
    std::erase_if(waiting_, [](const Question& other) { return !isMessage(other); });
    if (shown_ && !isMessage(*shown_)) drop();
  }
  waiting_.push_back(std::move(question));
}

void Questions::dropOfField() {
  const auto of_field = [](const Question& question) { return infoOf(question.kind).of_field; };
  std::erase_if(waiting_, of_field);
  if (shown_ && of_field(*shown_)) drop();
}

// Called outside of its popup.
void Questions::drop() {
  const ImVector<ImGuiPopupData>& popups = ImGui::GetCurrentContext()->OpenPopupStack;
  for (int level = 0; level < popups.Size; ++level)
    if (popups[level].PopupId == id_) {
      ImGui::ClosePopupToLevel(level, true);
      break;
    }
  shown_.reset();
}

void Questions::press(const render::InputEvent& event) {
  const Question* const question = shown();
  if (question == nullptr || frames_ == 0 || event.modifiers.control || event.modifiers.alt) return;
  const KindInfo& info = infoOf(question->kind);
  const Key key = event.key == Key::kKeypadEnter ? Key::kEnter : event.key;
  const int code = static_cast<int>(key);
  const bool letter =
      code > 0 && code < 128 && info.letters.find(static_cast<char>(code)) != info.letters.npos;
  const bool other = key == info.other_key && key != Key::kNone;
  if (letter || other || key == Key::kEscape || (info.enter && key == Key::kEnter)) key_ = key;
}

Question* Questions::next() {
  if (shown_ && shown() == nullptr) {
    if (unseen()) waiting_.push_front(*std::move(shown_));
    shown_.reset();
  }
  if (!shown_) {
    key_ = Key::kNone;
    if (waiting_.empty()) {
      if (frames_without_ < kClosed) ++frames_without_;
      return nullptr;
    }
    shown_ = std::move(waiting_.front());
    waiting_.pop_front();
    frames_ = 0;
    const char* const title = labelOf(infoOf(shown_->kind).title);
    id_ = ImGui::GetID(title);
    ImGui::OpenPopup(title);
  }
  frames_without_ = 0;
  return &*shown_;
}

bool Questions::begin() {
  const KindInfo& info = infoOf(shown_->kind);
  const ImVec2 middle(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
  // What does not fit scrolls: a button that cannot be reached cannot be pressed.
  ImGui::SetNextWindowSizeConstraints(ImVec2(0.0F, 0.0F), ImGui::GetIO().DisplaySize);
  if (!ImGui::BeginPopupModal(labelOf(info.title), nullptr, info.flags)) {
    key_ = Key::kNone;  // there is no room for it on the screen, and input must not wait for that
    return false;
  }
  ++frames_;
  return true;
}

void Questions::end() {
  key_ = Key::kNone;
  ImGui::EndPopup();
}

bool Questions::take(Key key) {
  if (key_ != key) return false;
  key_ = Key::kNone;
  return true;
}

Question Questions::close() {
  Question answered = *std::exchange(shown_, std::nullopt);
  ImGui::CloseCurrentPopup();
  return answered;
}

void Feedback::dropPassed(std::chrono::steady_clock::time_point now) {
  for (Notice& notice : notices)
    if (notice.passes && !notice.seen) notice.seen = now;
  std::erase_if(notices, [&](const Notice& notice) { return notice.seen && now - *notice.seen >= kPassing; });
}

void Feedback::take(Notice notice) {
  const auto same = [&](const Notice& other) {
    return other.what == notice.what && other.remedy == notice.remedy;
  };
  if (std::ranges::any_of(notices, same) || std::ranges::any_of(said_once_, same)) return;
  if (notice.once) said_once_.push_back(notice);
  notices.push_back(std::move(notice));
}

void Feedback::dropOfField() {
  questions.dropOfField();
  std::erase_if(notices,
                [](const Notice& notice) { return notice.what.find(tr(kDeviceLost)) == std::string::npos; });
}

}  // namespace fettle::app
