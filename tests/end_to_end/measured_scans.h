#pragma once

// Scans whose figures are known, for the tests of levels and parameters.

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include <fmt/format.h>

namespace fettle::tests {

// A tilted plate of 60 x 50 samples, 0.1 mm apart, with a wave of 2 um along x, even about its middle so that no plane
// follows it. ESRI ASCII, in millimetres.
inline void writeWave(const std::string& path) {
  std::ofstream out(path);
  out << "ncols 60\nnrows 50\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
  for (int r = 49; r >= 0; --r) {
    for (int c = 0; c < 60; ++c)
      out << 0.01 * c - 0.005 * r + 0.002 * std::cos(2.0 * std::numbers::pi * (c - 29.5) / 12.0) << ' ';
    out << '\n';
  }
}

// Grid of a height by column and row, of cells of 0.05 mm.
inline void writeHeights(const std::string& path, int columns, int rows,
                         const std::function<double(int, int)>& height) {
  std::ofstream out(path);
  out.precision(9);
  out << fmt::format("ncols {}\nnrows {}\nxllcenter 0\nyllcenter 0\ncellsize 0.05\n", columns, rows);
  for (int r = rows - 1; r >= 0; --r) {
    for (int c = 0; c < columns; ++c) out << height(c, r) << ' ';
    out << '\n';
  }
}

}  // namespace fettle::tests
