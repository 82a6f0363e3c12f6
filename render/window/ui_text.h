#pragma once

#include <vector>

#include "render/window/window.h"

struct ImDrawData;

namespace fettle::render {

/// Reads the text of a frame's panels back from what they draw: the letters are squares cut from the font's
/// image, and where a square was cut says which letter it is. Letters that follow each other on a line with
/// no more than a space between them are one piece.
///
/// `drawn`: what ImGui::GetDrawData() gave after Render(), of fonts that are still loaded.
[[nodiscard]] std::vector<PanelText> textsOf(const ImDrawData& drawn);

}  // namespace fettle::render
