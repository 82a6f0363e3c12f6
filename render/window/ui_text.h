#pragma once

#include <vector>

#include "render/window/window.h"

struct ImDrawData;

namespace fettle::render {

/// Recovers the text of a frame's panels from their draw lists: letters are squares of the font's image, and
/// the position in that image identifies the letter. Letters that follow each other on a line with no more
/// than a space between them are one piece.
///
/// `drawn`: the result of ImGui::GetDrawData() after Render(), of fonts that are still loaded.
[[nodiscard]] std::vector<PanelText> textsOf(const ImDrawData& drawn);

}  // namespace fettle::render
