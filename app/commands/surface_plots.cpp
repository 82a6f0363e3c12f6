#include "app/commands/surface_plots.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "app/plots/gnuplot.h"
#include "app/work/read_units.h"
#include "app/work/surface_numbers.h"
#include "engine/measure/profile_spectrum.h"

namespace fettle::app {

namespace {

constexpr const char* kBeneath = "#a6cfe8";  // of the first of several states: the first colour, lighter

// A thin broken line with its name: across the graph at height y, or from its lower to its upper side at x.
std::string limitAt(char axis, double at, const std::string& name) {
  return axis == 'x' ? fmt::format(
                           "set arrow from {0:.9g}, graph 0 to {0:.9g}, graph 1 nohead dt 3\n"
                           "set label '{1} ' at {0:.9g}, graph 1 right rotate by 90 offset "
                           "character -0.6, 0\n",
                           at, name)
                     : fmt::format(
                           "set arrow from graph 0, first {0:.9g} to graph 1, first {0:.9g} nohead dt 3\n"
                           "set label '{1}' at graph 0.99, first {0:.9g} right offset 0, 0.5\n",
                           at, name);
}

// Curves of a plot as they are added: the data of each, and the command that draws all of them. Curve k of each state is
// drawn alike; states differ by colour, and where there is only one, curves do.
class Curves {
 public:
  explicit Curves(std::size_t states) : states_(states) {}

  void add(std::size_t state, std::size_t curve, const std::string& title, const std::string& rows) {
    const std::string name = fmt::format("$curve{}", count_++);
    data_ += fmt::format("{} << EOD\n{}EOD\n", name, rows);
    const std::size_t colour = (states_ > 1 ? state : curve) % std::size(kPlotColours);
    const std::string dash = states_ > 1 && curve > 0 ? " dt 2" : "";
    // What is beneath is seen on both sides of a line that follows it.
    const double width = state + 1 < states_ ? 4.0 : 1.5;
    plot_ += fmt::format("{}{} using 1:2 with lines lw {}{} lc rgb '{}' title {}",
                         plot_.empty() ? "plot " : ", ", name, width, dash,
                         states_ > 1 && state == 0 ? kBeneath : kPlotColours[colour], quoted(title));
  }
  [[nodiscard]] std::string script() const { return data_ + plot_ + "\n"; }

 private:
  std::size_t states_, count_ = 0;
  std::string data_, plot_;
};

std::string titled(const PlottedState& state, const std::string& curve) {
  if (state.name.empty()) return curve;
  return curve.empty() ? state.name : fmt::format("{}, {}", state.name, curve);
}

}  // namespace

std::string abbottPlot(std::span<const PlottedState> states, const engine::Grid& grid) {
  const engine::ArealParameters& first = *states.front().measured;
  const ReadAs height = readLengthAs(first.sq, grid.height_unit.mm, grid.height_unit.name);
  std::string script = kPlotHead;
  script += states.size() > 1 ? "set xrange [0:100]\n" : "unset key\nset xrange [0:100]\n";
  // Single spikes would leave of everything else a level line: they are named instead.
  constexpr double kNone = std::numeric_limits<double>::infinity();
  double low = kNone, high = -kNone, lowest = kNone, highest = -kNone;
  for (const PlottedState& state : states) {
    const std::span<const double> heights = curveHeights(*state.measured);
    high = std::max(high, heights[1]);
    low = std::min(low, heights[heights.size() - 2]);
    highest = std::max(highest, heights.front());
    lowest = std::min(lowest, heights.back());
  }
  const double room = 0.2 * (high - low);
  if (high > low)
    script += fmt::format("set yrange [{:.9g}:{:.9g}]\n", std::max(low - room, lowest) / height.size,
                          std::min(high + room, highest) / height.size);
  script += fmt::format("set xlabel 'material ratio [%]; highest {:.4g}, lowest {:.4g} {}'\n",
                        highest / height.size, lowest / height.size, height.name);
  script += fmt::format("set ylabel 'height about the mean [{}]'\nset format y '%.9g'\n", height.name);
  if (const engine::MaterialRatio& ratio = first.ratio; states.size() == 1 && ratio.sk > 0.0) {
    script += limitAt('x', 100.0 * ratio.smrk1, fmt::format("Smrk1 {:.1f} %", 100.0 * ratio.smrk1));
    script += limitAt('x', 100.0 * ratio.smrk2, fmt::format("Smrk2 {:.1f} %", 100.0 * ratio.smrk2));
  }
  const std::vector<double> ratios = curveRatios();
  Curves curves(states.size());
  for (std::size_t s = 0; s < states.size(); ++s) {
    const std::span<const double> heights = curveHeights(*states[s].measured);
    std::string rows;
    for (std::size_t i = 0; i < ratios.size(); ++i)
      fmt::format_to(std::back_inserter(rows), "{:.9g} {:.9g}\n", 100.0 * ratios[i],
                     heights[i] / height.size);
    curves.add(s, 0, titled(states[s], ""), rows);
  }
  return script + curves.script();
}

std::string correlationPlot(std::span<const PlottedState> states) {
  double longest = 0.0;
  std::vector<std::vector<DecayCurve>> all;
  for (const PlottedState& state : states) {
    all.push_back(decayCurves(*state.measured->analysis));
    for (const DecayCurve& curve : all.back())
      longest = std::max(longest,
                         static_cast<double>(curve.values.size()) * decayStepMm(*state.measured->analysis));
  }
  const ReadAs length = readLengthAs(longest, 1.0, "mm");
  std::string script = kPlotHead;
  script +=
      fmt::format("set xlabel 'distance [{}]'\nset ylabel 'autocorrelation'\nset yrange [:1]\n", length.name);
  script += limitAt('y', 0.2, "0.2");
  Curves curves(states.size());
  for (std::size_t s = 0; s < states.size(); ++s) {
    const double step_mm = decayStepMm(*states[s].measured->analysis);
    for (std::size_t c = 0; c < all[s].size(); ++c) {
      const DecayCurve& curve = all[s][c];
      std::string rows;
      for (std::size_t i = 0; i < curve.values.size(); ++i)
        fmt::format_to(std::back_inserter(rows), "{:.9g} {:.9g}\n",
                       static_cast<double>(i) * step_mm / length.size, curve.values[i]);
      curves.add(s, c,
                 titled(states[s], states.size() > 1
                                       ? fmt::format("{}, {:.0f} degrees", curve.name, curve.degrees)
                                       : fmt::format("{}, {:.0f} degrees from x", curve.name, curve.degrees)),
                 rows);
    }
  }
  return script + curves.script();
}

bool hasSpectrum(const engine::ArealParameters& measured) {
  for (const engine::ProfileAxis axis : {engine::ProfileAxis::kX, engine::ProfileAxis::kY}) {
    const auto spectrum = engine::profileSpectrum(measured.analysis->correlation, axis, 1.0);
    for (std::size_t i = 1; i < spectrum.density.size(); ++i)
      if (spectrum.density[i] > 0.0) return true;
  }
  return false;
}

std::string spectrumPlot(std::span<const PlottedState> states, const engine::Grid& grid) {
  const ReadAs height = readLengthAs(states.front().measured->sq * grid.height_unit.mm, 1.0, "mm");
  std::string script = kPlotHead;
  script += "set logscale xy\nset format y '%.0e'\nset xlabel 'spatial frequency [1/mm]'\n";
  script += fmt::format("set ylabel 'power spectral density of profiles [{}^2 mm]'\n", height.name);
  Curves curves(states.size());
  constexpr std::pair<engine::ProfileAxis, const char*> kAxes[] = {{engine::ProfileAxis::kX, "along x"},
                                                                   {engine::ProfileAxis::kY, "along y"}};
  for (std::size_t s = 0; s < states.size(); ++s) {
    const engine::ArealParameters& measured = *states[s].measured;
    const double sq_mm = measured.sq * grid.height_unit.mm;
    for (std::size_t a = 0; a < std::size(kAxes); ++a) {
      const engine::ProfileSpectrum spectrum =
          engine::profileSpectrum(measured.analysis->correlation, kAxes[a].first, sq_mm * sq_mm);
      std::string rows;
      // Below 0 nothing can be drawn: the line ends there.
      for (std::size_t i = 1; i < spectrum.density.size(); ++i) {
        const double density = spectrum.density[i] / (height.size * height.size);
        rows += density > 0.0 ? fmt::format("{:.9g} {:.9g}\n", spectrum.frequency(i), density) : "\n";
      }
      curves.add(s, a, titled(states[s], kAxes[a].second), rows);
    }
  }
  return script + curves.script();
}

}  // namespace fettle::app
