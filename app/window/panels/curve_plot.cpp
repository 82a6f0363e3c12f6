#include "app/window/panels/curve_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/widgets.h"

namespace fettle::app {
namespace {

constexpr int kCurveLines = 7;  // its height, in lines of text

struct CurveSpan {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  [[nodiscard]] bool any() const { return low <= high; }
  // A level curve has a height of its own, not none.
  void widen() {
    if (!(high > low)) high = low + std::max(1e-12, 1e-6 * std::abs(low));
  }
};

// As it is measured along an axis; no finite number where it has no place there.
double placeOn(CurvePlot::Scale scale, double value) {
  return scale == CurvePlot::Scale::kLinear ? value
         : value > 0.0                      ? std::log10(value)
                                            : std::numeric_limits<double>::quiet_NaN();
}
double valueAt(CurvePlot::Scale scale, double place) {
  return scale == CurvePlot::Scale::kLinear ? place : std::pow(10.0, place);
}

struct CurveFrame {
  ImVec2 corner, size;
  CurvePlot::Scale scale;
  CurveSpan x, y;

  [[nodiscard]] ImVec2 at(const glm::dvec2& place) const {
    return ImVec2(corner.x + static_cast<float>((place.x - x.low) / (x.high - x.low)) * size.x,
                  corner.y + size.y * (1.0F - static_cast<float>((place.y - y.low) / (y.high - y.low))));
  }
};

glm::dvec2 placeOf(const CurvePlot& plot, const glm::dvec2& point) {
  return {placeOn(plot.scale, point.x), placeOn(plot.scale, point.y)};
}

void drawCurve(const CurvePlot& plot, const PlotCurve& curve, const CurveFrame& frame) {
  std::vector<ImVec2> run;
  const auto draw = [&] {
    if (run.size() > 1)
      ImGui::GetWindowDrawList()->AddPolyline(run.data(), static_cast<int>(run.size()),
                                              colourOf(curve.colour), 0, curve.width * ImGui::GetFontSize());
    run.clear();
  };
  for (const glm::dvec2& point : curve.points) {
    const glm::dvec2 place = placeOf(plot, point);
    if (!std::isfinite(place.x) || !std::isfinite(place.y)) {
      draw();
      continue;
    }
    const ImVec2 at = frame.at(place);
    // No more places than pixels can show.
    if (run.empty() || std::abs(at.x - run.back().x) + std::abs(at.y - run.back().y) > 0.5F)
      run.push_back(at);
  }
  draw();
}

// Which curve is which: a piece of each before its name.
void legend(const PlotCurve& curve) {
  const float letter = ImGui::GetFontSize(), line = ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddLine(ImVec2(at.x, at.y + 0.5F * line),
                                      ImVec2(at.x + 1.5F * letter, at.y + 0.5F * line),
                                      colourOf(curve.colour), curve.width * letter);
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 2.0F * letter);
  writeIn(render::PanelColour::kMuted, curve.name);
}

// What each curve has where the cursor is.
void curveTip(const CurvePlot& plot, const CurveFrame& frame) {
  const double at = frame.x.low + (ImGui::GetIO().MousePos.x - frame.corner.x) / frame.size.x *
                                      (frame.x.high - frame.x.low);
  std::string text = fmt::format("{} {:.4g}", plot.x_name, valueAt(plot.scale, at));
  for (const PlotCurve& curve : plot.curves) {
    const glm::dvec2* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const glm::dvec2& point : curve.points) {
      const glm::dvec2 place = placeOf(plot, point);
      if (!std::isfinite(place.y) || !(std::abs(place.x - at) < least)) continue;
      least = std::abs(place.x - at);
      nearest = &point;
    }
    if (nearest != nullptr)
      text += fmt::format("\n{}{:.4g}", curve.name.empty() ? "" : curve.name + ": ", nearest->y);
  }
  valueTip(text);
}

}  // namespace

void curvePlot(const char* id, const CurvePlot& plot) {
  CurveFrame frame{ImGui::GetCursorScreenPos(),
                   ImVec2(std::max(40.0F, ImGui::GetContentRegionAvail().x),
                          kCurveLines * ImGui::GetTextLineHeightWithSpacing()),
                   plot.scale,
                   {},
                   {}};
  for (const PlotCurve& curve : plot.curves)
    for (const glm::dvec2& point : curve.points)
      if (const glm::dvec2 place = placeOf(plot, point); std::isfinite(place.x) && std::isfinite(place.y)) {
        frame.x.add(place.x);
        frame.y.add(place.y);
      }
  const bool any = frame.x.any();
  if (plot.low < plot.high && any) {
    frame.y.low = placeOn(plot.scale, plot.low);
    frame.y.high = placeOn(plot.scale, plot.high);
  }
  frame.x.widen();
  frame.y.widen();
  ImGui::InvisibleButton(id, frame.size);
  const ImVec2 end(frame.corner.x + frame.size.x, frame.corner.y + frame.size.y);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(frame.corner, end, true);
  list.AddRectFilled(frame.corner, end,
                     colourOf(any ? render::PanelColour::kChart : render::PanelColour::kField));
  if (any) {
    for (const PlotCurve& curve : plot.curves) drawCurve(plot, curve, frame);
  }
  list.PopClipRect();
  if (!any) return;
  if (ImGui::IsItemHovered()) curveTip(plot, frame);
  const auto shown = [&](const CurveSpan& span) {
    return trFormat("{:.4g} to {:.4g}", valueAt(plot.scale, span.low), valueAt(plot.scale, span.high));
  };
  writeIn(render::PanelColour::kMuted, fmt::format("{} {}", plot.x_name, shown(frame.x)));
  writeIn(render::PanelColour::kMuted, fmt::format("{} {}", plot.y_name, shown(frame.y)));
  if (plot.curves.size() > 1)
    for (const PlotCurve& curve : plot.curves) legend(curve);
}

}  // namespace fettle::app
