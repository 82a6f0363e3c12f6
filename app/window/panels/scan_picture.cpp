#include "app/window/panels/scan_picture.h"

#include <algorithm>
#include <cmath>

namespace fettle::app {

std::optional<PictureCursor> scanPicture(const ScanThumbnail& picture, ImVec2 size, int step) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Dummy(size);
  if (picture.empty() || !picture.grid) return std::nullopt;
  const float cell =
      std::min(size.x / static_cast<float>(picture.width), size.y / static_cast<float>(picture.height));
  const ImVec2 at(corner.x + 0.5F * (size.x - cell * static_cast<float>(picture.width)),
                  corner.y + 0.5F * (size.y - cell * static_cast<float>(picture.height)));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  // Equal neighbours in a row are one rectangle. Edges are whole pixels: no seam between two.
  const auto edge = [&](float from, int pixel) {
    return std::round(from + cell * static_cast<float>(pixel));
  };
  for (int y = 0; y < picture.height; y += step)
    for (int x = 0; x < picture.width;) {
      const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width);
      const std::uint32_t colour = picture.colours[row + static_cast<std::size_t>(x)];
      int end = x + step;
      while (end < picture.width && picture.colours[row + static_cast<std::size_t>(end)] == colour)
        end += step;
      if (colour != 0U)
        list.AddRectFilled(
            ImVec2(edge(at.x, x), edge(at.y, y)),
            ImVec2(edge(at.x, std::min(end, picture.width)), edge(at.y, std::min(y + step, picture.height))),
            colour);
      x = end;
    }
  if (!ImGui::IsItemHovered()) return std::nullopt;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const float px = (mouse.x - at.x) / cell, py = (mouse.y - at.y) / cell;
  const int x = static_cast<int>(std::floor(px)), y = static_cast<int>(std::floor(py));
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return std::nullopt;
  const engine::Grid& grid = *picture.grid;
  const auto sample = [](float pixel, int pixels, std::int32_t samples) {
    return std::clamp(static_cast<double>(pixel) / pixels * samples - 0.5, 0.0, samples - 1.0);
  };
  return PictureCursor{sample(px, picture.width, grid.width),
                       grid.height - 1.0 - sample(py, picture.height, grid.height),
                       picture.heights[static_cast<std::size_t>(y * picture.width + x)]};
}

}  // namespace fettle::app
