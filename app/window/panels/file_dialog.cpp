// The dialog of a path: to open, to compare with, to save as, to export; of a scan or of a scene.
#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/texts/texts.h"
#include "app/window/panels/dialog_button.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/scan_facts.h"
#include "app/window/panels/scan_picture.h"
#include "app/window/result_files.h"
#include "app/window/screen_text.h"
#include "app/work/nominal_compare.h"
#include "engine/formats/formats.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

using Choice = Answer::Choice;
using Kind = Question::Kind;
using render::Key;
using render::PanelColour;

constexpr float kPlaces = 150.0F, kPreview = 230.0F, kHeight = 300.0F;  // at scale 1 [pixels]
constexpr float kWhole = 900.0F;                                        // all of it, where there is room
constexpr float kLinesAround = 8.0F;                                    // above and below the lists
constexpr int kPage = 12;                                               // rows of Page up and Page down

bool isScene(const Question& question) {
  return question.kind == Kind::kOpenScene || question.kind == Kind::kSaveScene;
}

bool reads(const Question& question) {
  return question.kind == Kind::kOpen || question.kind == Kind::kCompare || question.kind == Kind::kJoin ||
         question.kind == Kind::kOpenScene;
}

std::string dateText(std::int64_t changed_s) {
  if (changed_s == 0) return {};
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(static_cast<std::time_t>(changed_s)));
}

// The path of the dialog in a folder: what is saved keeps its name.
std::string pathIn(const std::string& folder, const Question& question) {
  return reads(question) ? folder : (fs::path(folder) / fs::path(question.path).filename()).string();
}

// Where one looks for the first scan: beside those opened before, else in the working folder.
std::string firstFolder(const RecentFiles& recent) {
  std::error_code error;
  const fs::path folder =
      recent.paths().empty() ? fs::current_path(error) : fs::path(recent.paths().front()).parent_path();
  return (folder / "").string();
}

void enter(const std::string& folder, Question& question, Files& files) {
  question.path = pathIn(folder, question);
  files.browser.goTo(folder);
}

void choose(std::size_t i, Question& question, FileBrowser& browser) {
  browser.choose(i);
  const bool keeps_name = !reads(question) && browser.entry(i).folder;
  if (!keeps_name) question.path = browser.pathOf(i);
}

// Tab goes on with the name as far as the names in the list agree.
void complete(ImGuiInputTextCallbackData* data, const FileBrowser& browser) {
  const std::string typed(data->Buf, static_cast<std::size_t>(data->BufTextLen));
  const std::size_t begin = typed.rfind('/') + 1;  // 0 without one
  const std::string name = browser.completion(typed.substr(begin));
  data->DeleteChars(static_cast<int>(begin), data->BufTextLen - static_cast<int>(begin));
  data->InsertChars(data->BufTextLen, name.c_str());
}

// Up and Down in the field of the path go through the list.
int moveByKeys(ImGuiInputTextCallbackData* data) {
  auto& browser = *static_cast<FileBrowser*>(data->UserData);
  if (data->EventFlag == ImGuiInputTextFlags_CallbackCompletion) complete(data, browser);
  if (data->EventFlag != ImGuiInputTextFlags_CallbackHistory) return 0;
  browser.move(data->EventKey == ImGuiKey_UpArrow ? -1 : 1);
  if (!browser.chosen()) return 0;
  data->DeleteChars(0, data->BufTextLen);
  data->InsertChars(0, browser.pathOf(*browser.chosen()).c_str());
  data->SelectAll();
  return 0;
}

// What is typed while no field has the keyboard narrows the list.
void narrowByKeys(FileBrowser& browser) {
  if (ImGui::IsAnyItemActive()) return;
  std::string typed = browser.view().typed;
  for (const ImWchar letter : ImGui::GetIO().InputQueueCharacters)
    if (letter > ' ' && letter < 0x7F) typed += static_cast<char>(letter);
  if (!typed.empty() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Backspace))) typed.pop_back();
  if (typed == browser.view().typed) return;
  FolderView view = browser.view();
  view.typed = typed;
  browser.setView(std::move(view));
}

bool pressed(ImGuiKey key) {
  return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key));
}

// Keys that the field of the path leaves alone. True when the choice moved.
bool pageByKeys(Question& question, Files& files) {
  FileBrowser& browser = files.browser;
  const int by = pressed(ImGuiKey_PageDown) ? kPage : pressed(ImGuiKey_PageUp) ? -kPage : 0;
  if (by == 0) return false;
  browser.move(by);
  if (browser.chosen()) choose(*browser.chosen(), question, browser);
  return true;
}

void placesList(Question& question, Files& files, ImVec2 size) {
  if (ImGui::BeginChild("places", size, true))
    for (const FilePlace& place : files.shown_places) {
      ImGui::PushID(place.folder.c_str());
      const std::string name = (place.own ? "* " : "") + place.name;
      if (ImGui::Selectable(name.c_str(), place.folder == files.browser.folder(),
                            ImGuiSelectableFlags_DontClosePopups))
        enter(place.folder, question, files);
      if (ImGui::IsItemHovered()) valueTip(place.folder);
      ImGui::PopID();
    }
  ImGui::EndChild();
}

void folderLine(Question& question, Parts& parts) {
  Files& files = parts.files;
  if (pressButton("Up", "To the folder that this one is in.")) {
    question.path = pathIn(fs::path(files.browser.folder()).parent_path().string(), question);
    files.browser.goUp();
  }
  ImGui::SameLine();
  if (pressButton(files.places.has(files.browser.folder()) ? textOf("No bookmark") : textOf("Bookmark"),
                  "Keeps this folder in the list at the left, or takes it out."))
    files.toggleBookmark(parts.recent.paths());
  ImGui::SameLine();
  FolderView view = files.browser.view();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 9.0F);
  bool changed = ImGui::InputTextWithHint("##names", tr("names with"), &view.typed);
  explain("Only names that contain this are listed.");
  ImGui::SameLine();
  changed = tickBox("all files", view.all_files, "Files that Fettle cannot read are listed, too.") || changed;
  ImGui::SameLine();
  changed = tickBox("hidden", view.hidden, "Files and folders whose name begins with a dot, too.") || changed;
  if (changed) files.browser.setView(std::move(view));
  ImGui::SameLine();
  ImGui::TextDisabled(
      "%s", files.browser.busy() ? tr("listing") : fmt::format("{}", files.browser.count()).c_str());
}

void followSorting(FileBrowser& browser) {
  ImGuiTableSortSpecs* const specs = ImGui::TableGetSortSpecs();
  if (specs == nullptr || !specs->SpecsDirty || specs->SpecsCount == 0) return;
  FolderView view = browser.view();
  view.order = static_cast<FolderOrder>(specs->Specs[0].ColumnUserID);
  view.descending = specs->Specs[0].SortDirection == ImGuiSortDirection_Descending;
  browser.setView(std::move(view));
  specs->SpecsDirty = false;
}

// The columns beside the names that a list has room for: with large letters or in a narrow window the date goes first, then the
// size, and not the names.
struct FileColumns {
  bool size = true, changed = true;
};
constexpr float kNameLetters = 22.0F, kSizeLetters = 9.0F, kDateLetters = 17.0F;

FileColumns columnsIn(float width, float letter) {
  return {.size = width >= (kNameLetters + kSizeLetters) * letter,
          .changed = width >= (kNameLetters + kSizeLetters + kDateLetters) * letter};
}

// One entry; true when it was double-clicked.
bool row(std::size_t i, Question& question, FileBrowser& browser, const FileColumns& columns) {
  const FolderEntry& entry = browser.entry(i);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  const std::string label = entry.name + (entry.folder ? "/" : "");
  const bool clicked =
      ImGui::Selectable(label.c_str(), browser.chosen() == i,
                        ImGuiSelectableFlags_DontClosePopups | ImGuiSelectableFlags_SpanAllColumns |
                            ImGuiSelectableFlags_AllowDoubleClick);
  if (clicked) choose(i, question, browser);
  const bool twice = clicked && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  const std::string size = entry.folder ? "" : bytesText(static_cast<double>(entry.bytes));
  const std::string changed = dateText(entry.changed_s);
  if (!columns.changed && ImGui::IsItemHovered()) valueTip(fmt::format("{}\n{}  {}", label, size, changed));
  if (ImGui::TableNextColumn()) ImGui::TextUnformatted(size.c_str());
  if (ImGui::TableNextColumn()) ImGui::TextUnformatted(changed.c_str());
  return twice;
}

// True when an entry was double-clicked; `scroll`: the chosen one comes into view.
bool fileTable(Question& question, Files& files, ImVec2 size, bool scroll) {
  constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_Sortable |
                                     ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersOuter |
                                     ImGuiTableFlags_NoSavedSettings;
  if (!ImGui::BeginTable("files", 3, kFlags, size)) return false;
  FileBrowser& browser = files.browser;
  const auto column = [](const char* name, FolderOrder order, ImGuiTableColumnFlags flags, float width) {
    ImGui::TableSetupColumn(tr(name), flags, width, static_cast<ImGuiID>(order));
  };
  const float letter = ImGui::GetFontSize() * 0.55F;
  const FileColumns columns = columnsIn(size.x, letter);
  const auto beside = [](bool shown) {
    return ImGuiTableColumnFlags_WidthFixed | ImGuiTableColumnFlags_PreferSortDescending |
           (shown ? ImGuiTableColumnFlags_None : ImGuiTableColumnFlags_Disabled);
  };
  column(textOf("name"), FolderOrder::kName, ImGuiTableColumnFlags_WidthStretch, 0.0F);
  column(textOf("size"), FolderOrder::kSize, beside(columns.size), kSizeLetters * letter);
  column(textOf("changed"), FolderOrder::kChanged, beside(columns.changed), kDateLetters * letter);
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableHeadersRow();
  followSorting(browser);
  bool twice = false;
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(browser.count()));
  const int chosen = browser.chosen() ? static_cast<int>(*browser.chosen()) : -1;
  if (scroll && chosen >= 0) clipper.ForceDisplayRangeByIndices(chosen, chosen + 1);
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      twice = row(static_cast<std::size_t>(i), question, browser, columns) || twice;
      if (scroll && i == chosen) ImGui::SetScrollHereY(0.5F);
    }
  ImGui::EndTable();
  return twice;
}

void preview(const Question& question, Parts& parts, ImVec2 size) {
  if (ImGui::BeginChild("preview", size, true)) {
    const FileBrowser& browser = parts.files.browser;
    const bool scan = browser.chosen() && browser.entry(*browser.chosen()).scan &&
                      browser.pathOf(*browser.chosen()) == parts.files.wholePath(question.path);
    if (scan) {
      const std::string path = browser.pathOf(*browser.chosen());
      const ThumbnailShelf::Shown shown = parts.files.shelf.find(path, parts.readingOf(path));
      ImGui::PushTextWrapPos(0.0F);
      if (shown.picture != nullptr) {
        const float side = ImGui::GetContentRegionAvail().x;
        const auto cursor = scanPicture(*shown.picture, ImVec2(side, 0.7F * side));
        if (cursor) valueTip(cursorText(*shown.picture, *cursor));
        if (shown.picture->empty()) ImGui::TextDisabled("%s", tr("too large for a quick look"));
        for (const std::string& text :
             {sizeText(*shown.picture), extentText(*shown.picture), heightsText(*shown.picture)})
          if (!text.empty()) writeWrapped(text);
        // The fields that the guesses name are on the page.
        if (question.kind == Kind::kOpen && anyGuess(shown.picture->warnings))
          ImGui::TextUnformatted(tr("guessed; set by \"Read as ...\":"));
        for (const std::string& warning : shown.picture->warnings)
          ImGui::TextDisabled("%s", screenText(inFieldWords(warning)).c_str());
      } else if (shown.problem != nullptr) {
        ImGui::TextUnformatted(screenText(shown.problem->what).c_str());
      } else {
        ImGui::TextDisabled("%s", tr("reading"));
      }
      ImGui::PopTextWrapPos();
    }
  }
  ImGui::EndChild();
}

// The formats that can be written; a session is the usual one of "save as". Choosing one changes the extension.
void formatChooser(Question& question) {
  const std::string extension = engine::extensionOf(question.path);
  std::string now = tr("by extension");
  for (const engine::FormatInfo& format : engine::formats())
    for (const std::string_view each : format.extensions)
      if (format.writes && each == extension) now = format.description;
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 16.0F);
  const bool open = ImGui::BeginCombo(labelOf("format"), now.c_str(), ImGuiComboFlags_HeightLargest);
  if (!open) {
    explain("The format that is written: choosing one changes the ending of the name.");
    return;
  }
  for (const engine::FormatInfo& format : engine::formats()) {
    if (!format.writes) continue;
    const std::string label = fmt::format("{} ({})", format.description, format.extensions.front());
    if (ImGui::Selectable(label.c_str(), now == format.description))
      question.path = fs::path(question.path).replace_extension(format.extensions.front()).string();
  }
  ImGui::EndCombo();
}

// The formats of a file of what was measured; choosing one changes the ending.
void resultFormatChooser(Question& question, const ResultFile& file) {
  const ResultFormat* const now = formatOf(file, question.path);
  const auto label = [](const ResultFormat& format) {
    return fmt::format("{} ({})", tr(format.text), format.ending);
  };
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 24.0F);
  const bool open =
      ImGui::BeginCombo(labelOf("format"), now != nullptr ? label(*now).c_str() : tr("by the ending"));
  if (!open) {
    explain("The format that is written: choosing one changes the ending of the name.");
    return;
  }
  for (const ResultFormat& format : file.formats)
    if (ImGui::Selectable(label(format).c_str(), &format == now))
      question.path = fs::path(question.path).replace_extension(format.ending).string();
  ImGui::EndCombo();
}

void sectionChoices(SectionTool& sections) {
  SectionTool::Exporting& exporting = sections.exporting;
  ImGui::BeginDisabled(!sections.chosen());
  tickBox("the chosen section alone", exporting.chosen_alone, "Without it all sections are written.");
  ImGui::EndDisabled();
  ImGui::SameLine();
  tickBox("profiles of the scan beside them", exporting.with_scan,
          "Those of the scan that the work began with, where it differs from the field.");
}

void resultHelp(Question& question, const ResultFile& file, Parts& parts) {
  resultFormatChooser(question, file);
  ImGui::TextDisabled("%s", tr(file.content));
  if (question.kind == Kind::kExportSections) sectionChoices(parts.section);
}

// The unit of the numbers of a mesh whose format knows none.
void meshUnitChooser(const engine::Grid& grid, Saving& saving) {
  const std::string own = trFormat("{}, as the scan", screenText(grid.lateral_unit.name));
  const char* const now = saving.mesh_in_mm ? tr("mm, as CAD programs take them") : own.c_str();
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 16.0F);
  if (!ImGui::BeginCombo(labelOf("numbers in"), now)) {
    explain(
        "STL knows no units, and CAD programs take its numbers for mm. In the scan's own unit every bit is "
        "kept; in mm each number is rounded by no more than 6e-8 of it.");
    return;
  }
  if (ImGui::Selectable(labelOf("mm, as CAD programs take them"), saving.mesh_in_mm))
    saving.mesh_in_mm = true;
  if (ImGui::Selectable(own.c_str(), !saving.mesh_in_mm)) saving.mesh_in_mm = false;
  ImGui::EndCombo();
}

void writingHelp(Question& question, Parts& parts) {
  if (isScene(question)) {
    ImGui::TextDisabled("%s", tr("tip, force, brushes and effects with their numbers, as a .toml file"));
    return;
  }
  formatChooser(question);
  const engine::Grid& grid = parts.document.client()->field().grid();
  if (engine::extensionOf(question.path) == ".stl" && Saving::hasMeshChoice(grid))
    meshUnitChooser(grid, parts.saving);
  const bool session = isSessionPath(question.path);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextDisabled("%s", session ? tr("a session keeps everything, each step as it is made")
                                    : tr("the field; marks and lines go next to it, as NAME_marks.png and "
                                         "NAME_lines.csv"));
  ImGui::PopTextWrapPos();
  if (question.kind != Kind::kSaveAs) return;
  ImGui::BeginDisabled(!session);
  tickBox("store the scan in the session", parts.saving.embeds,
          "The session then opens without the file of the scan, and is larger by it.");
  ImGui::EndDisabled();
}

// Behind the buttons, which stay where they are.
void remark(const Question& question, const FileBrowser& browser, const ResultFile* result) {
  std::error_code error;
  if (const engine::Error* problem = browser.problem()) {
    ImGui::SameLine();
    writeIn(PanelColour::kProblem, problem->line());
  } else if (result != nullptr && formatOf(*result, question.path) == nullptr) {
    ImGui::SameLine();
    textIn(PanelColour::kWarning, tr("choose a format, or end the name with one"));
  } else if (!reads(question) && fs::is_regular_file(question.path, error)) {
    ImGui::SameLine();
    textIn(PanelColour::kWarning, tr("this file exists already"));
  }
  if (question.said.what.empty()) return;
  const std::string_view what = tr(std::string_view(question.said.what)),
                         remedy = tr(std::string_view(question.said.remedy));
  writeIn(PanelColour::kProblem, remedy.empty() ? std::string(what) : fmt::format("{}: {}", what, remedy));
}

// Of the files that are listed where one is written: those of its format.
std::vector<std::string> endingsOf(const Question& question, const ResultFile* result) {
  std::vector<std::string> endings;
  if (reads(question) || isScene(question)) return endings;
  if (result != nullptr) {
    const ResultFormat* const now = formatOf(*result, question.path);
    for (const ResultFormat& format : result->formats)
      if (now == nullptr || now == &format) endings.emplace_back(format.ending);
    return endings;
  }
  const std::string extension = engine::extensionOf(question.path);
  for (const engine::FormatInfo& format : engine::formats())
    if (format.writes && std::ranges::find(format.extensions, extension) != format.extensions.end())
      endings.assign(format.extensions.begin(), format.extensions.end());
  return endings;
}

void listFormat(const Question& question, const ResultFile* result, FileBrowser& browser) {
  FolderView view = browser.view();
  if (std::vector<std::string> endings = endingsOf(question, result); endings != view.endings) {
    view.endings = std::move(endings);
    browser.setView(std::move(view));
  }
}

// Whether a scan to compare or join with can be read: else the dialog says why, and another one is chosen there. Nothing
// while it is not known.
std::optional<bool> readable(Question& question, Parts& parts) {
  const bool beside = question.kind == Kind::kCompare || question.kind == Kind::kJoin;
  if (!beside || isNominalFile(question.path)) return true;
  const ThumbnailShelf::Shown shown = parts.files.shelf.find(question.path, parts.readingOf(question.path));
  if (shown.problem != nullptr) question.said = {inFieldWords(shown.problem->line()), ""};
  if (shown.picture == nullptr && shown.problem == nullptr) return std::nullopt;
  return shown.problem == nullptr;
}

}  // namespace

std::optional<Choice> fileDialog(Question& question, Parts& parts) {
  Questions& questions = parts.feedback.questions;
  Files& files = parts.files;
  const auto scale = static_cast<float>(parts.window.scale());
  const bool appears = ImGui::IsWindowAppearing();
  const ResultFile* const result = resultFileOf(question.kind);
  const std::string path_before = question.path;
  if (appears) {
    // A path of the command line is one from the folder that the program was started in, and what is typed here one from the
    // folder that is listed.
    std::error_code error;
    if (question.path.empty())
      question.path = firstFolder(parts.recent);
    else if (const fs::path whole = fs::absolute(question.path, error); !error)
      question.path = whole.lexically_normal().string();
    files.begin(question.path, parts.recent.paths(), isScene(question) ? FilesOf::kScenes : FilesOf::kScans);
  }
  // Also after a name that is none: another one is typed in its place.
  if (appears || (!question.said.what.empty() && !ImGui::IsAnyItemActive())) ImGui::SetKeyboardFocusHere();
  const auto before = files.browser.chosen();
  ImGui::SetNextItemWidth(-1.0F);
  bool confirmed =
      ImGui::InputText("##path", &question.path,
                       ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue |
                           ImGuiInputTextFlags_CallbackHistory | ImGuiInputTextFlags_CallbackCompletion,
                       moveByKeys, &files.browser);
  if (!appears && ImGui::IsItemEdited() && files.browser.chosen() == before)
    files.follow(question.path, reads(question));
  listFormat(question, result, files.browser);
  narrowByKeys(files.browser);
  const bool paged = pageByKeys(question, files);
  folderLine(question, parts);
  // Where the window is too small for the text, lists are narrower and lower before anything is out of reach.
  const float fit = std::min(1.0F, ImGui::GetWindowWidth() / (kWhole * scale)) * scale;
  const float line = ImGui::GetFrameHeightWithSpacing();
  const float room = ImGui::GetIO().DisplaySize.y - kLinesAround * line;
  const float height = std::max(std::min(room, kHeight * scale), 4.0F * line);
  placesList(question, files, ImVec2(kPlaces * fit, height));
  ImGui::SameLine();
  const float width = ImGui::GetContentRegionAvail().x - kPreview * fit - ImGui::GetStyle().ItemSpacing.x;
  const bool moved = paged || files.browser.chosen() != before;
  const bool twice = fileTable(question, files, ImVec2(width, height), moved);
  ImGui::SameLine();
  preview(question, parts, ImVec2(kPreview * fit, height));
  if (result != nullptr)
    resultHelp(question, *result, parts);
  else if (!reads(question))
    writingHelp(question, parts);
  confirmed = dialogButton(reads(question) ? textOf("Open") : textOf("Write"), questions, Key::kEnter) ||
              confirmed || twice;
  ImGui::SameLine();
  const bool as =
      question.kind == Kind::kOpen &&
      pressButton("Read as ...", "Says unit, spacing, scale and holes of the file before it is opened.");
  if (question.kind == Kind::kOpen) ImGui::SameLine();
  const bool left = dialogButton("Cancel", questions, Key::kEscape);
  // It was said of another file.
  if (!appears && question.path != path_before) question.said = {}, question.confirmed = false;
  confirmed = confirmed || std::exchange(question.confirmed, false);
  remark(question, files.browser, result);
  if (left) return Choice::kBack;
  std::error_code error;
  if (as && fs::is_regular_file(question.path, error) && !isSessionPath(question.path)) return Choice::kOther;
  if (!confirmed || question.path.empty()) return std::nullopt;
  question.path = files.wholePath(question.path);
  // Part of a name that only one file has is that file.
  if (reads(question) && !fs::exists(question.path, error) && files.browser.count() == 1)
    question.path = files.browser.pathOf(0);
  const auto& chosen = files.browser.chosen();
  const std::string folder =
      twice && chosen && files.browser.entry(*chosen).folder ? files.browser.pathOf(*chosen) : question.path;
  if (fs::is_directory(folder, error)) {
    enter(folder, question, files);
    return std::nullopt;
  }
  if (reads(question) && !fs::exists(question.path, error)) {
    question.said = {trFormat("there is no file {}", fs::path(question.path).filename().string()),
                     tr("choose one in the list, or correct the name")};
    return std::nullopt;
  }
  if (result != nullptr && formatOf(*result, question.path) == nullptr) return std::nullopt;
  const std::optional<bool> can = readable(question, parts);
  question.confirmed = !can;
  return can.value_or(false) ? std::optional(Choice::kConfirm) : std::nullopt;
}

}  // namespace fettle::app
