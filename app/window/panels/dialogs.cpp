#include <algorithm>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/window/panels/panels.h"
#include "engine/formats/formats.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

using Choice = Answer::Choice;
using Kind = Question::Kind;
using render::Key;

// A button with a key.
bool button(const char* name, Questions& questions, Key key) {
  return ImGui::Button(name) || questions.take(key);
}

bool isPathKind(Kind kind) {
  return kind == Kind::kOpen || kind == Kind::kCompare || kind == Kind::kSaveAs || kind == Kind::kExport;
}

// The files in the folder of the path typed so far.
void fileList(std::string& path, float scale) {
  std::error_code error;
  const fs::path typed(path);
  const fs::path folder = fs::is_directory(typed, error) ? typed : typed.parent_path();
  if (ImGui::BeginChild("files", ImVec2(0.0F, 260.0F * scale), true)) {
    std::vector<fs::path> entries;
    for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
         it.increment(error)) {
      if (it->path().filename().string().front() != '.') entries.push_back(it->path());
      if (entries.size() > 2000) break;
    }
    std::sort(entries.begin(), entries.end());
    if (ImGui::Selectable("..", false, ImGuiSelectableFlags_DontClosePopups))
      path = (folder.empty() ? fs::current_path(error) : folder).parent_path().string();
    for (const fs::path& entry : entries) {
      const bool is_folder = fs::is_directory(entry, error);
      const std::string label = entry.filename().string() + (is_folder ? "/" : "");
      if (ImGui::Selectable(label.c_str(), entry == typed, ImGuiSelectableFlags_DontClosePopups))
        path = entry.string();
    }
  }
  ImGui::EndChild();
}

// " .tif .png ...": the usual extension of each format that can be written, sessions left out.
std::string writtenExtensions() {
  std::string all;
  for (const engine::FormatInfo& format : engine::formats()) {
    const std::string extension(format.extensions.front());
    if (format.writes && !isSessionPath("NAME" + extension)) all += " " + extension;
  }
  return all;
}

void formatHelp(const Question& question, bool& embeds) {
  ImGui::PushTextWrapPos(0.0F);
  const std::string text =
      question.kind == Kind::kSaveAs
          ? fmt::format(
                "NAME.fettle keeps everything, each step as it is made. Other formats, by extension{}, "
                "store the field, with marks and lines next to it as NAME_marks.png and NAME_lines.csv",
                writtenExtensions())
          : fmt::format("format by extension:{} .fettle; marks and lines are written next to it",
                        writtenExtensions());
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::PopTextWrapPos();
  if (question.kind == Kind::kSaveAs && isSessionPath(question.path))
    ImGui::Checkbox("store the scan in the session", &embeds);
  std::error_code error;
  if (fs::exists(question.path, error))
    ImGui::TextColored(ImVec4(1.0F, 0.7F, 0.2F, 1.0F), "this file exists already");
}

std::optional<Choice> pathDialog(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0F);
  bool confirmed = ImGui::InputText("##path", &question.path,
                                    ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue);
  const bool reads = question.kind == Kind::kOpen || question.kind == Kind::kCompare;
  if (reads)
    fileList(question.path, static_cast<float>(parts.window.scale()));
  else
    formatHelp(question, parts.saving.embeds);
  confirmed = button(reads ? "Open" : "Write", questions, Key::kEnter) || confirmed;
  ImGui::SameLine();
  const bool left = button("Cancel", questions, Key::kEscape);
  if (confirmed && !question.path.empty()) return Choice::kConfirm;
  return left ? std::optional(Choice::kBack) : std::nullopt;
}

std::optional<Choice> unsavedDialog(Question& question, Questions& questions, const std::string& document) {
  ImGui::Text("%s was changed and is not saved.", document.c_str());
  const bool writes = button("Save (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool drops = button("Discard (D)", questions, render::letter('D'));
  ImGui::SameLine();
  const bool stays = button("Go back (Esc)", questions, Key::kEscape);
  if (question.afterwards.what == Afterwards::What::kQuit) {
    ImGui::Checkbox("Do not ask again (N)", &question.stop_asking);
    if (questions.take(render::letter('N'))) question.stop_asking = !question.stop_asking;
    ImGui::TextDisabled(
        "Unsaved work is then stored at the end, and offered when the scan is opened again.\n"
        "The File menu and the Display panel turn the question on again.");
  }
  if (stays) return Choice::kBack;
  if (writes) return Choice::kConfirm;
  return drops ? std::optional(Choice::kOther) : std::nullopt;
}

std::optional<Choice> recoverDialog(const Question& question, Questions& questions) {
  ImGui::Text("Work on %s was not saved when the program ended.", fs::path(question.path).filename().c_str());
  const bool takes = button("Continue it (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool leaves = button("Start from the scan (S)", questions, render::letter('S'));
  ImGui::SameLine();
  const bool stays = button("Go back (Esc)", questions, Key::kEscape);
  ImGui::TextDisabled("Starting from the scan, the first new step replaces that work.");
  if (stays) return Choice::kBack;
  if (takes) return Choice::kConfirm;
  return leaves ? std::optional(Choice::kOther) : std::nullopt;
}

std::optional<Choice> shortcutsDialog(Questions& questions, float scale) {
  std::string_view section;
  for (const ActionRow& row : actions()) {
    if (row.section != section) {
      section = row.section;
      ImGui::Separator();
      ImGui::TextUnformatted(section.data(), section.data() + section.size());
    }
    std::string keys = keyText(row.key, row.modifiers);
    if (row.other_key != Key::kNone) keys += " or " + keyText(row.other_key, row.modifiers);
    ImGui::Text("  %-24s", keys.c_str());
    ImGui::SameLine(220.0F * scale);
    ImGui::TextUnformatted(row.name.data(), row.name.data() + row.name.size());
  }
  ImGui::Separator();
  ImGui::TextUnformatted(
      "  Ctrl+1 .. Ctrl+9         recent files\n"
      "  left button              the stylus, while a tool is on; the wheel then sets how deep it presses\n"
      "  middle, right button     turn, move the view (Shift, Ctrl: see View > Mouse); wheel: zoom\n"
      "  Alt + left button        turn the view\n"
      "  Ctrl + Shift + left      drag an edge line; a click chooses one where no tool is on");
  return button("Close", questions, Key::kEscape) ? std::optional(Choice::kBack) : std::nullopt;
}

std::optional<Choice> messageDialog(const Question& question, Questions& questions, float scale) {
  ImGui::PushTextWrapPos(600.0F * scale);
  ImGui::TextUnformatted(question.said.what.c_str());
  if (!question.said.remedy.empty()) ImGui::TextDisabled("%s", question.said.remedy.c_str());
  ImGui::PopTextWrapPos();
  const bool read = button("OK", questions, Key::kEscape) || questions.take(Key::kEnter);
  return read ? std::optional(Choice::kBack) : std::nullopt;
}

// Enter does not replace: it has just confirmed the path.
std::optional<Choice> replaceDialog(const Question& question, Questions& questions, float scale) {
  ImGui::PushTextWrapPos(600.0F * scale);
  for (const std::string& text : question.replaced) ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  const bool replaces = button("Replace (R)", questions, render::letter('R'));
  ImGui::SameLine();
  const bool stays = button("Go back (Esc)", questions, Key::kEscape);
  if (replaces) return Choice::kConfirm;
  return stays ? std::optional(Choice::kBack) : std::nullopt;
}

std::optional<Choice> layOut(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  const auto scale = static_cast<float>(parts.window.scale());
  switch (question.kind) {
    case Kind::kOpen:
    case Kind::kCompare:
    case Kind::kSaveAs:
    case Kind::kExport:
      return pathDialog(question, parts);
    case Kind::kUnsaved:
      return unsavedDialog(question, questions, parts.document.fileName());
    case Kind::kReplace:
      return replaceDialog(question, questions, scale);
    case Kind::kRecover:
      return recoverDialog(question, questions);
    case Kind::kShortcuts:
      return shortcutsDialog(questions, scale);
    case Kind::kMessage:
      break;
  }
  return messageDialog(question, questions, scale);
}

}  // namespace

std::optional<Answer> dialog(Parts& parts) {
  Questions& questions = parts.feedback.questions;
  if (questions.pending()) parts.leavePanels();
  Question* const question = questions.next();
  if (question == nullptr) return std::nullopt;
  parts.picture.requestRedraw();
  if (isPathKind(question->kind))
    ImGui::SetNextWindowSize(ImVec2(640.0F * static_cast<float>(parts.window.scale()), 0.0F));
  if (question->kind == Kind::kShortcuts)
    ImGui::SetNextWindowSize(ImVec2(0.0F, 0.8F * ImGui::GetIO().DisplaySize.y));
  if (!questions.begin()) return std::nullopt;
  std::optional<Answer> answer;
  if (const auto choice = layOut(*question, parts)) answer = Answer{*choice, questions.close()};
  questions.end();
  return answer;
}

}  // namespace fettle::app
