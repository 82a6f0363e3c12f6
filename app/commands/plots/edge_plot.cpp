#include "app/commands/plots/edge_plot.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/commands/plots/gnuplot.h"

namespace fettle::app {

namespace {

// A blank row ends a stretch of measured points: gnuplot connects nothing over it.
std::string rowsOf(const MeasuredLine& line) {
  std::string rows;
  for (const engine::EdgeSection& s : line.sections) {
    if (s.measured)
      fmt::format_to(std::back_inserter(rows), "{:.6g} {:.6g} {:.6g} {:.6g} {:.6g}\n", s.along_mm, s.step,
                     s.step_deviation, s.turn, s.turn_deviation);
    else
      rows += "\n";
  }
  return rows;
}

std::string panel(const std::vector<const MeasuredLine*>& lines, int value, const std::string& title) {
  std::string bands, curves;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* colour = kPlotColours[i % std::size(kPlotColours)];
    bands += fmt::format(
        "{0}$line{1} using 1:(${2}-${3}):(${2}+${3}) with filledcurves fc rgb '{4}' fs transparent "
        "solid 0.25 noborder notitle",
        i == 0 ? "plot " : ", ", i, value, value + 1, colour);
    curves += fmt::format(", $line{} using 1:{} with lines lc rgb '{}' lw 1.5 title {}", i, value, colour,
                          quoted(fmt::format("line {}", lines[i]->line.id)));
  }
  return fmt::format("set ylabel {}\n", quoted(title)) + bands + curves + "\n";
}

}  // namespace

engine::Result<std::string> edgePlot(const std::vector<MeasuredLine>& lines, const engine::LengthUnit& unit) {
  std::vector<const MeasuredLine*> longest;
  for (const MeasuredLine& line : lines)
    if (line.means.measured > 1) longest.push_back(&line);
  if (longest.empty())
    return engine::inputError("no line could be measured, so there is nothing to draw", "--plot",
                              "leave it out, the table says what was found");
  std::ranges::stable_sort(longest, std::greater(), &MeasuredLine::length_mm);
  longest.resize(std::min(longest.size(), std::size(kPlotColours)));
  std::string script = kPlotHead;
  for (std::size_t i = 0; i < longest.size(); ++i)
    script += fmt::format("$line{} << EOD\n{}EOD\n", i, rowsOf(*longest[i]));
  script += "set multiplot layout 2,1\nset xlabel 'length along the line [mm]'\n";
  script += panel(longest, 2, fmt::format("step [{}]", unit.name)) + panel(longest, 4, "turn [degrees]");
  return drawnByGnuplot(script + "unset multiplot\n");
}

}  // namespace fettle::app
