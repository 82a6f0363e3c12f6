// How a file is read: what it says, what was guessed, and what a person says instead.
#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/texts/texts.h"
#include "app/window/panels/dialog_button.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/scan_facts.h"
#include "app/window/panels/scan_picture.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

using Choice = Answer::Choice;
using render::Key;
using render::PanelColour;

constexpr const char* kDoesNotSay =
    textOf("It does not say all about its numbers. Say what you know; Enter opens it as it is read below.");
constexpr float kPicture = 340.0F, kFieldsWidth = 380.0F, kFoundHeight = 190.0F;  // at scale 1 [pixels]

// Said where the cursor is on a field or on its name.
void explainOption(std::string_view option) {
  explain(readingField(option).tip);
}

void nameOf(std::string_view option) {
  fieldName(std::string(readingField(option).name).c_str(), readingField(option).tip);
}

void typed(std::string_view option, const char* name, const std::string& hint, std::string& value) {
  fieldName(name, readingField(option).tip);
  ImGui::SetNextItemWidth(-1.0F);
  (void)ImGui::InputTextWithHint((std::string("##") + name).c_str(), hint.c_str(), &value);
  explainOption(option);
}

void typed(std::string_view option, const std::string& hint, std::string& value) {
  typed(option, std::string(readingField(option).name).c_str(), hint, value);
}

void choice(std::string_view option, std::string& value,
            const std::vector<std::pair<std::string, std::string>>& words) {
  nameOf(option);
  const auto now =
      std::find_if(words.begin(), words.end(), [&](const auto& word) { return word.first == value; });
  ImGui::SetNextItemWidth(-1.0F);
  const bool opened = beginList((std::string("##") + std::string(option)).c_str(),
                                now != words.end() ? now->second.c_str() : value.c_str());
  if (!opened) {
    explainOption(option);
    return;
  }
  for (const auto& [word, label] : words)
    if (ImGui::Selectable(label.c_str(), word == value)) value = word;
  ImGui::EndCombo();
}

void spacingFields(Files& files) {
  ImportForm& form = files.form;
  std::string across = tr("as in the file"), up = across;
  if (files.found_grid) {
    const char* const whence = !files.form.camera[0].empty()                  ? tr("by the camera")
                               : isAssumed(files.found_warnings, "--spacing") ? tr("guessed")
                                                                              : tr("in the file");
    across = fmt::format("{:.6g} {}", files.found_grid->spacing_x, whence);
    up = fmt::format("{:.6g} {}", files.found_grid->spacing_y, whence);
  }
  const bool square = files.found_grid && files.found_grid->spacing_x == files.found_grid->spacing_y;
  if (square || !form.spacing_x.empty()) up = tr("as along a row");
  typed("--spacing", across, form.spacing_x);
  typed("--spacing", textOf("of the rows"), up, form.spacing_y);
}

void unitChoice(Files& files) {
  std::string as_it_is = tr("as in the file, else mm");
  if (files.found_grid && files.form.unit.empty())
    as_it_is = fmt::format("{}, {}", screenText(files.found_grid->height_unit.name),
                           isAssumed(files.found_warnings, "--unit") ? tr("guessed") : tr("as in the file"));
  std::vector<std::pair<std::string, std::string>> words{{"", as_it_is}};
  for (const std::string& name : engine::lengthUnitNames()) words.emplace_back(name, screenText(name));
  choice("--unit", files.form.unit, words);
}

// What the file's whole numbers are multiplied with; of other numbers none is known.
std::string foundScale(const Files& files) {
  if (!files.found_grid || files.found_grid->height_per_count == 0.0) return tr("as in the file, else 1");
  // Most files say none, and 1 is taken then.
  const bool stated = files.found_grid->height_per_count != 1.0;
  if (!stated && !isAssumed(files.found_warnings, "--z-scale")) return tr("1 unless you say another");
  return fmt::format("{:.6g} {}", files.found_grid->height_per_count,
                     isAssumed(files.found_warnings, "--z-scale") ? tr("guessed") : tr("in the file"));
}

std::string foundCell(const Files& files) {
  if (!files.found_grid) return tr("by the density of the points");
  return trFormat("{:.6g} by the points", files.found_grid->spacing_x);
}

// Lone values of the scan, to be taken as holes by one click.
void noData(std::string& value, const ScanThumbnail* picture) {
  typed("--no-data", tr("as in the file"), value);
  if (picture == nullptr) return;
  for (const engine::LoneValue& lone : picture->lone_values) {
    if (ImGui::Button(trFormat("{} are holes", lone.number).c_str())) value = fmt::format("{}", lone.number);
    explainOption("--no-data");
  }
  // The row stays while the next thing is clicked.
  if (!picture->lone_values.empty() || value.empty()) return;
  ImGui::BeginDisabled();
  ImGui::Button(trFormat("{} are holes", value).c_str());
  ImGui::EndDisabled();
}

// Few pictures are distances: folded unless it is one.
void cameraFields(ImportForm& form) {
  const bool said = std::ranges::any_of(form.camera, [](const std::string& text) { return !text.empty(); });
  ImGui::SetNextItemOpen(said, ImGuiCond_Appearing);
  const bool open = ImGui::TreeNode(labelOf("distances from a depth camera"));
  explainOption("--depth-camera");
  if (!open) return;
  const float quarter = 0.25F * (ImGui::GetContentRegionAvail().x - 3.0F * ImGui::GetStyle().ItemSpacing.x);
  static constexpr std::array kNames{textOf("fx"), textOf("fy: fx"), textOf("cx: middle"),
                                     textOf("cy: middle")};
  for (std::size_t i = 0; i < form.camera.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    ImGui::SetNextItemWidth(quarter);
    (void)ImGui::InputTextWithHint((std::string("##camera ") + kNames[i]).c_str(), tr(kNames[i]),
                                   &form.camera[i]);
    explainOption("--depth-camera");
  }
  ImGui::TreePop();
}

// Only what can apply to the file.
void fields(Files& files, const ScanThumbnail* picture) {
  ImportForm& form = files.form;
  beginFields();
  if (files.apply.spacing) spacingFields(files);
  unitChoice(files);
  typed("--z-scale", foundScale(files), form.z_scale);
  noData(form.no_data, picture);
  if (files.apply.cells) {
    typed("--cell-size", foundCell(files), form.cell_size);
    choice("--cell-rule", form.cell_rule,
           {{"", tr("median of its points")}, {"mean", tr("mean")}, {"highest", tr("highest")}});
  }
  if (files.apply.camera) cameraFields(form);
  endFields();
  if (files.found_grid)
    ImGui::TextDisabled(
        "%s", screenText(trFormat("units now: {} across, {} up", files.found_grid->lateral_unit.name,
                                  files.found_grid->height_unit.name))
                  .c_str());
}

void bullets(const std::vector<std::string>& warnings, bool guesses) {
  for (const std::string& warning : warnings)
    if (isGuess(warning) == guesses) {
      ImGui::Bullet();
      ImGui::TextWrapped("%s", screenText(inFieldWords(warning)).c_str());
    }
}

// What the file says, what a person says, what was guessed.
void found(const ThumbnailShelf::Shown& shown, const Files& files) {
  ImGui::PushTextWrapPos(0.0F);
  if (shown.problem != nullptr) {
    writeIn(PanelColour::kProblem, inFieldWords(shown.problem->line()));
  } else if (shown.picture == nullptr) {
    ImGui::TextDisabled("%s", tr("reading"));
  } else {
    const ScanThumbnail& picture = *shown.picture;
    const ReadingSources sources = readingSources(files.reading, picture.warnings, files.apply);
    for (const std::string& line : {sizeText(picture), extentText(picture), heightsText(picture),
                                    picture.whole ? sources.file : std::string(), sources.person})
      if (!line.empty()) ImGui::TextUnformatted(screenText(line).c_str());
    if (!picture.whole)
      ImGui::TextDisabled("%s", tr("a coarse look: what is guessed is said when all of it is read"));
    else if (anyGuess(picture.warnings))
      ImGui::TextUnformatted(tr("guessed:"));
    else
      ImGui::TextDisabled("%s", tr("nothing else was guessed"));
    bullets(picture.warnings, true);
    bullets(picture.warnings, false);
  }
  ImGui::PopTextWrapPos();
}

// How large picture and fields, and what was found below them, are: smaller than kPicture and its fellows where large letters
// or a small window leave less, so that the buttons stay on the screen.
struct PageSizes {
  ImVec2 picture, fields;
  float found = 0.0F;
};

// `reason`: the height of the text below the name [pixels].
PageSizes pageSizes(float scale, float reason) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float wide = ImGui::GetContentRegionAvail().x;
  // Title, name of the file, what the cursor is on, buttons, and the edges of all.
  const float rows = 4.0F * ImGui::GetFrameHeightWithSpacing() + 4.0F * style.WindowPadding.y + reason;
  const float high = std::max(ImGui::GetIO().DisplaySize.y - rows, 8.0F * ImGui::GetFrameHeight());
  PageSizes sizes;
  sizes.picture.x = std::min(kPicture * scale, 0.45F * wide);
  sizes.picture.y = std::min(0.75F * kPicture * scale, 0.57F * high);
  sizes.fields =
      ImVec2(std::min(kFieldsWidth * scale, wide - sizes.picture.x - style.ItemSpacing.x), sizes.picture.y);
  sizes.found = std::min(kFoundHeight * scale, high - sizes.picture.y - 2.0F * style.ItemSpacing.y);
  return sizes;
}

}  // namespace

std::optional<Choice> importPage(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  Files& files = parts.files;
  const auto scale = static_cast<float>(parts.window.scale());
  if (ImGui::IsWindowAppearing())
    files.begin(question.path, question.reading.value_or(ScanOptions()), question.guessed.get());
  ImGui::TextUnformatted(std::filesystem::path(question.path).filename().c_str());
  const float below_name = ImGui::GetCursorPosY();
  if (question.guessed != nullptr) writeWrapped(kDoesNotSay);
  const PageSizes sizes = pageSizes(scale, ImGui::GetCursorPosY() - below_name);
  const auto typed_so_far = files.form.read();
  if (typed_so_far) files.reading = *typed_so_far;
  const ThumbnailShelf::Shown shown = files.shelf.find(question.path, files.reading);
  if (shown.picture != nullptr) files.noteFound(question.path, *shown.picture);
  const ImVec2& size = sizes.picture;
  ImGui::BeginGroup();
  std::optional<PictureCursor> cursor;
  if (shown.picture != nullptr)
    cursor = scanPicture(*shown.picture, size);
  else
    ImGui::Dummy(size);
  ImGui::TextUnformatted(cursor ? cursorText(*shown.picture, *cursor).c_str() : " ");
  ImGui::EndGroup();
  ImGui::SameLine();
  if (ImGui::BeginChild("fields", sizes.fields)) fields(files, shown.picture);
  ImGui::EndChild();
  if (ImGui::BeginChild("found", ImVec2(0.0F, sizes.found), true)) {
    if (!typed_so_far) writeIn(PanelColour::kProblem, inFieldWords(typed_so_far.error().line()));
    found(shown, files);
  }
  ImGui::EndChild();
  // What was typed in this frame is read from now on: the window is not at rest before.
  if (const auto now = files.form.read()) (void)files.shelf.find(question.path, *now);
  const bool opens = dialogButton("Open (Enter)", questions, Key::kEnter);
  ImGui::SameLine();
  const bool left = dialogButton("Go back (Esc)", questions, Key::kEscape);
  if (left) return Choice::kBack;
  if (!opens || !typed_so_far) return std::nullopt;
  question.reading = *typed_so_far;
  return Choice::kConfirm;
}

}  // namespace fettle::app
