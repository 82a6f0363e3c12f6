#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

constexpr int kPlotLines = 7;

// Where lengths and heights of a section lie in the plot.
struct PlotFrame {
  ImVec2 low{}, size{};  // lower left corner, width and height [pixels]
  double length_mm = 1.0, low_mm = 0.0, high_mm = 1.0;

  [[nodiscard]] ImVec2 at(double along_mm, double height_mm) const {
    return ImVec2(low.x + static_cast<float>(along_mm / length_mm) * size.x,
                  low.y - static_cast<float>((height_mm - low_mm) / (high_mm - low_mm)) * size.y);
  }
};

// Runs of places with a height, as lines.
void drawProfile(const PlotFrame& frame, const engine::Section& section, ImU32 colour, float width) {
  std::vector<ImVec2> run;
  const auto draw = [&] {
    if (run.size() > 1)
      ImGui::GetWindowDrawList()->AddPolyline(run.data(), static_cast<int>(run.size()), colour, 0, width);
    run.clear();
  };
  // No more places than pixels can show: the lowest and highest of each column.
  const auto columns = static_cast<std::size_t>(std::max(1.0F, frame.size.x));
  const std::size_t each = std::max<std::size_t>(1, section.size() / columns);
  for (std::size_t i = 0; i < section.size(); i += each) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = i; k < std::min(section.size(), i + each); ++k) {
      if (std::isnan(section.height[k])) continue;
      low = std::min(low, section.height[k]);
      high = std::max(high, section.height[k]);
    }
    if (!(low <= high)) {
      draw();
      continue;
    }
    run.push_back(frame.at(section.along(i), low));
    if (high > low) run.push_back(frame.at(section.along(i), high));
  }
  draw();
}

void addSpan(const engine::Section& section, double& low, double& high) {
  for (const double z : section.height)
    if (!std::isnan(z)) {
      low = std::min(low, z);
      high = std::max(high, z);
    }
}

// What a plot shows: lengths and heights, in millimetres.
PlotFrame frameOf(const SectionTool::Profiles& profiles) {
  PlotFrame frame;
  frame.length_mm = profiles.now.lengthMm();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  addSpan(profiles.now, low, high);
  addSpan(profiles.before, low, high);
  // A level section has a height of its own, not none.
  if (!(high > low)) high = low + std::max(1e-9, 1e-6 * std::abs(low));
  frame.low_mm = low;
  frame.high_mm = high;
  return frame;
}

// The profiles in a plot; before there are any, why.
void profilePlot(SectionTool& tool) {
  const float font = ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(std::max(40.0F, ImGui::GetContentRegionAvail().x),
                    kPlotLines * ImGui::GetTextLineHeightWithSpacing());
  ImGui::InvisibleButton("##profile", size);
  if (!tool.profiles()) {
    ImGui::GetWindowDrawList()->AddRectFilled(corner, ImVec2(corner.x + size.x, corner.y + size.y),
                                              colourOf(PanelColour::kField));
    const ImVec2 below = ImGui::GetCursorScreenPos();
    ImGui::SetCursorScreenPos(ImVec2(corner.x + 0.5F * font, corner.y + 0.5F * font));
    const auto chosen = tool.chosen();
    const bool one_end = chosen && tool.sections().at(*chosen).lengthMm() == 0.0;
    ImGui::TextUnformatted(tool.busy() ? tr("taking the section")
                           : one_end   ? tr("point at its other end: Q or Shift+Q")
                                       : tr("no height along this line"));
    ImGui::SetCursorScreenPos(below);
    return;
  }
  const SectionTool::Profiles& profiles = *tool.profiles();
  PlotFrame frame = frameOf(profiles);
  frame.low = {corner.x, corner.y + size.y - 2.0F};
  frame.size = {size.x, size.y - 4.0F};
  const double low = frame.low_mm;
  if (ImGui::IsItemActive())
    tool.moveCursor((ImGui::GetIO().MousePos.x - corner.x) / size.x * profiles.now.lengthMm());
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(corner, ImVec2(corner.x + size.x, corner.y + size.y), true);
  list.AddRectFilled(corner, ImVec2(corner.x + size.x, corner.y + size.y), colourOf(PanelColour::kChart));
  // As the plots of fettle section: the scan beneath, lighter and wider.
  drawProfile(frame, profiles.before, colourOf(PanelColour::kProfileBefore), 0.25F * font);
  drawProfile(frame, profiles.now,
              colourOf(profiles.before.size() > 0 ? PanelColour::kProfileNow : PanelColour::kProfile),
              0.1F * font);
  const auto drawStretch = [&](const std::pair<double, double>& ends, ImU32 colour) {
    for (const double at : {ends.first, ends.second}) {
      const float x = frame.at(at, low).x;
      list.AddLine(ImVec2(x, corner.y), ImVec2(x, corner.y + size.y), colour, 0.1F * font);
    }
  };
  drawStretch(tool.section()->cursors, colourOf(PanelColour::kCursors));
  if (tool.section()->angle) {
    // The line of each stretch needs its extent to be seen: shaded.
    for (const auto& [from, to] : {tool.section()->cursors, tool.section()->others})
      list.AddRectFilled(ImVec2(frame.at(std::min(from, to), low).x, corner.y),
                         ImVec2(frame.at(std::max(from, to), low).x, corner.y + size.y),
                         colourOf(PanelColour::kStretch));
    drawStretch(tool.section()->others, colourOf(PanelColour::kOtherCursors));
  }
  list.PopClipRect();
}

// Lines that figures take at a usual width, by what is ticked: their place is as high before they come, and while cursors
// move. More of them scrolls.
int figureLinesOf(const KeptSection& section) {
  constexpr int kShown = 2, kCursorLines = 3, kTitle = 1, kMost = 20;
  const int once = kCursorLines + 3 * int{section.line} + 2 * int{section.step} + 3 * int{section.groove} +
                   3 * int{section.arc} + 3 * int{section.angle} + 14 * int{section.roughness};
  return std::min(kShown + 2 * once + kTitle, kMost);
}

// What the plot shows, and figures one below the other: of the field, then of the scan.
void figureLines(const SectionTool& tool, const render::ShownUnit& length, const render::ShownUnit& height) {
  const auto write = [](const std::vector<SectionLine>& lines) {
    for (const SectionLine& line : lines)
      writeWrapped(
          fmt::format("{} {}", line.name.empty() ? " " : tr(std::string_view(line.name)), line.text));
  };
  beginPlace("##section figures", figureLinesOf(*tool.section()));
  if (tool.profiles()) {
    const PlotFrame frame = frameOf(*tool.profiles());
    writeWrapped(trFormat("shown {}, {:.5g} to {}", lengthText(frame.length_mm, length, 4),
                          frame.low_mm * height.per_unit, lengthText(frame.high_mm, height, 5)));
    write(tool.figures().now);
    const bool differs = !tool.figures().before.empty();
    writeIn(PanelColour::kMuted,
            differs ? tr("the same of the scan:") : tr("nothing differs from the scan here"));
    write(tool.figures().before);
  }
  endPlace();
}

// What is measured between the cursors.
void figureChoice(KeptSection& section, const render::ShownUnit& length) {
  ImGui::TextUnformatted(tr("between the cursors:"));
  tickBox("line##section", section.line,
          "Slope of the straight line through the heights, and what is left of them.");
  sameLineIfFits("step", ItemKind::kTick);
  tickBox("step##section", section.step, "Height of a step between two levels.");
  sameLineIfFits("groove", ItemKind::kTick);
  tickBox("groove##section", section.groove, "Depth and width of a groove, or height and width of a ridge.");
  sameLineIfFits("arc", ItemKind::kTick);
  tickBox("arc##section", section.arc, "Radius and middle of the circle through the heights.");
  sameLineIfFits("angle", ItemKind::kTick);
  tickBox("angle##section", section.angle,
          "From the line between the cursors to the one of a second stretch, with violet ends in the plot.");
  tickBox("roughness##section", section.roughness,
          "Ra, Rq, Rz and others between the cursors, of waves shorter than the cut-off beside it.");
  restOfLine();
  if (section.roughness)
    (void)typeLength("##section cutoff", section.cutoff_mm, 1e-9, 1e9, length);
  else
    noField("cut-off");
}

// Which of several, and another one.
void sectionChoice(const PanelContext& context, SectionTool& tool) {
  const std::size_t count = tool.sections().size();
  const std::string which = tool.chosen() ? trFormat("section {} of {}", *tool.chosen() + 1, count)
                                          : trFormat("a new section, {} kept", count);
  ImGui::TextUnformatted(count > 0 ? which.c_str() : tr("no section yet"));
  ImGui::BeginDisabled(count < 2 && (count == 0 || tool.chosen().has_value()));
  actionButton("Next##section", Action::kSectionNext, context.act);
  ImGui::EndDisabled();
  ImGui::BeginDisabled(!tool.chosen());
  sameLineIfFits("New");
  actionButton("New##section", Action::kSectionNew, context.act);
  sameLineIfFits("Remove");
  if (pressButton("Remove##section", "Drops the section that is shown.")) tool.remove();
  ImGui::EndDisabled();
  ImGui::BeginDisabled(count == 0);
  sameLineIfFits("Export ...");
  actionButton("Export ...##section", Action::kExportSections, context.act);
  ImGui::EndDisabled();
}

}  // namespace

void sectionPanel(const PanelContext& context, SectionTool& tool) {
  const engine::Grid& grid = context.client.field().grid();
  const render::ShownUnit length = ofMillimetres(context.units.length, grid.lateral_unit.mm);
  const render::ShownUnit height = ofMillimetres(context.units.height, grid.height_unit.mm);
  sectionChoice(context, tool);
  if (tool.section() == nullptr) {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextUnformatted(tr("a line over the surface: point at its ends and press Q and Shift+Q"));
    ImGui::PopTextWrapPos();
    if (pressButton("Along the middle row", "From the left to the right end of the field, to begin with.")) {
      const double y = 0.5 * (grid.height - 1) * grid.spacingYMm();
      tool.set({.from = {0.0, y}, .to = {(grid.width - 1) * grid.spacingXMm(), y}});
    }
    return;
  }
  KeptSection section = *tool.section();
  constexpr double kFar = 1e12;
  const double right = (grid.width - 1) * grid.spacingXMm(), top = (grid.height - 1) * grid.spacingYMm();
  beginFields();
  for (const auto& [name, id, value, most] :
       {std::tuple(textOf("from x"), "##section from x", &section.from.x, right),
        {textOf("from y"), "##section from y", &section.from.y, top},
        {textOf("to x"), "##section to x", &section.to.x, right},
        {textOf("to y"), "##section to y", &section.to.y, top}})
    (void)field(
        name,
        "The ends of the section in the scan's own coordinates. Their discs in the picture can be dragged.",
        // One that a session has beyond the field stays there until it is typed.
        [&, id = id, value = value, most = most] {
          return typeLength(id, *value, std::min(0.0, *value), std::max(most, *value), length);
        });
  (void)field(
      "mean across",
      "Heights within this width across the line are averaged: a wide one has less noise. 0: the line alone.",
      [&] { return typeLength("##section width", section.width_mm, 0.0, kFar, length); });
  endFields();
  figureChoice(section, length);
  tool.set(section);
  profilePlot(tool);
  figureLines(tool, length, height);
}

}  // namespace fettle::app
