#include <array>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/slider.h"

namespace fettle::app {

namespace {

// Of the list with its heading. The same with no line as with many: strokes, undo and redo change how many there are while
// the hand is at other rows.
constexpr int kLineRows = 7;

// Returns what the wheel goes beyond its end.
float lineList(const PanelContext& context, LineTool& lines, const std::vector<LineFigures>& figures) {
  if (!ImGui::BeginTable("##lines", 5,
                         ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp,
                         ImGui::GetContentRegionAvail()))
    return 0.0F;
  ImGui::TableSetupScrollFreeze(0, 1);
  const render::ShownUnit &length = context.units.length, &upward = context.units.height;
  const double mm =
      length.per_unit / context.client.field().grid().lateral_unit.mm;  // shown units in a millimetre
  const std::string off = "\u00b1 " + length.name, step = trFormat("step {}", upward.name);
  const std::array columns{
      std::pair{std::string(tr("line")), textOf("A click chooses a line; Y goes to the next.")},
      std::pair{length.name, textOf("How long the line is.")},
      std::pair{
          std::string(tr("found")),
          textOf(
              "On how much of the line an edge was found in the heights. The rest, grey in the picture, lies "
              "where the hand drew it.")},
      std::pair{
          off,
          textOf("How surely the found edge lies where the line is: a standard deviation, across the line.")},
      std::pair{step, textOf("How high the edge is: the median along the line.")}};
  for (const auto& [title, meaning] : columns) ImGui::TableSetupColumn(title.c_str());
  ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
  for (const auto& [title, meaning] : columns) {
    ImGui::TableNextColumn();
    ImGui::TableHeader(title.c_str());
    explain(meaning);
  }
  const std::optional<std::int64_t> chosen = lines.chosen(context.client);
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(figures.size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const LineFigures& line = figures[static_cast<std::size_t>(i)];
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      const std::string name = (line.closed ? trFormat("{} closed", line.id) : fmt::format("{}", line.id)) +
                               fmt::format("###line {}", line.id);
      if (ImGui::Selectable(name.c_str(), chosen == line.id, ImGuiSelectableFlags_SpanAllColumns))
        lines.choose(line.id);
      for (const std::string& text :
           {fmt::format("{:.4g}", mm * line.length_mm), fmt::format("{:.0f} %", 100.0 * line.located),
            fmt::format("{:.3g}", mm * line.deviation_mm),
            fmt::format("{:.3g}", upward.per_unit * line.step)}) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(text.c_str());
      }
    }
  const float wheel = wheelPastEnd();
  ImGui::EndTable();
  return wheel;
}

}  // namespace

void linePanel(const PanelContext& context, LineTool& lines, bool draws) {
  actionTick("strokes become edge lines", draws, Action::kDrawLines, context.act);
  constexpr const char* kHand = textOf(
      "How far a hand usually strays from the edge that it follows. The edge is sought that far beside the "
      "stroke: more finds it after a careless stroke, less keeps to the stroke where edges lie close "
      "together.");
  beginFields();
  fieldName("hand off by", kHand);
  auto hand = static_cast<float>(lines.options.hand_deviation);
  if (slider("##hand", hand, static_cast<float>(engine::LocateOptions::kLeastHand),
             static_cast<float>(engine::LocateOptions::kMostHand), trPrintf("%.2f samples")))
    lines.options.hand_deviation = static_cast<double>(hand);
  explain(kHand);
  endFields();
  const std::vector<LineFigures>& figures = lines.figures(context.client.upright());
  ImGui::BeginDisabled(figures.empty());
  actionButton("Remove", Action::kRemoveLine, context.act);
  sameLineIfFits("Join");
  actionButton("Join", Action::kJoinLine, context.act);
  sameLineIfFits("Remove all");
  actionButton("Remove all", Action::kClearLines, context.act);
  ImGui::EndDisabled();
  beginPlace("##lines place", kLineRows);
  float wheel = 0.0F;
  if (figures.empty())
    writeIn(
        render::PanelColour::kMuted,
        "Draw along an edge with the mark tool. Each line is listed here: how long it is, on how much of it "
        "there is an edge, how surely it lies there, and how high it is.");
  else
    wheel = lineList(context, lines, figures);
  endPlace();
  scrollOn(wheel);
}

}  // namespace fettle::app
