#pragma once

#include <imgui.h>

#include "app/window/questions.h"

namespace fettle::app {

/// A button of a dialog with a key.
inline bool dialogButton(const char* name, Questions& questions, render::Key key) {
  return ImGui::Button(name) || questions.take(key);
}

}  // namespace fettle::app
