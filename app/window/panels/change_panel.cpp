#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

// Frequency of each change; bars grow with the logarithm of the count, so that one sample in a million is
// visible. `when_empty`: below it where nothing differs.
void drawHistogram(const engine::ChangeHistogram& histogram, const render::ShownUnit& unit,
                   const char* when_empty) {
  constexpr int kClasses = engine::ChangeHistogram::kClasses;
  const float height = 5.0F * ImGui::GetTextLineHeight();
  const float width = std::max(ImGui::GetContentRegionAvail().x, 64.0F);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("##histogram", ImVec2(width, height));
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + height), colourOf(PanelColour::kField),
                     3.0F);
  std::int64_t most = 1;
  for (const std::int64_t n : histogram.counts) most = std::max(most, n);
  const float bar = width / kClasses;
  const auto pointed = static_cast<int>((ImGui::GetIO().MousePos.x - corner.x) / bar);
  for (int i = 0; i < kClasses; ++i) {
    const std::int64_t n = histogram.counts[static_cast<std::size_t>(i)];
    if (n == 0) continue;
    const auto share =
        static_cast<float>(std::log1p(static_cast<double>(n)) / std::log1p(static_cast<double>(most)));
    const float x = corner.x + static_cast<float>(i) * bar;
    // Blue for lower, red for higher: the colours of the change on the surface.
    const ImU32 colour = colourOf(i < kClasses / 2 ? PanelColour::kLower : PanelColour::kHigher);
    list.AddRectFilled(ImVec2(x, corner.y + height * (1.0F - share)),
                       ImVec2(x + std::max(bar - 1.0F, 1.0F), corner.y + height), colour);
  }
  const float middle = corner.x + 0.5F * width;
  list.AddLine(ImVec2(middle, corner.y), ImVec2(middle, corner.y + height), colourOf(PanelColour::kMuted));
  if (hovered && pointed >= 0 && pointed < kClasses && histogram.reach > 0.0)
    valueTip(trFormat("{} to {}: {} samples", lengthText(histogram.lowEnd(pointed), unit, 3),
                      lengthText(histogram.lowEnd(pointed + 1), unit, 3),
                      histogram.counts[static_cast<std::size_t>(pointed)]));
  // The axis: its ends and zero.
  if (!(histogram.reach > 0.0)) {
    ImGui::TextDisabled("%s", when_empty);
    return;
  }
  const std::string reach = lengthText(histogram.reach, unit, 3), high = "+" + reach,
                    low = "-" + reach.substr(0, reach.find(' '));
  ImGui::TextDisabled("%s", low.c_str());
  ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + 0.5F * width - 0.5F * ImGui::CalcTextSize("0").x);
  ImGui::TextDisabled("0");
  ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + width - ImGui::CalcTextSize(high.c_str()).x);
  ImGui::TextDisabled("%s", high.c_str());
}

}  // namespace

void changePanel(const PanelContext& context, const ChangeFigures& change) {
  const auto& live = change.live();
  const render::ShownUnit unit = render::deviationUnit(context.client.field().grid().height_unit,
                                                       context.units.change, live ? live->max_abs : 0.0);
  // All rows from the first frame on: figures come into them, and what is below stays where it is.
  constexpr const char* kYet = "...";
  figure("largest", live ? lengthText(live->max_abs, unit) : kYet);
  figure("rms", live ? lengthText(live->rms, unit) : kYet);
  // Exact figures of the whole field follow after the stroke.
  const engine::Deviation* const exact = live ? change.exact(context.client.upright()) : nullptr;
  // Of a field that nothing was done to there is nothing to measure.
  const bool untouched = live && live->max_abs == 0.0;
  figure("99 % within", exact != nullptr ? lengthText(exact->p99, unit)
                        : untouched      ? lengthText(0.0, unit)
                                         : kYet);
  // Of heights, as the panel Measure and the colour bar have them.
  const auto pair = [&heights = context.units.height](double before, double now) {
    return fmt::format("{}, {}", lengthText(before, heights), lengthText(now, heights));
  };
  figure("Sq before, now", live ? pair(live->sq_original, live->sq) : kYet);
  figure("Sa before, now", exact != nullptr ? pair(exact->sa_a, exact->sa_b)
                           : live           ? pair(live->sa_original, live->sa)
                                            : kYet);
  const engine::ChangeHistogram histogram = live ? live->histogram : engine::ChangeHistogram{};
  const double share = live && live->samples > 0 ? 100.0 * static_cast<double>(histogram.unchanged) /
                                                       static_cast<double>(live->samples)
                                                 : 100.0;
  figure("unchanged", live ? fmt::format("{:.4g} %", share) : kYet);
  drawHistogram(histogram, unit, live ? tr("nothing has changed") : tr("measuring ..."));
}

}  // namespace fettle::app
