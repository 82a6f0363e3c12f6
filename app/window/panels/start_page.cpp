// What the window shows before a scan is open.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/scan_facts.h"
#include "app/window/panels/scan_picture.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

constexpr float kCardWidth = 200.0F, kCardPicture = 120.0F;  // at scale 1 [pixels]
constexpr int kColumns = 3, kMostCards = 6;
constexpr int kStep = 2;  // pixels of a picture that are drawn as one

// One of the files opened last; true when it is chosen.
bool card(const std::string& path, int number, Parts& parts, float scale) {
  const std::filesystem::path file(path);
  ImGui::BeginGroup();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ThumbnailShelf::Shown shown = parts.files.shelf.find(path, parts.readingOf(path));
  const ImVec2 size(kCardWidth * scale, kCardPicture * scale);
  if (shown.picture != nullptr)
    (void)scanPicture(*shown.picture, size, kStep);
  else
    ImGui::Dummy(size);
  ImGui::SetCursorScreenPos(corner);
  ImGui::PushID(number);
  const bool chosen = ImGui::InvisibleButton("card", size);
  if (ImGui::IsItemHovered()) {
    ImGui::GetWindowDrawList()->AddRect(corner, ImVec2(corner.x + size.x, corner.y + size.y),
                                        colourOf(render::PanelColour::kTick), 0.0F, 0, 2.0F * scale);
    const std::string facts = shown.picture != nullptr ? sizeText(*shown.picture) : std::string();
    valueTip(fmt::format("{}\n{}", path, facts));
  }
  ImGui::PopID();
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + size.x);
  ImGui::TextUnformatted(trFormat("{} (Ctrl+{})", file.filename().string(), number).c_str());
  if (shown.problem != nullptr) ImGui::TextDisabled("%s", screenText(shown.problem->what).c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndGroup();
  return chosen;
}

}  // namespace

void startPage(Parts& parts, const Act& act, PanelRequests& requests) {
  const auto scale = static_cast<float>(parts.window.scale());
  ImGui::TextUnformatted(tr("Drop a scan here, or press Ctrl+O"));
  actionButton("Open a scan", Action::kOpen, act);
  ImGui::SameLine();
  if (pressButton("A sample part", "A simulated scan with noise and edges, to try everything on."))
    requests.sample = true;
  const std::vector<std::string>& recent = parts.recent.paths();
  const int cards = std::min(kMostCards, static_cast<int>(recent.size()));
  for (int i = 0; i < cards; ++i) {
    if (i % kColumns != 0) ImGui::SameLine();
    if (card(recent[static_cast<std::size_t>(i)], i + 1, parts, scale))
      requests.open = recent[static_cast<std::size_t>(i)];
  }
}

}  // namespace fettle::app
