#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/texts/texts.h"
#include "app/window/action_tips.h"
#include "app/window/panels/dialog_button.h"
#include "app/window/panels/panels.h"
#include "app/window/result_files.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

using Choice = Answer::Choice;
using Kind = Question::Kind;
using render::Key;

bool isPathKind(Kind kind) {
  return kind == Kind::kOpen || kind == Kind::kCompare || kind == Kind::kJoin || kind == Kind::kSaveAs ||
         kind == Kind::kExport || kind == Kind::kOpenScene || kind == Kind::kSaveScene ||
         resultFileOf(kind) != nullptr;
}

// A dialog that has just appeared goes aside where the cursor, left where it was, would lie on the last button.
void goFromUnderCursor(const Questions& questions) {
  constexpr int kSettled = 3;  // frames
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  if (questions.frames() > kSettled || !ImGui::IsMouseHoveringRect(low, high, false)) return;
  const ImVec2 at = ImGui::GetWindowPos();
  ImGui::SetWindowPos(ImVec2(at.x, at.y - 3.0F * (high.y - low.y)));
}

// What Enter does: the scan itself is never written over.
std::string saveLabel(const Parts& parts) {
  const SessionKeeper& keeper = *parts.document.keeper();
  const std::string path = keeper.named() ? keeper.path() : parts.saving.path();
  return path.empty() ? textOf("Save session ... (Enter)")
                      : trFormat("Save to {} (Enter)", fs::path(path).filename().string());
}

void stopAskingTick(Question& question, Questions& questions) {
  ImGui::Checkbox(labelOf("Do not ask again (N)"), &question.stop_asking);
  if (questions.take(render::letter('N'))) question.stop_asking = !question.stop_asking;
}

// Discarding has a key that does nothing to the picture, and no letter.
std::optional<Choice> unsavedDialog(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  ImGui::TextUnformatted(
      trFormat("{} was changed, and no session keeps the steps.", parts.document.fileName()).c_str());
  if (const std::string exported = parts.saving.exportText(parts.document); !exported.empty())
    ImGui::TextUnformatted(exported.c_str());
  const bool writes = dialogButton(saveLabel(parts).c_str(), questions, Key::kEnter);
  ImGui::SameLine();
  const bool stays = dialogButton("Go back (Esc)", questions, Key::kEscape);
  ImGui::SameLine(0.0F, 3.0F * ImGui::GetFontSize());
  const bool drops = dialogButton("Discard the steps (Delete)", questions, Key::kDelete);
  goFromUnderCursor(questions);
  if (question.afterwards.what == Afterwards::What::kQuit) {
    stopAskingTick(question, questions);
    ImGui::TextDisabled(
        "%s", tr("Unsaved work is then stored at the end, and offered when the scan is opened again.\n"
                 "The File menu and the Display panel turn the question on again."));
  }
  if (stays) return Choice::kBack;
  if (writes) return Choice::kConfirm;
  return drops ? std::optional(Choice::kOther) : std::nullopt;
}

std::optional<Choice> unsavedSceneDialog(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  const std::string& path = parts.scene_files.path();
  ImGui::TextUnformatted(path.empty()
                             ? tr("Effects or numbers of the scene were changed, and no file has them.")
                             : trFormat("Effects or numbers of the scene were changed, and {} has others.",
                                        fs::path(path).filename().string())
                                   .c_str());
  const bool writes = dialogButton("Save scene ... (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool stays = dialogButton("Go back (Esc)", questions, Key::kEscape);
  ImGui::SameLine(0.0F, 3.0F * ImGui::GetFontSize());
  const bool drops = dialogButton("Leave it (Delete)", questions, Key::kDelete);
  goFromUnderCursor(questions);
  stopAskingTick(question, questions);
  ImGui::TextDisabled(
      "%s", tr("A session has the scene with the work on its scan, whether it is saved here or not."));
  if (stays) return Choice::kBack;
  if (writes) return Choice::kConfirm;
  return drops ? std::optional(Choice::kOther) : std::nullopt;
}

std::optional<Choice> recoverDialog(const Question& question, Questions& questions) {
  ImGui::TextUnformatted(trFormat("Work on {} was not saved when the program ended.",
                                  fs::path(question.path).filename().string())
                             .c_str());
  const bool takes = dialogButton("Continue it (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool leaves = dialogButton("Start from the scan (S)", questions, render::letter('S'));
  ImGui::SameLine();
  const bool stays = dialogButton("Go back (Esc)", questions, Key::kEscape);
  ImGui::TextDisabled("%s", tr("Starting from the scan, the first new step replaces that work."));
  if (stays) return Choice::kBack;
  if (takes) return Choice::kConfirm;
  return leaves ? std::optional(Choice::kOther) : std::nullopt;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

std::string keysOf(Action action) {
  const ActionRow& row = rowOf(action);
  return keyText(row.key, row.modifiers);
}

// What a person does who has a scan and wants a clean one, with the keys as they are.
void howToClean() {
  using enum Action;
  const auto tool = [](haptic::Tool t) { return keysOf(actionOf(t)); };
  ImGui::TextUnformatted(tr("How to clean a scan"));
  for (const std::string& line :
       {trFormat("1. {} opens it, or drop it on the window; say its unit, and which number means a hole.",
                 keysOf(kOpen)),
        trFormat("2. Drag and wheel turn and zoom it; {} shows all of it.", keysOf(kViewAll)),
        trFormat("3. {} suggests edges to keep and {} takes them; or {} and draw along one.", keysOf(kEdges),
                 keysOf(kFilterApply), tool(haptic::Tool::kMark)),
        trFormat("4. {} suggests filters, or choose one at the right: {} previews it, {} applies it;",
                 keysOf(kFilterSuggest), keysOf(kFilterPreview), keysOf(kFilterApply)),
        trFormat("   {} smooths by hand.", tool(haptic::Tool::kSmooth)),
        trFormat("5. Look at what changed: {} colours it, {} held shows the scan before; {} takes it back.",
                 keysOf(kDeviation), keysOf(kShowBefore), keysOf(kUndo)),
        trFormat("6. {} exports the part; {} keeps every step in a session.", keysOf(kExport),
                 keysOf(kSave))})
    writeWrapped("  " + line);
  writeWrapped("Screen readers cannot read this window; every function is on the command line, too.");
}

// A line of the list of keys that does what it says when it is chosen, by a click, by Space where the keyboard is on it, or by
// Enter in the search, which takes the first one that can be done. True when it was.
class ChoosableLines {
 public:
  enum class Can : std::uint8_t { kNow, kNotNow, kByItsKeyAlone };
  explicit ChoosableLines(bool takes_first) : takes_first_(takes_first) {}
  // `keys`: of an action, in a column of their own `column` wide [pixels].
  [[nodiscard]] bool line(const std::string& keys, float column, const std::string& text, Can can) {
    ImGui::PushID(count_++);
    const std::string lines = inLines(text, ImGui::GetContentRegionAvail().x - column);
    const ImVec2 corner = ImGui::GetCursorPos();
    const ImVec2 size(0.0F, ImGui::CalcTextSize(lines.c_str()).y);
    ImGui::BeginDisabled(can == Can::kNotNow);
    bool chosen = false;
    if (can == Can::kByItsKeyAlone)
      ImGui::Dummy(size);
    else
      chosen = ImGui::Selectable("##line", false, ImGuiSelectableFlags_DontClosePopups, size);
    const ImVec2 below = ImGui::GetCursorPos();
    if (!keys.empty()) {
      ImGui::SetCursorPos(corner);
      ImGui::TextUnformatted(keys.c_str());
    }
    ImGui::SetCursorPos(ImVec2(corner.x + column, corner.y));
    ImGui::TextUnformatted(lines.c_str());
    ImGui::SetCursorPos(below);
    ImGui::EndDisabled();
    ImGui::PopID();
    if (can == Can::kNow) chosen = std::exchange(takes_first_, false) || chosen;
    return chosen;
  }

 private:
  bool takes_first_ = false;
  int count_ = 0;
};

// The filters that the search is about; whether there is any.
bool filtersAbout(const std::string& sought, ChoosableLines::Can can, ChoosableLines& lines,
                  Question& question) {
  bool found = false;
  for (const engine::Filter& filter : engine::filters()) {
    const std::string_view title = tr(filter.title), says = tr(filter.says);
    if (lower(fmt::format("{} {}", title, says)).find(sought) == std::string::npos) continue;
    if (!std::exchange(found, true)) {
      ImGui::Separator();
      ImGui::TextUnformatted(tr("Filters, in the list of the panel Filters"));
    }
    if (!lines.line("", ImGui::GetFontSize(), fmt::format("{}: {}", title, says), can)) continue;
    question.filter = filter.kind;
    question.panel = "Filters";
  }
  return found;
}

// What the panels at the right are for, in the words of those who look for it.
struct PanelUse {
  const char* name;
  const char* says;
};
constexpr PanelUse kPanelUses[] = {
    {textOf("Remove samples"), textOf("heights below or above a limit, or marked ones, become holes")},
    {textOf("Holes and lines"), textOf("holes are filled; stripes of a line scanner are levelled")},
    {textOf("Form"), textOf("tilt, bend, a plane, sphere or cylinder is taken out")},
    {textOf("Steps"), textOf("everything that was done, to go back to and forward")},
    {textOf("Change since the scan"),
     textOf("how far heights differ from the scan: largest, rms, histogram")},
    {textOf("Measure"), textOf("roughness and texture of the surface: Sa, Sq, Sz and more, by ISO 25178")},
    {textOf("Section"),
     textOf(
         "profile along a line: step height, depth and width of a groove, angle, radius, roughness Ra, Rq, "
         "Rz")},
    {textOf("Fit"), textOf("radius, place and direction of a plane, sphere, cylinder, cone or torus")},
    {textOf("Features"), textOf("hills or dales: how many, how high and wide")},
    {textOf("Transform"), textOf("crop, mirror, rotate, other spacing (resample)")},
    {textOf("Join"), textOf("scans that overlap become one (stitching, mosaic)")},
    {textOf("Compare"),
     textOf("deviation from another scan or from a nominal mesh (STL, CAD), with a tolerance")},
    {textOf("Colours"), textOf("range and colour map of heights, tolerance, contour lines")},
    {textOf("Display"), textOf("light or dark theme, size of text, light, heights exaggerated, mouse")},
    {textOf("Haptics"), textOf("device, stiffness, force, tip and effects of the touch")},
};

// The panels that the search is about; whether there is any.
bool panelsAbout(const std::string& sought, ChoosableLines::Can can, ChoosableLines& lines,
                 Question& question) {
  bool found = false;
  for (const PanelUse& panel : kPanelUses) {
    const std::string line = fmt::format("{}: {}", tr(panel.name), tr(panel.says));
    if (lower(line).find(sought) == std::string::npos) continue;
    if (!std::exchange(found, true)) {
      ImGui::Separator();
      ImGui::TextUnformatted(tr("Panels, at the right"));
    }
    if (lines.line("", ImGui::GetFontSize(), line, can)) question.panel = panel.name;
  }
  return found;
}

std::optional<Choice> shortcutsDialog(Question& question, const Parts& parts, Questions& questions,
                                      float scale) {
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  // The button beside it stays whole with large letters, too.
  const ImGuiStyle& style = ImGui::GetStyle();
  const float button = ImGui::CalcTextSize(tr("Close (Esc)")).x + 2.0F * style.FramePadding.x;
  ImGui::SetNextItemWidth(
      std::min(420.0F * scale, ImGui::GetContentRegionAvail().x - button - style.ItemSpacing.x));
  const bool entered =
      ImGui::InputTextWithHint("##sought", tr("search: a word, or a key; Enter does the first, a click any"),
                               &question.sought, ImGuiInputTextFlags_EnterReturnsTrue);
  if (entered) ImGui::SetKeyboardFocusHere(-1);  // where there is nothing to do another word is typed
  ImGui::SameLine();
  const bool left = dialogButton("Close (Esc)", questions, Key::kEscape);
  std::string sought = lower(question.sought);
  if (sought.size() > 3 && sought.back() == 's' && sought[sought.size() - 2] != 's')
    sought.pop_back();  // "units" are there as "unit"
  if (sought.empty()) howToClean();
  ChoosableLines lines(entered && !sought.empty());
  std::string_view section;
  for (const ActionRow& row : actions()) {
    // What one would use it for is sought as well, as "spike".
    const std::string_view tip = tipOf(row.action);
    const std::string all = fmt::format("{} {} {} {}", tr(row.section), tr(row.name),
                                        keyText(row.key, row.modifiers), tip.empty() ? tip : tr(tip));
    if (lower(all).find(sought) == std::string::npos) continue;
    if (row.section != section) {
      section = row.section;
      ImGui::Separator();
      const std::string_view title = tr(section);
      ImGui::TextUnformatted(title.data(), title.data() + title.size());
    }
    std::string keys = keyText(row.key, row.modifiers);
    if (row.other_key != Key::kNone)
      keys = trFormat("{} or {}", keys, keyText(row.other_key, row.modifiersOfOther()));
    // What is in no menu goes with a key that is held, or with the place of the cursor.
    using enum ChoosableLines::Can;
    const bool able = row.enabled != nullptr ? row.enabled(parts) : ready(row, parts);
    const bool by_key = row.menu.group == 0 || row.action == Action::kShortcuts;
    if (lines.line("  " + keys, 212.0F * scale, std::string(tr(row.name)),
                   !able    ? kNotNow
                   : by_key ? kByItsKeyAlone
                            : kNow))
      question.wanted = row.action;
  }
  if (!sought.empty()) {
    const auto can = parts.document.isOpen() ? ChoosableLines::Can::kNow : ChoosableLines::Can::kNotNow;
    const bool filter = filtersAbout(sought, can, lines, question),
               panel = panelsAbout(sought, can, lines, question);
    if (section.empty() && !filter && !panel)
      writeWrapped("Nothing is found: try another word, or empty the field for the whole list.");
    if (question.wanted || !question.panel.empty()) return Choice::kConfirm;
    return left ? std::optional(Choice::kBack) : std::nullopt;
  }
  ImGui::Separator();
  ImGui::TextUnformatted(tr(
      "  Ctrl+1 .. Ctrl+9         recent files\n"
      "  left button              the stylus, while a tool is on; the wheel then sets how deep it presses\n"
      "  middle, right button     turn, move the view (Shift, Ctrl: see View > Mouse); wheel: zoom\n"
      "  Alt + left button        turn the view\n"
      "  Ctrl + Shift + left      drag an edge line or a section; a click chooses one where no tool is on"));
  if (question.wanted) return Choice::kConfirm;
  return left ? std::optional(Choice::kBack) : std::nullopt;
}

std::optional<Choice> messageDialog(const Question& question, Questions& questions, float scale) {
  ImGui::PushTextWrapPos(600.0F * scale);
  ImGui::TextUnformatted(screenText(tr(std::string_view(question.said.what))).c_str());
  if (!question.said.remedy.empty())
    ImGui::TextDisabled("%s", screenText(tr(std::string_view(question.said.remedy))).c_str());
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
    case Kind::kJoin:
    case Kind::kSaveAs:
    case Kind::kExport:
    case Kind::kOpenScene:
    case Kind::kSaveScene:
    case Kind::kExportSections:
    case Kind::kExportReport:
    case Kind::kExportFits:
    case Kind::kExportFeatures:
      return fileDialog(question, parts);
    case Kind::kImport:
      return importPage(question, parts);
    case Kind::kUnsaved:
      return unsavedDialog(question, parts);
    case Kind::kUnsavedScene:
      return unsavedSceneDialog(question, parts);
    case Kind::kReplace:
      return replaceDialog(question, questions, scale);
    case Kind::kRecover:
      return recoverDialog(question, questions);
    case Kind::kDevice:
      return devicePage(parts);
    case Kind::kShortcuts:
      return shortcutsDialog(question, parts, questions, scale);
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
  const auto wide = [&](float at_one) {
    return std::min(at_one * static_cast<float>(parts.window.scale()), ImGui::GetIO().DisplaySize.x);
  };
  if (isPathKind(question->kind)) ImGui::SetNextWindowSize(ImVec2(wide(900.0F), 0.0F));
  if (question->kind == Kind::kImport) ImGui::SetNextWindowSize(ImVec2(wide(740.0F), 0.0F));
  if (question->kind == Kind::kShortcuts)
    ImGui::SetNextWindowSize(ImVec2(wide(720.0F), 0.8F * ImGui::GetIO().DisplaySize.y));
  if (!questions.begin()) return std::nullopt;
  std::optional<Answer> answer;
  if (const auto choice = layOut(*question, parts)) answer = Answer{*choice, questions.close()};
  questions.end();
  return answer;
}

}  // namespace fettle::app
