#include "app/window/workstation.h"

#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>
#include <glm/geometric.hpp>

#include "app/window/panels/widgets.h"

namespace fettle::app {
namespace {

// Why the surface at rest is not drawn within the screen error asked for; of the panel that is farthest off.
std::string limitOf(const std::vector<render::PanelDetail>& panels, bool more_comes) {
  const auto worst = std::max_element(panels.begin(), panels.end(),
                                      [](const auto& a, const auto& b) { return a.bound_px < b.bound_px; });
  if (worst == panels.end() || more_comes) return {};
  if (worst->limit == render::DetailLimit::kMemory) return ", device memory is full";
  if (worst->limit == render::DetailLimit::kVertices) return ", all vertices used";
  return {};
}

}  // namespace

void Workstation::statusPanel() {
  const haptic::TimingFigures late = touch_->timing().lateness.figures();
  const haptic::LoopState state = touch_->state();
  const haptic::TimingFigures edit = touch_->latency().histogram().figures();
  figure("loop", fmt::format("{:.0f} of {:.0f} Hz", touch_->measuredRate(), touch_->rate()));
  figure("late p50, p99",
         fmt::format("{:.0f}, {:.0f} us", microseconds(late.p50_ns), microseconds(late.p99_ns)));
  figure("missed ticks", fmt::format("{}", touch_->timing().missed.load(std::memory_order_relaxed)));
  figure("force", fmt::format("{:.2f} N{}", glm::length(state.force_n), state.contact ? ", touching" : ""));
  figure("frame", fmt::format("GPU {:.1f} ms, CPU {:.1f}", figures_.device_ms, frame_ms_));
  figure("surface", fmt::format("{} triangles, {:.2f} px{}", figures_.triangles, figures_.bound_px,
                                limitOf(figures_.panels, refinement_.owed())));
  figure("uploaded",
         fmt::format("{} tiles, {}", tiles_uploaded_, bytesText(static_cast<double>(bytes_uploaded_))));
  figure("last upload",
         fmt::format("{} tiles, {}, {:.2f} ms", figures_.upload.tiles,
                     bytesText(static_cast<double>(figures_.upload.bytes)), figures_.upload.ms));
  figure("first picture",
         fmt::format("{:.1f} s, read in {:.1f}", 1e-3 * opening_.seen_ms, 1e-3 * opening_.read_ms));
  figure("edit to pixel",
         edit.count == 0 ? std::string("-")
                         : fmt::format("{:.0f} ms; p50 {:.0f}, p99 {:.0f}", touch_->latency().lastMs(),
                                       1e-3 * microseconds(edit.p50_ns), 1e-3 * microseconds(edit.p99_ns)));
}

}  // namespace fettle::app
