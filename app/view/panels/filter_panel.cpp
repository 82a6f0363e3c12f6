#include "app/view/workstation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/view/panels/widgets.h"

namespace fettle::app {

void Workstation::filterPanel() {
  engine::FilterSpec& spec = filters_.spec;
  const char* names[] = {"Box", "Gaussian", "Median"};
  int kind = static_cast<int>(spec.kind);
  if (ImGui::Combo("filter", &kind, names, 3)) spec.kind = static_cast<engine::FilterKind>(kind);
  if (ImGui::InputInt("window", &spec.window, 2, 10))
    spec.window = std::clamp(spec.window | 1, 1, engine::FilterSpec::kMaxWindow);
  if (ImGui::InputInt("passes", &spec.passes, 1, 5))
    spec.passes = std::clamp(spec.passes, 1, engine::FilterSpec::kMaxPasses);
  if (spec.kind == engine::FilterKind::kGaussian)
    if (ImGui::InputDouble("sigma", &spec.sigma, 0.1, 1.0, spec.sigma > 0.0 ? "%.2f samples" : "binomial"))
      spec.sigma = std::clamp(spec.sigma, 0.0, 1000.0);
  const engine::Grid& grid = touch_->field().grid();
  ImGui::TextDisabled("%s", fmt::format("= {:.4g} x {:.4g} mm", spec.window * grid.spacingXMm(),
                                        spec.window * grid.spacingYMm())
                                .c_str());
  int scope = static_cast<int>(spec.scope);
  ImGui::RadioButton("keep marks", &scope, 0);
  ImGui::SameLine();
  ImGui::RadioButton("only marks", &scope, 1);
  spec.scope = static_cast<engine::FilterScope>(scope);
  bool limited = spec.max_change.has_value();
  if (ImGui::Checkbox("max change", &limited)) spec.max_change = limited ? std::optional(0.05) : std::nullopt;
  if (spec.max_change) {
    ImGui::SameLine();
    const std::string unit = "%.4g " + grid.height_unit.name;
    ImGui::InputDouble("##maxchange", &*spec.max_change, 0.0, 0.0, unit.c_str());
    spec.max_change = std::isfinite(*spec.max_change) ? std::max(*spec.max_change, 0.0) : 0.0;
  }
  if (filters_.computing() || filters_.applying()) {
    ImGui::ProgressBar(static_cast<float>(filters_.progress()), ImVec2(-80.0F, 0.0F),
                       filters_.applying() ? "applying" : "filtering");
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) filters_.cancel(*touch_);
  } else {
    if (ImGui::Button("Preview")) act(Action::kFilterPreview);
    ImGui::SameLine();
    if (ImGui::Button("Add variant")) filters_.compute(*touch_, FilterPreview::Keep::kBeside);
    ImGui::SameLine();
    if (ImGui::Button("Apply")) filters_.apply(*touch_);
  }
  std::optional<std::size_t> dropped;
  for (std::size_t i = 0; i < filters_.variants().size(); ++i) {
    const FilterPreview::Variant& v = filters_.variants()[i];
    if (ImGui::SmallButton(fmt::format("x##{}", i).c_str())) dropped = i;
    ImGui::SameLine();
    ImGui::TextUnformatted(fmt::format("{}: {} changed, max {:.3g} {}", filterName(v.spec),
                                       v.result.report.changed, v.result.report.max_change,
                                       grid.height_unit.name)
                               .c_str());
  }
  if (dropped) filters_.drop(*dropped);
  if (!filters_.variants().empty()) ImGui::Checkbox("split line", &display_.split);
}

}  // namespace fettle::app
