#pragma once

#include <imgui.h>

namespace fettle::app {

/// A value that is dragged along its field, or typed after a double click on it (or a click with Ctrl), and stays between `low` and `high`. True when it
/// changed. `format`: as of printf, in the language of the window already.
bool slider(const char* id, float& value, float low, float high, const char* format,
            ImGuiSliderFlags flags = ImGuiSliderFlags_None);
bool slider(const char* id, int& value, int low, int high, const char* format);

}  // namespace fettle::app
