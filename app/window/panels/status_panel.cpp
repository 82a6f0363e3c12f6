#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>
#include <glm/geometric.hpp>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

// Why the surface at rest is not drawn within the requested screen error; of the panel with the largest
// error.
std::string limitOf(const std::vector<render::PanelDetail>& panels, bool more_comes) {
  const auto worst = std::max_element(panels.begin(), panels.end(),
                                      [](const auto& a, const auto& b) { return a.bound_px < b.bound_px; });
  if (worst == panels.end() || more_comes) return {};
  if (worst->limit == render::DetailLimit::kMemory) return tr(", device memory is full");
  if (worst->limit == render::DetailLimit::kVertices) return tr(", all vertices used");
  return {};
}

}  // namespace

void statusPanel(const PanelContext& context, const WindowPicture& picture, const OpeningTimes& times) {
  LoopClient& client = context.client;
  const render::FrameStatistics& figures = picture.figures();
  const DrawFigures& draw = picture.drawFigures();
  const haptic::TimingFigures late = client.timing().lateness.figures();
  const haptic::LoopState state = client.state();
  const haptic::TimingFigures edit = client.latency().histogram().figures();
  figure("loop", trFormat("{:.0f} of {:.0f} Hz", client.measuredRate(), client.rate()));
  figure("late p50, p99",
         trFormat("{:.0f}, {:.0f} us", haptic::microseconds(late.p50_ns), haptic::microseconds(late.p99_ns)));
  figure("missed ticks", fmt::format("{}", client.timing().missed.load(std::memory_order_relaxed)));
  figure("force",
         fmt::format("{:.2f} N{}", glm::length(state.force_n), state.contact ? tr(", touching") : ""));
  figure("frame", trFormat("GPU {:.1f} ms, CPU {:.1f}", figures.device_ms, draw.last_ms));
  figure("surface", trFormat("{} triangles, {:.2f} px{}", figures.triangles, figures.bound_px,
                             limitOf(figures.panels, picture.refining())));
  figure("uploaded",
         trFormat("{} tiles, {}", draw.tiles_uploaded, bytesText(static_cast<double>(draw.bytes_uploaded))));
  figure("last upload", trFormat("{} tiles, {}, {:.2f} ms", figures.upload.tiles,
                                 bytesText(static_cast<double>(figures.upload.bytes)), figures.upload.ms));
  figure("first picture", trFormat("{:.1f} s, read in {:.1f}", 1e-3 * times.seen_ms, 1e-3 * times.read_ms));
  figure("edit to pixel",
         edit.count == 0
             ? std::string("-")
             : trFormat("{:.0f} ms; p50 {:.0f}, p99 {:.0f}", client.latency().lastMs(),
                        1e-3 * haptic::microseconds(edit.p50_ns), 1e-3 * haptic::microseconds(edit.p99_ns)));
}

}  // namespace fettle::app
