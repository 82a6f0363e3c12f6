#include "app/view/workstation.h"

#include <fmt/format.h>
#include <imgui.h>

#include "app/view/panels/widgets.h"

namespace fettle::app {

void Workstation::deviationPanel() {
  if (measuring_.busy()) ImGui::TextDisabled("measuring ...");
  if (!deviation_) {
    ImGui::TextDisabled("nothing changed yet");
    return;
  }
  const std::string& unit = touch_->field().grid().height_unit.name;
  figure("largest", fmt::format("{:.4g} {}", deviation_->max_abs, unit));
  figure("rms", fmt::format("{:.4g} {}", deviation_->rms, unit));
  figure("99 % within", fmt::format("{:.4g} {}", deviation_->p99, unit));
  figure("Sq before, now", fmt::format("{:.4g}, {:.4g} {}", deviation_->sq_a, deviation_->sq_b, unit));
  figure("Sa before, now", fmt::format("{:.4g}, {:.4g} {}", deviation_->sa_a, deviation_->sa_b, unit));
}

}  // namespace fettle::app
