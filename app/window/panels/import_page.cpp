// How a file is read: what it says, what was guessed, and what a person says instead.
#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/window/panels/dialog_button.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/scan_facts.h"
#include "app/window/panels/scan_picture.h"

namespace fettle::app {
namespace {

using Choice = Answer::Choice;
using render::Key;

constexpr float kPicture = 340.0F, kFieldsWidth = 380.0F;  // at scale 1 [pixels]

void text(const char* hint, const char* id, std::string& value, float width) {
  ImGui::SetNextItemWidth(width);
  (void)ImGui::InputTextWithHint(id, hint, &value);
}

void typed(const char* name, const char* hint, std::string& value) {
  fieldName(name);
  text(hint, (std::string("##") + name).c_str(), value, -1.0F);
}

void choice(const char* name, std::string& value,
            const std::vector<std::pair<std::string, std::string>>& words) {
  fieldName(name);
  const auto now =
      std::find_if(words.begin(), words.end(), [&](const auto& word) { return word.first == value; });
  ImGui::SetNextItemWidth(-1.0F);
  if (!ImGui::BeginCombo((std::string("##") + name).c_str(),
                         now != words.end() ? now->second.c_str() : value.c_str()))
    return;
  for (const auto& [word, label] : words)
    if (ImGui::Selectable(label.c_str(), word == value)) value = word;
  ImGui::EndCombo();
}

void unitChoice(std::string& unit) {
  std::vector<std::pair<std::string, std::string>> words{{"", "as in the file, else mm"}};
  for (const std::string& name : engine::lengthUnitNames()) words.emplace_back(name, name);
  choice("unit", unit, words);
}

// Lone values of the scan, to be taken as holes by one click.
void noData(std::string& value, const ScanThumbnail* picture) {
  typed("no data", "as in the file", value);
  if (picture == nullptr) return;
  for (const engine::LoneValue& lone : picture->lone_values)
    if (ImGui::Button(fmt::format("{} are holes", lone.number).c_str()))
      value = fmt::format("{}", lone.number);
}

void fields(ImportForm& form, const ScanThumbnail* picture) {
  std::string spacing = "as in the file", unit;
  if (picture != nullptr && picture->grid) {
    const engine::Grid& grid = *picture->grid;
    spacing = fmt::format("{:.6g} now", grid.spacing_x);
    unit = fmt::format("{} across, {} up", grid.lateral_unit.name, grid.height_unit.name);
  }
  beginFields();
  fieldName("spacing");
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  text(spacing.c_str(), "##spacing x", form.spacing_x, half);
  ImGui::SameLine();
  text("rows the same", "##spacing y", form.spacing_y, half);
  unitChoice(form.unit);
  typed("z scale", "as in the file, else 1", form.z_scale);
  noData(form.no_data, picture);
  typed("cell size", "of a cloud of points: by its density", form.cell_size);
  choice("cell height", form.cell_rule,
         {{"", "median of its points"}, {"mean", "mean"}, {"highest", "highest"}});
  fieldName("depth camera");
  const float quarter = 0.25F * (ImGui::GetContentRegionAvail().x - 3.0F * ImGui::GetStyle().ItemSpacing.x);
  static constexpr std::array kNames{"fx", "fy", "cx", "cy"};
  for (std::size_t i = 0; i < form.camera.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    text(kNames[i], (std::string("##camera ") + kNames[i]).c_str(), form.camera[i], quarter);
  }
  endFields();
  if (!unit.empty()) ImGui::TextDisabled("units now: %s", unit.c_str());
}

void found(const ThumbnailShelf::Shown& shown) {
  ImGui::PushTextWrapPos(0.0F);
  if (shown.problem != nullptr) {
    ImGui::TextColored(ImVec4(1.0F, 0.6F, 0.3F, 1.0F), "%s", shown.problem->line().c_str());
  } else if (shown.picture == nullptr) {
    ImGui::TextDisabled("reading");
  } else {
    for (const std::string& line :
         {sizeText(*shown.picture), extentText(*shown.picture), heightsText(*shown.picture)})
      if (!line.empty()) ImGui::TextUnformatted(line.c_str());
    if (!shown.picture->whole)
      ImGui::TextDisabled("a coarse look: what is guessed is said when all of it is read");
    for (const std::string& warning : shown.picture->warnings) {
      ImGui::Bullet();
      ImGui::TextWrapped("%s", warning.c_str());
    }
    if (shown.picture->whole && shown.picture->warnings.empty())
      ImGui::TextDisabled("nothing was guessed: the file says it all");
  }
  ImGui::PopTextWrapPos();
}

}  // namespace

std::optional<Choice> importPage(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  Files& files = parts.files;
  const auto scale = static_cast<float>(parts.window.scale());
  if (ImGui::IsWindowAppearing()) files.begin(question.reading.value_or(ScanOptions()));
  ImGui::TextUnformatted(std::filesystem::path(question.path).filename().c_str());
  const auto typed_so_far = files.form.read();
  if (typed_so_far) files.reading = *typed_so_far;
  const ThumbnailShelf::Shown shown = files.shelf.find(question.path, files.reading);
  ImGui::BeginGroup();
  const ImVec2 size(kPicture * scale, 0.75F * kPicture * scale);
  std::optional<PictureCursor> cursor;
  if (shown.picture != nullptr)
    cursor = scanPicture(*shown.picture, size);
  else
    ImGui::Dummy(size);
  ImGui::TextUnformatted(cursor ? cursorText(*shown.picture, *cursor).c_str() : " ");
  ImGui::EndGroup();
  ImGui::SameLine();
  if (ImGui::BeginChild("fields", ImVec2(kFieldsWidth * scale, 0.75F * kPicture * scale)))
    fields(files.form, shown.picture);
  ImGui::EndChild();
  if (ImGui::BeginChild("found", ImVec2(0.0F, 110.0F * scale), true)) {
    if (!typed_so_far)
      ImGui::TextColored(ImVec4(1.0F, 0.6F, 0.3F, 1.0F), "%s", typed_so_far.error().line().c_str());
    found(shown);
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
