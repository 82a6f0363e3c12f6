#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "app/view/workstation.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

}  // namespace

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
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextDisabled(
        "%s",
        dialog_ == Dialog::kSaveAs
            ? "NAME.fettle keeps everything, each step as it is made. Other formats, by extension "
              ".tif .asc .xyz .ply .stl .x3p .exr .png, keep the field, with its marks beside it as "
              "NAME_marks.png"
            : "format by extension: .tif .asc .xyz .ply .stl .x3p .exr .png .fettle; marks go beside it as "
              "NAME_marks.png");
    ImGui::PopTextWrapPos();
    if (dialog_ == Dialog::kSaveAs && isSessionPath(dialog_path_))
      ImGui::Checkbox("put the scan itself into the session", &embeds_);
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
      startSaving(dialog_path_, which == Dialog::kSaveAs ? Keeping::kWorkThere : Keeping::kCopy);
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
    case Dialog::kRecover:
      title = "Unsaved work";
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
        ImGui::Text("%s was changed and is not saved.", fs::path(path_).filename().string().c_str());
        const bool writes = ImGui::Button("Save (Enter)") || enter();
        ImGui::SameLine();
        const bool drops = ImGui::Button("Discard (D)") || takeDialogKey(render::letter('D'));
        ImGui::SameLine();
        const bool stays = ImGui::Button("Go back (Esc)") || escape();
        if (after_saving_ == AfterSaving::kQuit) {
          ImGui::Checkbox("Do not ask again (N)", &stop_asking_);
          if (takeDialogKey(render::letter('N'))) stop_asking_ = !stop_asking_;
          ImGui::TextDisabled(
              "Unsaved work is then kept at the end, and offered when the scan is opened again.\n"
              "The File menu and the Display panel turn the question on again.");
        }
        if (writes || drops || stays) {
          dialog_ = Dialog::kNone;
          ImGui::CloseCurrentPopup();
        }
        // Who goes back decided nothing.
        if ((writes || drops) && after_saving_ == AfterSaving::kQuit && stop_asking_)
          settings_.ask_before_quitting = false;
        if (writes) save();
        if (drops) goOn();
        if (stays) after_saving_ = AfterSaving::kNothing;
        ImGui::EndPopup();
      }
      break;
    case Dialog::kRecover:
      if (ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
        ImGui::Text("Work on %s was not saved when the program ended.",
                    fs::path(open_next_).filename().c_str());
        const bool takes = ImGui::Button("Go on with it (Enter)") || enter();
        ImGui::SameLine();
        const bool leaves = ImGui::Button("Start from the scan (S)") || takeDialogKey(render::letter('S'));
        ImGui::SameLine();
        const bool stays = ImGui::Button("Go back (Esc)") || escape();
        ImGui::TextDisabled("Starting from the scan, the first new step takes the place of that work.");
        if (takes || leaves || stays) {
          dialog_ = Dialog::kNone;
          ImGui::CloseCurrentPopup();
        }
        if (takes) load(open_next_, Recovery::kTake);
        if (leaves) load(open_next_, Recovery::kLeave);
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
