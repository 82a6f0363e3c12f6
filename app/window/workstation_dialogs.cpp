#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/window/workstation.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

using Kind = Question::Kind;
using render::Key;

}  // namespace

// Hands have nothing else to do until it is answered.
void Workstation::ask(Question question) {
  letGo();
  questions_.ask(std::move(question));
  stale_ = true;
}

void Workstation::message(std::string what, std::string remedy) {
  ask({.kind = Kind::kMessage, .said = {std::move(what), std::move(remedy)}});
}

// A dialog has the keyboard to itself: ImGui closes it when the panels take it.
void Workstation::leavePanels() {
  enter_panels_ = false;
  window_->leavePanels();
}

void Workstation::pathDialog(Question& question) {
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0F);
  bool confirmed = ImGui::InputText("##path", &question.path,
                                    ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue);
  if (question.kind == Kind::kOpen) {
    // What lies where the path points to so far.
    std::error_code error;
    const fs::path typed(question.path);
    const fs::path folder = fs::is_directory(typed, error) ? typed : typed.parent_path();
    if (ImGui::BeginChild("files", ImVec2(0.0F, 260.0F * static_cast<float>(window_->scale())), true)) {
      std::vector<fs::path> entries;
      for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
           it.increment(error)) {
        if (it->path().filename().string().front() != '.') entries.push_back(it->path());
        if (entries.size() > 2000) break;
      }
      std::sort(entries.begin(), entries.end());
      if (ImGui::Selectable("..", false, ImGuiSelectableFlags_DontClosePopups))
        question.path = (folder.empty() ? fs::current_path(error) : folder).parent_path().string();
      for (const fs::path& entry : entries) {
        const bool is_folder = fs::is_directory(entry, error);
        const std::string label = entry.filename().string() + (is_folder ? "/" : "");
        if (ImGui::Selectable(label.c_str(), entry == typed, ImGuiSelectableFlags_DontClosePopups))
          question.path = entry.string();
      }
    }
    ImGui::EndChild();
  } else {
    std::error_code error;
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextDisabled(
        "%s",
        question.kind == Kind::kSaveAs
            ? "NAME.fettle keeps everything, each step as it is made. Other formats, by extension "
              ".tif .asc .xyz .ply .stl .x3p .exr .png, keep the field, with its marks beside it as "
              "NAME_marks.png"
            : "format by extension: .tif .asc .xyz .ply .stl .x3p .exr .png .fettle; marks go beside it as "
              "NAME_marks.png");
    ImGui::PopTextWrapPos();
    if (question.kind == Kind::kSaveAs && isSessionPath(question.path))
      ImGui::Checkbox("put the scan itself into the session", &embeds_);
    if (fs::exists(question.path, error))
      ImGui::TextColored(ImVec4(1.0F, 0.7F, 0.2F, 1.0F), "there is such a file already");
  }
  confirmed = ImGui::Button(question.kind == Kind::kOpen ? "Open" : "Write") ||
              questions_.take(Key::kEnter) || confirmed;
  ImGui::SameLine();
  const bool left = ImGui::Button("Cancel") || questions_.take(Key::kEscape);
  if (confirmed && !question.path.empty()) {
    const Question answered = questions_.close();
    if (answered.kind == Kind::kOpen)
      askToOpen(answered.path);
    else
      askToWrite(answered, Typed::kYes);
  } else if (left) {
    (void)questions_.close();
  }
}

void Workstation::unsavedDialog(Question& question) {
  ImGui::Text("%s was changed and is not saved.", fs::path(path_).filename().string().c_str());
  const bool writes = ImGui::Button("Save (Enter)") || questions_.take(Key::kEnter);
  ImGui::SameLine();
  const bool drops = ImGui::Button("Discard (D)") || questions_.take(render::letter('D'));
  ImGui::SameLine();
  const bool stays = ImGui::Button("Go back (Esc)") || questions_.take(Key::kEscape);
  if (question.afterwards.what == Afterwards::What::kQuit) {
    ImGui::Checkbox("Do not ask again (N)", &question.stop_asking);
    if (questions_.take(render::letter('N'))) question.stop_asking = !question.stop_asking;
    ImGui::TextDisabled(
        "Unsaved work is then kept at the end, and offered when the scan is opened again.\n"
        "The File menu and the Display panel turn the question on again.");
  }
  if (!writes && !drops && !stays) return;
  const Question answered = questions_.close();
  if (stays) return;  // who goes back decided nothing
  if (answered.stop_asking) settings_.ask_before_quitting = false;
  if (writes)
    save(answered.afterwards);
  else
    goOn(answered.afterwards);
}

void Workstation::recoverDialog(const Question& question) {
  ImGui::Text("Work on %s was not saved when the program ended.", fs::path(question.path).filename().c_str());
  const bool takes = ImGui::Button("Go on with it (Enter)") || questions_.take(Key::kEnter);
  ImGui::SameLine();
  const bool leaves = ImGui::Button("Start from the scan (S)") || questions_.take(render::letter('S'));
  ImGui::SameLine();
  const bool stays = ImGui::Button("Go back (Esc)") || questions_.take(Key::kEscape);
  ImGui::TextDisabled("Starting from the scan, the first new step takes the place of that work.");
  if (!takes && !leaves && !stays) return;
  const Question answered = questions_.close();
  if (!stays) load(answered.path, takes ? Recovery::kTake : Recovery::kLeave);
}

void Workstation::shortcutsDialog() {
  std::string_view section;
  for (const Shortcut& s : shortcuts()) {
    if (s.section != section) {
      section = s.section;
      ImGui::Separator();
      ImGui::TextUnformatted(section.data(), section.data() + section.size());
    }
    std::string keys = keyText(s.key, s.modifiers);
    if (s.other_key != Key::kNone) keys += " or " + keyText(s.other_key, s.modifiers);
    ImGui::Text("  %-24s", keys.c_str());
    ImGui::SameLine(220.0F * static_cast<float>(window_->scale()));
    ImGui::TextUnformatted(s.name.data(), s.name.data() + s.name.size());
  }
  ImGui::Separator();
  ImGui::TextUnformatted(
      "  Ctrl+1 .. Ctrl+9         recent files\n"
      "  left button              the stylus, while a tool is on; the wheel then sets how deep it "
      "presses\n"
      "  middle, right button     turn, move the view (Shift, Ctrl: see View > Mouse); wheel: zoom\n"
      "  Alt + left button        turn the view");
  if (ImGui::Button("Close") || questions_.take(Key::kEscape)) (void)questions_.close();
}

void Workstation::messageDialog(const Question& question) {
  ImGui::PushTextWrapPos(600.0F * static_cast<float>(window_->scale()));
  ImGui::TextUnformatted(question.said.what.c_str());
  if (!question.said.remedy.empty()) ImGui::TextDisabled("%s", question.said.remedy.c_str());
  ImGui::PopTextWrapPos();
  if (ImGui::Button("OK") || questions_.take(Key::kEscape) || questions_.take(Key::kEnter))
    (void)questions_.close();
}

// Enter does not replace: it has just confirmed the path.
void Workstation::replaceDialog(const Question& question) {
  ImGui::PushTextWrapPos(600.0F * static_cast<float>(window_->scale()));
  for (const std::string& text : question.replaced) ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  const bool replaces = ImGui::Button("Replace (R)") || questions_.take(render::letter('R'));
  ImGui::SameLine();
  const bool stays = ImGui::Button("Go back (Esc)") || questions_.take(Key::kEscape);
  if (!replaces && !stays) return;
  Question answered = questions_.close();
  if (replaces) {
    startSaving(answered.path, keepingOf(answered.from), answered.afterwards);
  } else if (answered.typed) {
    ask({.kind = answered.from, .path = answered.path, .afterwards = answered.afterwards});
  }
}

void Workstation::dialogs() {
  if (questions_.pending()) leavePanels();
  Question* const question = questions_.next();
  if (question == nullptr) return;
  question_frame_ = frames_;
  stale_ = true;
  const bool path =
      question->kind == Kind::kOpen || question->kind == Kind::kSaveAs || question->kind == Kind::kExport;
  if (path) ImGui::SetNextWindowSize(ImVec2(640.0F * static_cast<float>(window_->scale()), 0.0F));
  if (question->kind == Kind::kShortcuts)
    ImGui::SetNextWindowSize(ImVec2(0.0F, 0.8F * ImGui::GetIO().DisplaySize.y));
  if (!questions_.begin()) return;
  switch (question->kind) {
    case Kind::kOpen:
    case Kind::kSaveAs:
    case Kind::kExport:
      pathDialog(*question);
      break;
    case Kind::kUnsaved:
      unsavedDialog(*question);
      break;
    case Kind::kReplace:
      replaceDialog(*question);
      break;
    case Kind::kRecover:
      recoverDialog(*question);
      break;
    case Kind::kShortcuts:
      shortcutsDialog();
      break;
    case Kind::kMessage:
      messageDialog(*question);
      break;
  }
  questions_.end();
}

}  // namespace fettle::app
