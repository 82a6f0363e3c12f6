#pragma once

#include <string>

#include "engine/base/error.h"

namespace fettle::app {

/// Beginning of every plot: an SVG of 860 x 480, its key at the right, a light grid.
inline constexpr const char* kPlotHead =
    "set terminal svg size 860,480 dynamic enhanced font 'DejaVu Sans,13' background '#ffffff'\n"
    "set termoption noenhanced\n"
    "set key outside right top Left reverse samplen 2\n"
    "set grid lc rgb '#dddddd'\nset border lc rgb '#555555'\nset tics textcolor rgb '#333333'\n";

/// Colours that are distinguishable for most people: Okabe and Ito, Color universal design (2008).
inline constexpr const char* kPlotColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                               "#e69f00", "#56b4e9", "#000000"};

/// A text quoted for gnuplot.
[[nodiscard]] std::string quoted(const std::string& text);

/// Tics of a logarithmic axis ("x" or "y") from low to high that spans about two decades: 1, 2 and 5 of each.
/// Nothing for more decades, where gnuplot's own tics are good.
[[nodiscard]] std::string ticsOf(char axis, double low, double high);

/// The SVG element drawn by a script. Errors (kFailed): gnuplot is missing or fails, or no temporary file can
/// be written.
[[nodiscard]] engine::Result<std::string> drawnByGnuplot(const std::string& script);

/// The same picture as a PNG of 860 x 480 at `path`, whole or not at all. Errors: also those of writing the file.
[[nodiscard]] engine::Status drawnAsPng(const std::string& script, const std::string& path);

/// Whether gnuplot is installed, to be checked before minutes of computing. Errors as drawnByGnuplot.
[[nodiscard]] engine::Status plotsCanBeMade();

}  // namespace fettle::app
