#pragma once

#include <string>

#include "engine/base/error.h"

namespace fettle::app {

/// What every plot begins with: an SVG of 860 x 480, its key at the right, a light grid.
inline constexpr const char* kPlotHead =
    "set terminal svg size 860,480 dynamic enhanced font 'DejaVu Sans,13' background '#ffffff'\n"
    "set termoption noenhanced\n"
    "set key outside right top Left reverse samplen 2\n"
    "set grid lc rgb '#dddddd'\nset border lc rgb '#555555'\nset tics textcolor rgb '#333333'\n";

/// Colours that stay apart for most eyes: Okabe and Ito, Color universal design (2008).
inline constexpr const char* kPlotColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                               "#e69f00", "#56b4e9", "#000000"};

/// A text as gnuplot reads it, quotes included.
[[nodiscard]] std::string quoted(const std::string& text);

/// Where a logarithmic axis ("x" or "y") from low to high has its marks when that is two decades or so: 1, 2
/// and 5 of each. Nothing for more, where gnuplot's own are good.
[[nodiscard]] std::string ticsOf(char axis, double low, double high);

/// The SVG element that a script draws. Errors (kFailed): gnuplot is missing, refuses, or no temporary file
/// can be written.
[[nodiscard]] engine::Result<std::string> drawnByGnuplot(const std::string& script);

/// Whether gnuplot is there, to be asked before minutes are spent on figures for it. Errors as
/// drawnByGnuplot.
[[nodiscard]] engine::Status plotsCanBeMade();

}  // namespace fettle::app
