#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;
using render::Quantity;
using RuleKind = RangeRule::Kind;

constexpr int kBars = 72;

ImU32 ofLight(const glm::vec3& light) {
  const auto code = [](float channel) {
    return static_cast<int>(std::lround(255.0 * render::srgbFromLinear(static_cast<double>(channel))));
  };
  return IM_COL32(code(light.x), code(light.y), code(light.z), 255);
}

// The values from end to end of the histogram: what occurs, single spikes left out, with the range inside and near
// enough to its ends that both handles can be dragged.
render::ValueRange axisOf(const render::ValueSample& values, Quantity quantity,
                          const render::ValueRange& range) {
  const double width = range.high - range.low;
  if (quantity == Quantity::kOneSign) {
    const double usual = values.empty() ? 0.0 : values.symmetric(0.998).high;
    const double end = std::clamp(usual, 1.3 * width, 6.0 * width);
    return range.low < 0.0 ? render::ValueRange{-end, 0.0} : render::ValueRange{0.0, end};
  }
  if (quantity == Quantity::kDeviation) {
    const double usual = values.empty() ? 0.0 : values.symmetric(0.998).high;
    const double end = std::clamp(usual, 0.65 * width, 3.0 * width);
    return {-end, end};
  }
  const render::ValueRange usual = values.empty() ? range : values.middle(0.998);
  const double margin = 0.06 * std::max(width, usual.high - usual.low);
  return {std::min(range.low, usual.low) - margin, std::max(range.high, usual.high) + margin};
}

// Everything about the histogram of a frame.
struct Chart {
  ImVec2 corner, size;
  render::ValueRange axis, range;
  Quantity quantity;

  [[nodiscard]] float xOf(double value) const {
    return corner.x +
           size.x * static_cast<float>(std::clamp((value - axis.low) / (axis.high - axis.low), 0.0, 1.0));
  }
  [[nodiscard]] double valueAt(double x) const {
    return axis.low + (axis.high - axis.low) * std::clamp((x - corner.x) / size.x, 0.0, 1.0);
  }
};

// Bars grow with the logarithm of the number, so that one sample in a million is visible, and have the colours of
// the surface.
void drawBars(const Chart& chart, const render::ValueSample& values, const render::Colouring& colouring) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const render::ColourTable table = render::tableOf(colouring, chart.quantity, chart.range);
  const auto from = [&](int bar) {
    return chart.axis.low + (chart.axis.high - chart.axis.low) * bar / double{kBars};
  };
  std::array<double, kBars> counts{};
  double most = 1.0;
  auto at = std::lower_bound(values.sorted.begin(), values.sorted.end(), chart.axis.low);
  for (int i = 0; i < kBars; ++i) {
    const auto end = i + 1 == kBars ? std::upper_bound(at, values.sorted.end(), chart.axis.high)
                                    : std::lower_bound(at, values.sorted.end(), from(i + 1));
    counts[static_cast<std::size_t>(i)] = static_cast<double>(end - at);
    most = std::max(most, counts[static_cast<std::size_t>(i)]);
    at = end;
  }
  const float bar = chart.size.x / kBars, bottom = chart.corner.y + chart.size.y;
  for (int i = 0; i < kBars; ++i) {
    const double n = counts[static_cast<std::size_t>(i)];
    if (n == 0.0) continue;
    const auto share = static_cast<float>(std::log1p(n) / std::log1p(most));
    const float x = chart.corner.x + static_cast<float>(i) * bar;
    const float top = bottom - chart.size.y * share;
    list.AddRectFilled(ImVec2(x, top), ImVec2(x + bar, bottom),
                       ofLight(render::mapped(table, 0.5 * (from(i) + from(i + 1)), chart.range)));
    // Some of these colours are as light, or as dark, as the ground.
    list.AddLine(ImVec2(x, top), ImVec2(x + bar, top), colourOf(PanelColour::kOutline));
  }
}

void drawHandle(const Chart& chart, double value, bool held) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float x = std::round(chart.xOf(value)), bottom = chart.corner.y + chart.size.y;
  const float half = 0.3F * ImGui::GetFontSize();
  const ImU32 ink = colourOf(held ? PanelColour::kTick : PanelColour::kHandle);
  list.AddLine(ImVec2(x, chart.corner.y), ImVec2(x, bottom), colourOf(PanelColour::kHandleRim), 3.0F);
  list.AddLine(ImVec2(x, chart.corner.y), ImVec2(x, bottom), ink, 1.0F);
  list.AddTriangleFilled(ImVec2(x - half, bottom + half), ImVec2(x + half, bottom + half),
                         ImVec2(x, bottom - half), ink);
}

// The ends after the handle was dragged to `x`; a pixel remains between two of them.
render::ValueRange draggedTo(const Chart& chart, bool high, double x) {
  const double value = chart.valueAt(x), least = (chart.axis.high - chart.axis.low) / chart.size.x;
  if (ColourRange::isChange(chart.quantity)) {
    const double limit = std::max(std::abs(value), least);
    const bool one = chart.quantity == Quantity::kOneSign;
    return {one && chart.range.low >= 0.0 ? 0.0 : -limit, one && chart.range.high <= 0.0 ? 0.0 : limit};
  }
  return high ? render::ValueRange{chart.range.low, std::max(value, chart.range.low + least)}
              : render::ValueRange{std::min(value, chart.range.high - least), chart.range.high};
}

constexpr float kHandleFoot = 0.4F;  // of a handle, below the bars, in heights of a letter

// With the feet of its handles.
ImVec2 histogramSize() {
  return ImVec2(std::max(ImGui::GetContentRegionAvail().x, 64.0F),
                5.0F * ImGui::GetTextLineHeight() + kHandleFoot * ImGui::GetFontSize());
}

void histogram(const render::ValueSample& values, Quantity quantity, const render::ValueRange& range,
               const render::ShownUnit& unit, ColourRange& colours, Display& display,
               WindowPicture& picture) {
  Chart chart;
  chart.quantity = quantity;
  chart.range = range;
  chart.axis = colours.drag ? colours.drag->axis : axisOf(values, quantity, range);
  chart.corner = ImGui::GetCursorScreenPos();
  chart.size = ImVec2(histogramSize().x, histogramSize().y - kHandleFoot * ImGui::GetFontSize());
  ImGui::InvisibleButton("##values", histogramSize());
  const double x = ImGui::GetIO().MousePos.x;
  if (ImGui::IsItemActivated())
    colours.drag = {chart.axis, std::abs(x - chart.xOf(range.high)) <= std::abs(x - chart.xOf(range.low))};
  if (!ImGui::IsItemActive()) colours.drag.reset();
  if (colours.drag && ImGui::GetIO().MouseDelta.x != 0.0F) {
    chart.range = draggedTo(chart, colours.drag->high, x);
    colours.type(display, picture.shown(), chart.range);
    picture.requestRedraw();
  }
  ImGui::GetWindowDrawList()->AddRectFilled(
      chart.corner, ImVec2(chart.corner.x + chart.size.x, chart.corner.y + chart.size.y),
      colourOf(PanelColour::kField), 3.0F);
  drawBars(chart, values, colours.colouring(display, quantity));
  // Zero, where all lies on one side of it, stays an end.
  const bool one = quantity == Quantity::kOneSign;
  if (!one || chart.range.low < 0.0) drawHandle(chart, chart.range.low, colours.drag && !colours.drag->high);
  if (!one || chart.range.low >= 0.0) drawHandle(chart, chart.range.high, colours.drag && colours.drag->high);
  colours.handles = ColourRange::Handles{chart.xOf(chart.range.low), chart.xOf(chart.range.high),
                                         chart.corner.y + 0.5 * chart.size.y};
  if (ImGui::IsItemHovered() && !colours.drag) {
    const double value = chart.valueAt(x);
    valueTip(trFormat("{}: {:.3g} % lie below, drag the ends of the colours", lengthText(value, unit),
                      100.0 * values.within(-HUGE_VAL, value)));
  }
}

void ruleFields(RangeRule& rule, Quantity quantity, const render::ValueSample* values,
                const render::ValueRange& range, WindowPicture& picture) {
  int kind = static_cast<int>(rule.kind);
  // "by hand" is what dragging and typing leave behind.
  const bool by_hand = rule.kind == RuleKind::kTyped;
  const char* const says =
      ColourRange::isChange(quantity)
          ? tr("usual: six times the median of what changed, or all but half a percent of it\na share: so "
               "many "
               "of "
               "the changed samples\nall: up to the largest change")
          : tr("usual: all but single spikes\na share: the middle of the values\nall: from the lowest to the "
               "highest");
  if (field("range", says, [&] {
        return by_hand ? chooseWord("##range", kind, {"usual", "a share", "all", "by hand"})
                       : chooseWord("##range", kind, {"usual", "a share", "all"});
      })) {
    rule.kind = static_cast<RuleKind>(kind);
    if (rule.kind == RuleKind::kAutomatic) picture.refreshRanges();
    picture.requestRedraw();
  }
  if (rule.kind == RuleKind::kShare) {
    double percent = 100.0 * rule.share;
    if (field("share", "So much of all values lies within the colours; the rest has the colour of an end.",
              [&] { return typeNumber("##share", percent, 1.0, 100.0, "%.4g %%"); })) {
      rule.share = 0.01 * percent;
      picture.requestRedraw();
    }
  }
  const bool counted = values != nullptr && !values->empty();
  figure("in the range", !counted
                             ? std::string("...")
                             : fmt::format("{:.4g} %{}", 100.0 * values->within(range.low, range.high),
                                           quantity == Quantity::kDeviation ? tr(" of the changes") : ""));
  // Colours do not change while a brush works, nor after: what was found when they were switched on, or by the last step of
  // another kind, stays.
  ImGui::BeginDisabled(rule.kind != RuleKind::kAutomatic);
  if (pressButton(
          "Find the range again",
          "Colours keep their range under a brush and follow other steps; this takes it from the values as "
          "they are now.")) {
    picture.refreshRanges();
    picture.requestRedraw();
  }
  ImGui::EndDisabled();
}

void rangeEnds(const render::ValueRange& range, Quantity quantity, const render::ShownUnit& unit,
               ColourRange& colours, Display& display, WindowPicture& picture) {
  render::ValueRange ends = range;
  bool changed = false;
  if (ColourRange::isChange(quantity)) {
    double limit = std::max(std::abs(ends.low), std::abs(ends.high));
    changed = field("up to", "The change at which the colours end, up and down.",
                    [&] { return typeLength("##limit", limit, 1e-30, 1e30, unit); });
    ends = {-limit, limit};
  } else {
    changed |= field("highest", "The value with the last colour; what lies above has it, too.",
                     [&] { return typeLength("##highest", ends.high, -1e30, 1e30, unit); });
    changed |= field("lowest", "The value with the first colour; what lies below has it, too.",
                     [&] { return typeLength("##lowest", ends.low, -1e30, 1e30, unit); });
    // Past the other end: that one is moved along.
    if (!(ends.low < ends.high)) {
      const double width = range.high - range.low;
      if (ends.high != range.high)
        ends.low = ends.high - width;
      else
        ends.high = ends.low + width;
    }
  }
  if (!changed) return;
  colours.type(display, picture.shown(), ends);
  picture.requestRedraw();
}

void mapField(Quantity quantity, Display& display, WindowPicture& picture) {
  constexpr const char* kSays = textOf(
      "The colour map of heights. Automatic: viridis; cividis is seen alike by the colour-blind. What "
      "has a sign, as a change or a deviation, has blue below zero, white at it and red above.");
  if (quantity == Quantity::kDeviation) {
    (void)field("colours", kSays, [] {
      noField("diverging, white at zero");
      return false;
    });
    return;
  }
  int map = static_cast<int>(display.map);
  if (!field("colours", kSays, [&] {
        return chooseWord("##colours", map, {"automatic", "viridis", "cividis", "grey", "diverging"});
      }))
    return;
  display.map = static_cast<render::ColourMap>(map);
  picture.requestRedraw();
}

}  // namespace

void colourPanel(const PanelContext& context, Display& display, ColourRange& colours,
                 WindowPicture& picture) {
  actionTick("colours show the change", display.deviation, Action::kDeviation, context.act);
  const Quantity quantity = ColourRange::quantityOf(picture.shown());
  const bool change = ColourRange::isChange(quantity);
  const render::ValueRange range = picture.figures().range;
  if (!(range.low < range.high)) return;  // no frame yet
  const engine::Grid& grid = context.client.field().grid();
  const render::ShownUnit unit =
      change ? render::deviationUnit(grid.height_unit, context.units.change,
                                     std::max(std::abs(range.low), std::abs(range.high)))
             : context.units.height;
  const render::ValueSample* const values = colours.sample(quantity);
  if (values != nullptr) {
    histogram(*values, quantity, range, unit, colours, display, picture);
  } else {
    const ImVec2 from = ImGui::GetCursorPos();
    ImGui::TextDisabled("%s", tr("counting ..."));
    ImGui::SetCursorPos(from);
    ImGui::Dummy(histogramSize());
  }
  beginFields();
  ruleFields(ColourRange::ruleOf(display, quantity), quantity, values, range, picture);
  rangeEnds(range, quantity, unit, colours, display, picture);
  if (quantity == Quantity::kDeviation &&
      field("as zero up to",
            "A tolerance: smaller changes are white, larger ones differ from it at once. 0: none.",
            [&] { return typeLength("##tolerance", colours.typed.tolerance, 0.0, 1e30, unit); }))
    picture.requestRedraw();
  mapField(quantity, display, picture);
  endFields();
  if (tickBox("in steps", display.colour_steps,
              "Each stretch of values has one colour, as on a map; else colours blend."))
    picture.requestRedraw();
  sameLineIfFits("contour lines", ItemKind::kTick);
  actionTick("contour lines", display.contours, Action::kContours, context.act);
  ImGui::BeginDisabled(!display.contours);
  beginFields();
  double& every = change ? colours.typed.change_contours : colours.typed.height_contours;
  double shown = picture.figures().contour_step;
  if (field("a line every", "Height between two contour lines. 0: at the steps of the colour bar.",
            [&] { return typeLength("##every", shown, 0.0, 1e30, unit); })) {
    every = shown;
    picture.requestRedraw();
  }
  endFields();
  ImGui::EndDisabled();
}

}  // namespace fettle::app
