#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/dialog_button.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

using Choice = Answer::Choice;
using Kind = Question::Kind;
using render::Key;

bool isPathKind(Kind kind) {
  return kind == Kind::kOpen || kind == Kind::kCompare || kind == Kind::kSaveAs || kind == Kind::kExport;
}

std::optional<Choice> unsavedDialog(Question& question, Questions& questions, const std::string& document) {
  ImGui::Text("%s was changed and is not saved.", document.c_str());
  const bool writes = dialogButton("Save (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool drops = dialogButton("Discard (D)", questions, render::letter('D'));
  ImGui::SameLine();
  const bool stays = dialogButton("Go back (Esc)", questions, Key::kEscape);
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
  const bool takes = dialogButton("Continue it (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool leaves = dialogButton("Start from the scan (S)", questions, render::letter('S'));
  ImGui::SameLine();
  const bool stays = dialogButton("Go back (Esc)", questions, Key::kEscape);
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
  return dialogButton("Close", questions, Key::kEscape) ? std::optional(Choice::kBack) : std::nullopt;
}

std::optional<Choice> messageDialog(const Question& question, Questions& questions, float scale) {
  ImGui::PushTextWrapPos(600.0F * scale);
  ImGui::TextUnformatted(question.said.what.c_str());
  if (!question.said.remedy.empty()) ImGui::TextDisabled("%s", question.said.remedy.c_str());
  ImGui::PopTextWrapPos();
  const bool read = dialogButton("OK", questions, Key::kEscape) || questions.take(Key::kEnter);
  return read ? std::optional(Choice::kBack) : std::nullopt;
}

// Enter does not replace: it has just confirmed the path.
std::optional<Choice> replaceDialog(const Question& question, Questions& questions, float scale) {
  ImGui::PushTextWrapPos(600.0F * scale);
  for (const std::string& text : question.replaced) ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  const bool replaces = dialogButton("Replace (R)", questions, render::letter('R'));
  ImGui::SameLine();
  const bool stays = dialogButton("Go back (Esc)", questions, Key::kEscape);
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
      return fileDialog(question, parts);
    case Kind::kImport:
      return importPage(question, parts);
    case Kind::kUnsaved:
      return unsavedDialog(question, questions, parts.document.fileName());
    case Kind::kReplace:
      return replaceDialog(question, questions, scale);
    case Kind::kRecover:
      return recoverDialog(question, questions);
    case Kind::kDevice:
      return devicePage(parts);
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
    ImGui::SetNextWindowSize(ImVec2(900.0F * static_cast<float>(parts.window.scale()), 0.0F));
  if (question->kind == Kind::kImport)
    ImGui::SetNextWindowSize(ImVec2(740.0F * static_cast<float>(parts.window.scale()), 0.0F));
  if (question->kind == Kind::kShortcuts)
    ImGui::SetNextWindowSize(ImVec2(0.0F, 0.8F * ImGui::GetIO().DisplaySize.y));
  if (!questions.begin()) return std::nullopt;
  std::optional<Answer> answer;
  if (const auto choice = layOut(*question, parts)) answer = Answer{*choice, questions.close()};
  questions.end();
  return answer;
}

}  // namespace fettle::app
