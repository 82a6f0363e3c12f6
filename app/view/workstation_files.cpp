#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/terminal.h"
#include "app/view/workstation.h"
#include "engine/io/export.h"
#include "engine/io/marks.h"
#include "haptic/sphere_tip.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

std::string nameOf(const std::string& path) {
  return fs::path(path).filename().string();
}

bool anyMark(const engine::Version& version) {
  return version.reader().root().marked_children != 0;
}

// The marks lie beside the field: NAME_marks.png.
std::string marksPath(const std::string& path) {
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + "_marks.png")).string();
}

}  // namespace

bool Workstation::unsaved() const {
  return touch_ && !(touch_->upright() == saved_);
}

std::string Workstation::suggestedPath() const {
  if (!save_path_.empty()) return save_path_;
  const fs::path scan(path_);
  return (scan.parent_path() / (scan.stem().string() + "_fettled.tif")).string();
}

void Workstation::message(std::string what, std::string remedy) {
  message_ = {std::move(what), std::move(remedy)};
  dialog_ = Dialog::kMessage;
  dialog_fresh_ = true;
}

void Workstation::askToOpen(const std::string& path) {
  if (unsaved()) {
    open_next_ = path;
    after_saving_ = AfterSaving::kOpen;
    dialog_ = Dialog::kUnsaved;
    dialog_fresh_ = true;
  } else {
    open(path);
  }
}

void Workstation::askToQuit() {
  if (!unsaved()) {
    quit_ = true;
    return;
  }
  after_saving_ = AfterSaving::kQuit;
  dialog_ = Dialog::kUnsaved;
  dialog_fresh_ = true;
}

void Workstation::goOn() {
  const AfterSaving what = std::exchange(after_saving_, AfterSaving::kNothing);
  if (what == AfterSaving::kQuit) quit_ = true;
  if (what == AfterSaving::kOpen) open(open_next_);
}

void Workstation::open(const std::string& path) {
  loading_path_ = path;
  loading_.start(
      [path, reading = options_.reading](engine::JobControl& job) { return loadScan(path, reading, job); });
}

void Workstation::takeImported(engine::Imported imported) {
  const engine::Grid& grid = imported.field.grid();
  TouchOptions options = options_.touch;
  options.fit_spring = !options_.scene.has_value();
  haptic::Scene scene = options_.scene.value_or(haptic::defaultScene());
  if (!options_.scene) {
    // Wider than the seed's one sample: what a person sees under a brush.
    scene.brush_radius_samples = 6.0;
    scene.mark_radius_samples = 3.0;
  }
  if (touch_) filters_.cancel(*touch_);
  auto touch = Touch::start(engine::History(imported.field), imported.field, scene, options);
  if (!touch) {
    if (path_.empty())
      end_ = tl::unexpected(touch.error());
    else
      message(touch.error().line(), "");
    return;
  }
  touch_ = std::move(*touch);
  path_ = loading_path_;
  save_path_.clear();
  saved_ = imported.field;
  measured_ = imported.field;
  deviation_.reset();
  measuring_.cancel();
  view_ = render::View{};
  view_.azimuth_deg = 330.0;
  shown_ = {};
  figures_ = {};
  chooseTool(std::nullopt);
  recent_.add(path_);
  for (const std::string& warning : imported.warnings) notices_.push_back({warning, ""});
  status_text_ = fmt::format("{}: {} x {} samples, {:.4g} x {:.4g} {}", nameOf(path_), grid.width,
                             grid.height, grid.spacing_x, grid.spacing_y, grid.lateral_unit.name);
  window_->setTitle(nameOf(path_) + " - Fettle");
  stale_ = true;
}

void Workstation::save() {
  if (!save_path_.empty()) {
    startSaving(save_path_, true);
    return;
  }
  // Never over the scan itself without being told so.
  dialog_ = Dialog::kSaveAs;
  dialog_fresh_ = true;
  dialog_path_ = suggestedPath();
}

void Workstation::startSaving(const std::string& path, bool keep_path) {
  if (auto status = checkOutputs({{path, OutputKind::kField}}, {}); !status) {
    message(status.error().line(), "");
    return;
  }
  saving_path_ = path;
  keep_save_path_ = keep_path;
  saving_.start(
      [path, field = touch_->upright()](engine::JobControl& job) -> engine::Result<engine::Version> {
        auto done = engine::exportField(field, path, {}, job);
        if (!done) return tl::unexpected(done.error());
        if (anyMark(field))
          if (auto marks = engine::exportMarks(field, marksPath(path)); !marks)
            return tl::unexpected(marks.error());
        return field;
      });
}

void Workstation::pathDialog(const char* title, const char* button) {
  ImGui::SetNextWindowSize(ImVec2(640.0F * static_cast<float>(window_->scale()), 0.0F));
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_NoResize)) return;
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0F);
  bool confirmed = ImGui::InputText("##path", &dialog_path_,
                                    ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue);
  if (dialog_ == Dialog::kOpen) {
    // What lies where the path points to so far.
    std::error_code error;
    const fs::path typed(dialog_path_);
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
        dialog_path_ = (folder.empty() ? fs::current_path(error) : folder).parent_path().string();
      for (const fs::path& entry : entries) {
        const bool is_folder = fs::is_directory(entry, error);
        const std::string label = entry.filename().string() + (is_folder ? "/" : "");
        if (ImGui::Selectable(label.c_str(), entry == typed, ImGuiSelectableFlags_DontClosePopups))
          dialog_path_ = entry.string();
      }
    }
    ImGui::EndChild();
  } else {
    std::error_code error;
    ImGui::TextDisabled(
        "%s", "format by extension: .tif .asc .xyz .ply .png; marks go beside it as NAME_marks.png");
    if (fs::exists(dialog_path_, error))
      ImGui::TextColored(ImVec4(1.0F, 0.7F, 0.2F, 1.0F), "replaces the file there");
  }
  confirmed = ImGui::Button(button) || takeDialogKey(render::Key::kEnter) || confirmed;
  ImGui::SameLine();
  const bool left = ImGui::Button("Cancel") || takeDialogKey(render::Key::kEscape);
  if (confirmed && !dialog_path_.empty()) {
    const Dialog which = std::exchange(dialog_, Dialog::kNone);
    ImGui::CloseCurrentPopup();
    if (which == Dialog::kOpen)
      askToOpen(dialog_path_);
    else
      startSaving(dialog_path_, which == Dialog::kSaveAs);
  } else if (left) {
    dialog_ = Dialog::kNone;
    after_saving_ = AfterSaving::kNothing;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Workstation::dialogs() {
  const char* title = nullptr;
  switch (dialog_) {
    case Dialog::kNone:
      return;
    case Dialog::kOpen:
      title = "Open a scan";
      break;
    case Dialog::kSaveAs:
      title = "Save as";
      break;
    case Dialog::kExport:
      title = "Export";
      break;
    case Dialog::kUnsaved:
      title = "Unsaved changes";
      break;
    case Dialog::kShortcuts:
      title = "Shortcuts";
      break;
    case Dialog::kMessage:
      title = "Fettle";
      break;
  }
  dialog_frame_ = frames_;
  stale_ = true;
  if (std::exchange(dialog_fresh_, false)) {
    ImGui::OpenPopup(title);
    dialog_key_ = render::Key::kNone;
  }
  const ImVec2 middle(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
  const auto escape = [&] { return takeDialogKey(render::Key::kEscape); };
  const auto enter = [&] { return takeDialogKey(render::Key::kEnter); };
  switch (dialog_) {
    case Dialog::kOpen:
      pathDialog(title, "Open");
      break;
    case Dialog::kSaveAs:
    case Dialog::kExport:
      pathDialog(title, "Write");
      break;
    case Dialog::kUnsaved:
      if (ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        ImGui::Text("%s was changed and is not saved.", nameOf(path_).c_str());
        const bool writes = ImGui::Button("Save (Enter)") || enter();
        ImGui::SameLine();
        const bool drops = ImGui::Button("Discard (D)") || takeDialogKey(render::letter('D'));
        ImGui::SameLine();
        const bool stays = ImGui::Button("Go back (Esc)") || escape();
        if (writes || drops || stays) {
          dialog_ = Dialog::kNone;
          ImGui::CloseCurrentPopup();
        }
        if (writes) save();
        if (drops) goOn();
        if (stays) after_saving_ = AfterSaving::kNothing;
        ImGui::EndPopup();
      }
      break;
    case Dialog::kShortcuts:
      ImGui::SetNextWindowSize(ImVec2(0.0F, 0.8F * ImGui::GetIO().DisplaySize.y));
      if (ImGui::BeginPopupModal(title, nullptr)) {
        std::string_view section;
        for (const Shortcut& s : shortcuts()) {
          if (s.section != section) {
            section = s.section;
            ImGui::Separator();
            ImGui::TextUnformatted(section.data(), section.data() + section.size());
          }
          std::string keys = keyText(s.key, s.modifiers);
          if (s.other_key != render::Key::kNone) keys += " or " + keyText(s.other_key, s.modifiers);
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
        if (ImGui::Button("Close") || escape()) {
          dialog_ = Dialog::kNone;
          ImGui::CloseCurrentPopup();
        }
        ImGui::EndPopup();
      }
      break;
    case Dialog::kMessage:
      if (ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        ImGui::PushTextWrapPos(600.0F * static_cast<float>(window_->scale()));
        ImGui::TextUnformatted(message_.what.c_str());
        if (!message_.remedy.empty()) ImGui::TextDisabled("%s", message_.remedy.c_str());
        ImGui::PopTextWrapPos();
        if (ImGui::Button("OK") || escape() || enter()) {
          dialog_ = Dialog::kNone;
          ImGui::CloseCurrentPopup();
        }
        ImGui::EndPopup();
      }
      break;
    case Dialog::kNone:
      break;
  }
}

}  // namespace fettle::app
