#include "app/window/panels/slider.h"

#include <utility>

namespace fettle::app {

namespace {

// ImGui types into a slider that is clicked with Ctrl; numbers elsewhere are typed after a double click.
template <class Slider>
bool typedAfterDoubleClick(const Slider& slider) {
  bool& control = ImGui::GetIO().KeyCtrl;
  const bool was = std::exchange(control, control || ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left));
  const bool changed = slider();
  control = was;
  return changed;
}

}  // namespace

bool slider(const char* id, float& value, float low, float high, const char* format, ImGuiSliderFlags flags) {
  return typedAfterDoubleClick([&] {
    return ImGui::SliderFloat(id, &value, low, high, format, flags | ImGuiSliderFlags_AlwaysClamp);
  });
}

bool slider(const char* id, int& value, int low, int high, const char* format) {
  return typedAfterDoubleClick(
      [&] { return ImGui::SliderInt(id, &value, low, high, format, ImGuiSliderFlags_AlwaysClamp); });
}

}  // namespace fettle::app
