#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

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

// `length`, `height`: in which its ranges are written, below it.
void profilePlot(SectionTool& tool, const SectionTool::Profiles& profiles, const render::ShownUnit& length,
                 const render::ShownUnit& height) {
  const float font = ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(std::max(40.0F, ImGui::GetContentRegionAvail().x),
                    kPlotLines * ImGui::GetTextLineHeightWithSpacing());
  ImGui::InvisibleButton("##profile", size);
  PlotFrame frame{{corner.x, corner.y + size.y - 2.0F}, {size.x, size.y - 4.0F}, profiles.now.lengthMm()};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  addSpan(profiles.now, low, high);
  addSpan(profiles.before, low, high);
  // A level section has a height of its own, not none.
  if (!(high > low)) high = low + std::max(1e-9, 1e-6 * std::abs(low));
  frame.low_mm = low;
  frame.high_mm = high;
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
  figure("shown", fmt::format("{}, {:.5g} to {}", lengthText(frame.length_mm, length, 4),
                              frame.low_mm * height.per_unit, lengthText(frame.high_mm, height, 5)));
}

// Figures one below the other: of the field, and in a lighter shade those of the scan.
void figureLines(const SectionTool::Figures& figures) {
  const auto write = [](const std::vector<SectionLine>& lines) {
    for (const SectionLine& line : lines) {
      ImGui::PushTextWrapPos(0.0F);
      ImGui::TextUnformatted((line.name.empty() ? "  " + line.text : line.name + " " + line.text).c_str());
      ImGui::PopTextWrapPos();
    }
  };
  write(figures.now);
  if (figures.before.empty()) return;
  ImGui::Separator();
  ImGui::TextUnformatted("the same of the scan");
  write(figures.before);
}

// What is measured between the cursors.
void figureChoice(KeptSection& section, const render::ShownUnit& length) {
  ImGui::TextUnformatted("between the cursors:");
  ImGui::Checkbox("line##section", &section.line);
  for (const auto& [name, id, wanted] : {std::tuple("step", "step##section", &section.step),
                                         {"groove", "groove##section", &section.groove},
                                         {"arc", "arc##section", &section.arc},
                                         {"angle", "angle##section", &section.angle},
                                         {"roughness", "roughness##section", &section.roughness}}) {
    sameLineIfFits(name, ItemKind::kTick);
    ImGui::Checkbox(id, wanted);
  }
  if (section.angle) {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextUnformatted(
        "the angle is that from the line between them to the one of the second stretch, with violet ends");
    ImGui::PopTextWrapPos();
  }
  if (!section.roughness) return;
  beginFields();
  (void)field("cut-off",
              [&] { return typeLength("##section cutoff", section.cutoff_mm, 1e-9, 1e9, length); });
  endFields();
}

// Which of several, and another one.
void sectionChoice(const PanelContext& context, SectionTool& tool) {
  const std::size_t count = tool.sections().size();
  const std::string which = tool.chosen() ? fmt::format("section {} of {}", *tool.chosen() + 1, count)
                                          : fmt::format("a new section, {} kept", count);
  ImGui::TextUnformatted(count > 0 ? which.c_str() : "no section yet");
  ImGui::BeginDisabled(count < 2 && (count == 0 || tool.chosen().has_value()));
  actionButton("Next##section", Action::kSectionNext, context.act);
  ImGui::EndDisabled();
  ImGui::BeginDisabled(!tool.chosen());
  sameLineIfFits("New");
  actionButton("New##section", Action::kSectionNew, context.act);
  sameLineIfFits("Remove");
  if (ImGui::Button("Remove##section")) tool.remove();
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
    ImGui::TextUnformatted("a line over the surface: point at its ends and press Q and Shift+Q");
    ImGui::PopTextWrapPos();
    if (ImGui::Button("Along the middle row")) {
      const double y = 0.5 * (grid.height - 1) * grid.spacingYMm();
      tool.set({.from = {0.0, y}, .to = {(grid.width - 1) * grid.spacingXMm(), y}});
    }
    return;
  }
  KeptSection section = *tool.section();
  constexpr double kFar = 1e12;
  beginFields();
  for (const auto& [name, id, value] : {std::tuple("from x", "##section from x", &section.from.x),
                                        {"from y", "##section from y", &section.from.y},
                                        {"to x", "##section to x", &section.to.x},
                                        {"to y", "##section to y", &section.to.y}})
    (void)field(name, [&, id = id, value = value] { return typeLength(id, *value, -kFar, kFar, length); });
  (void)field("mean across",
              [&] { return typeLength("##section width", section.width_mm, 0.0, kFar, length); });
  endFields();
  figureChoice(section, length);
  tool.set(section);
  if (!tool.profiles()) {
    // The place of the plot.
    beginPlace("##no profile", kPlotLines);
    ImGui::TextUnformatted(tool.busy() ? "taking the section" : "no height along this line");
    endPlace();
    return;
  }
  profilePlot(tool, *tool.profiles(), length, height);
  figureLines(tool.figures());
}

}  // namespace fettle::app
