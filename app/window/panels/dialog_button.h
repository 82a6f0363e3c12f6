#pragma once

#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/questions.h"

namespace fettle::app {

/// A button of a dialog with a key; `name` as it stands in the source.
inline bool dialogButton(const char* name, Questions& questions, render::Key key) {
  return ImGui::Button(labelOf(name)) || questions.take(key);
}

}  // namespace fettle::app
