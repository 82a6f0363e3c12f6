#include <filesystem>
#include <iterator>
#include <optional>
#include <string>

#include <imgui.h>

#include "app/window/panels/moves_choice.h"
#include "app/window/panels/panels.h"

namespace fettle::app {

namespace {

constexpr int kOutcomeOfJoin = 2;  // lines
constexpr int kMostInRow = 1000;

// The scans in the order of rows; the field is the first.
void listOfScans(JoinTool& join) {
  for (std::size_t k = 0; k < join.scans().size(); ++k) {
    ImGui::PushID(static_cast<int>(k));
    const std::string& path = join.scans()[k].path;
    if (pressButton("Remove##joined", "It is not joined.")) {
      join.remove(k);
      ImGui::PopID();
      return;
    }
    ImGui::SameLine();
    ImGui::TextUnformatted(std::filesystem::path(path).filename().string().c_str());
    if (ImGui::IsItemHovered()) valueTip(path);
    ImGui::PopID();
  }
}

}  // namespace

bool joinPanel(const PanelContext& context, JoinTool& join) {
  ImGui::BeginDisabled(join.busy());
  JoinTool::Options& options = join.options;
  listOfScans(join);
  actionButton("Add a scan", Action::kJoin, context.act);
  beginFields();
  (void)field("they are moved", "How each scan may move until they fit where they overlap.", [&] {
    std::optional<engine::AlignMoves> moves = options.moves;
    const bool changed = chooseMoves("##join moves", moves);
    options.moves = *moves;
    return changed;
  });
  (void)field("where several are", "The height where several scans have one.", [&] {
    int blend = static_cast<int>(options.blend);
    const bool changed = chooseWord("##join blend", blend, {"fade into each other", "the mean", "the first"});
    if (changed) options.blend = static_cast<engine::Blend>(blend);
    return changed;
  });
  (void)field("scans in a row",
              "From the lower left, left to right, then the next row above; 0: they lie where their files "
              "say, and where these say nothing it "
              "is searched for.",
              [&] { return typeCount("##join columns", options.columns, 0, kMostInRow, 1); });
  ImGui::BeginDisabled(options.columns == 0);
  (void)field("overlap", "Share of a side that neighbours in such rows have in common, roughly.",
              [&] { return typeNumber("##join overlap", options.overlap, 1.0, 90.0, "%.4g %%"); });
  ImGui::EndDisabled();
  endFields();
  ImGui::BeginDisabled(join.scans().empty());
  const bool asked = pressButton("Join them", "Makes one scan of all of them, in a session of its own.");
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  beginPlace("##join outcome", kOutcomeOfJoin);
  if (!join.busy())
    writeWrapped("a session beside the scan, and opened; the work here stays as it is");
  else if (cancelledBar(join.progress(), "joining", "Cancel##join"))
    join.cancel();
  endPlace();
  return asked;
}

}  // namespace fettle::app
