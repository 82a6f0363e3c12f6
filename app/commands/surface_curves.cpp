#include "app/commands/surface_curves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "app/commands/plots/gnuplot.h"
#include "app/commands/read_units.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/profile_spectrum.h"

namespace fettle::app {

namespace {

constexpr int kRatioSteps = 400;

std::string extensionOf(const std::string& path) {
  return withDot(std::filesystem::path(path).extension().string());
}

bool isTable(const std::string& path) {
  return extensionOf(path) == ".csv";
}

engine::Status drawTo(const std::string& path, const std::string& script) {
  if (extensionOf(path) == ".png") return drawnAsPng(script, path);
  const auto svg = drawnByGnuplot(script);
  if (!svg) return tl::unexpected(svg.error());
  return engine::writeFileAtomically(path, *svg);
}

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

// Material ratio.

std::span<const double> curveHeights(const engine::ArealParameters& measured) {
  return std::span(measured.heights).last(kRatioSteps + 1);
}

engine::Status writeAbbott(const std::string& path, const engine::ArealParameters& measured,
                           const engine::Grid& grid) {
  const std::span<const double> heights = curveHeights(measured);
  const std::vector<double> ratios = curveRatios();
  if (isTable(path)) {
    std::string text = "ratio,height\n";
    for (std::size_t i = 0; i < ratios.size(); ++i)
      fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g}\n", ratios[i], heights[i]);
    return engine::writeFileAtomically(path, text);
  }
  const ReadAs height = readLengthAs(measured.sq, grid.height_unit.mm, grid.height_unit.name);
  std::string script = kPlotHead;
  script += "unset key\nset xrange [0:100]\n";
  // Single spikes would leave of everything else a level line: they are named instead.
  const double high = heights[1], low = heights[kRatioSteps - 1], room = 0.2 * (high - low);
  if (high > low)
    script += fmt::format("set yrange [{:.9g}:{:.9g}]\n", std::max(low - room, heights.back()) / height.size,
                          std::min(high + room, heights.front()) / height.size);
  script += fmt::format("set xlabel 'material ratio [%]; highest {:.4g}, lowest {:.4g} {}'\n",
                        measured.sp / height.size, -measured.sv / height.size, height.name);
  script += fmt::format("set ylabel 'height about the mean [{}]'\nset format y '%.9g'\n", height.name);
  const engine::MaterialRatio& ratio = measured.ratio;
  if (ratio.sk > 0.0) {
    script += limitAt('x', 100.0 * ratio.smrk1, fmt::format("Smrk1 {:.1f} %", 100.0 * ratio.smrk1));
    script += limitAt('x', 100.0 * ratio.smrk2, fmt::format("Smrk2 {:.1f} %", 100.0 * ratio.smrk2));
  }
  script += "$curve << EOD\n";
  for (std::size_t i = 0; i < ratios.size(); ++i)
    fmt::format_to(std::back_inserter(script), "{:.9g} {:.9g}\n", 100.0 * ratios[i],
                   heights[i] / height.size);
  script += fmt::format("EOD\nplot $curve using 1:2 with lines lw 2 lc rgb '{}'\n", kPlotColours[0]);
  return drawTo(path, script);
}

// Autocorrelation.

struct DecayCurve {
  std::string name;
  double degrees = 0.0;
  std::vector<double> values;  // at steps of the distance
};

// The directions of the fastest and slowest decay; where there are none, x and y.
std::vector<DecayCurve> decayCurves(const engine::SpatialAnalysis& analysis, double step_mm) {
  const engine::SpatialParameters& found = analysis.parameters;
  std::vector<DecayCurve> curves;
  if (std::isnan(found.sal_direction) || std::isnan(found.slow_direction))
    curves = {{"along x", 0.0, {}}, {"along y", 90.0, {}}};
  else
    curves = {{"fastest", found.sal_direction, {}}, {"slowest", found.slow_direction, {}}};
  for (DecayCurve& curve : curves) {
    const double angle = curve.degrees * std::numbers::pi / 180.0;
    for (std::size_t i = 0;; ++i) {
      const double distance = static_cast<double>(i) * step_mm;
      const double value =
          analysis.correlation.valueAt(distance * std::cos(angle), distance * std::sin(angle));
      if (std::isnan(value)) break;
      curve.values.push_back(value);
    }
  }
  return curves;
}

engine::Status writeCorrelation(const std::string& path, const engine::SpatialAnalysis& analysis) {
  const double step_mm = std::min(analysis.correlation.spacing_x, analysis.correlation.spacing_y);
  const std::vector<DecayCurve> curves = decayCurves(analysis, step_mm);
  std::size_t longest = 0;
  for (const DecayCurve& curve : curves) longest = std::max(longest, curve.values.size());
  if (isTable(path)) {
    std::string text = "distance_mm";
    for (const DecayCurve& curve : curves)
      fmt::format_to(std::back_inserter(text), ",at_{:.4g}_degrees", curve.degrees);
    for (std::size_t i = 0; i < longest; ++i) {
      fmt::format_to(std::back_inserter(text), "\n{:.9g}", static_cast<double>(i) * step_mm);
      for (const DecayCurve& curve : curves)
        text += i < curve.values.size() ? fmt::format(",{:.9g}", curve.values[i]) : ",";
    }
    return engine::writeFileAtomically(path, text + "\n");
  }
  const ReadAs length = readLengthAs(static_cast<double>(longest) * step_mm, 1.0, "mm");
  std::string script = kPlotHead, plot;
  script +=
      fmt::format("set xlabel 'distance [{}]'\nset ylabel 'autocorrelation'\nset yrange [:1]\n", length.name);
  script += limitAt('y', 0.2, "0.2");
  for (std::size_t c = 0; c < curves.size(); ++c) {
    script += fmt::format("$curve{} << EOD\n", c);
    for (std::size_t i = 0; i < curves[c].values.size(); ++i)
      fmt::format_to(std::back_inserter(script), "{:.9g} {:.9g}\n",
                     static_cast<double>(i) * step_mm / length.size, curves[c].values[i]);
    script += "EOD\n";
    plot += fmt::format("{}$curve{} using 1:2 with lines lw 1.5 lc rgb '{}' title {}",
                        c == 0 ? "plot " : ", ", c, kPlotColours[c],
                        quoted(fmt::format("{}, {:.0f} degrees from x", curves[c].name, curves[c].degrees)));
  }
  return drawTo(path, script + plot + "\n");
}

// Power spectrum.

engine::Status writeSpectrum(const std::string& path, const engine::ArealParameters& measured,
                             const engine::Grid& grid) {
  const double sq_mm = measured.sq * grid.height_unit.mm;
  const engine::ProfileSpectrum spectra[] = {
      engine::profileSpectrum(measured.analysis->correlation, engine::ProfileAxis::kX, sq_mm * sq_mm),
      engine::profileSpectrum(measured.analysis->correlation, engine::ProfileAxis::kY, sq_mm * sq_mm)};
  constexpr const char* kAxes[] = {"x", "y"};
  if (isTable(path)) {
    std::string text = "axis,frequency_per_mm,density_mm3\n";
    for (int a = 0; a < 2; ++a)
      for (std::size_t i = 0; i < spectra[a].density.size(); ++i)
        fmt::format_to(std::back_inserter(text), "{},{:.9g},{:.9g}\n", kAxes[a], spectra[a].frequency(i),
                       spectra[a].density[i]);
    return engine::writeFileAtomically(path, text);
  }
  const ReadAs height = readLengthAs(sq_mm, 1.0, "mm");
  std::string script = kPlotHead, plot;
  script += "set logscale xy\nset format y '%.0e'\nset xlabel 'spatial frequency [1/mm]'\n";
  script += fmt::format("set ylabel 'power spectral density of profiles [{}^2 mm]'\n", height.name);
  for (int a = 0; a < 2; ++a) {
    script += fmt::format("$curve{} << EOD\n", a);
    // Below 0 nothing can be drawn: the line ends there.
    for (std::size_t i = 1; i < spectra[a].density.size(); ++i) {
      const double density = spectra[a].density[i] / (height.size * height.size);
      script += density > 0.0 ? fmt::format("{:.9g} {:.9g}\n", spectra[a].frequency(i), density) : "\n";
    }
    script += "EOD\n";
    plot += fmt::format("{}$curve{} using 1:2 with lines lw 1.5 lc rgb '{}' title 'along {}'",
                        a == 0 ? "plot " : ", ", a, kPlotColours[a], kAxes[a]);
  }
  return drawTo(path, script + plot + "\n");
}

}  // namespace

void addCurveOptions(Command command, CurveFiles& files) {
  command.add({{.name = "--abbott",
                .to = &files.abbott,
                .text = "Material ratio (Abbott) curve of one scan: .svg or .png, or its numbers as .csv",
                .kind = ValueKind::kOutput},
               {.name = "--correlation",
                .to = &files.correlation,
                .text = "Autocorrelation in the directions of its fastest and slowest decay, the same",
                .kind = ValueKind::kOutput},
               {.name = "--spectrum",
                .to = &files.spectrum,
                .text = "Power spectral density of profiles along x and along y, the same",
                .kind = ValueKind::kOutput}});
}

std::vector<Output> outputsOf(const CurveFiles& files) {
  std::vector<Output> outputs;
  for (const std::string& path : {files.abbott, files.correlation, files.spectrum})
    outputs.push_back({path, isTable(path) ? OutputKind::kText : OutputKind::kPlot});
  return outputs;
}

engine::Status checkCurves(const CurveFiles& files, std::size_t scans) {
  if (!files.any()) return {};
  if (scans > 1)
    return engine::inputError("curves are of one scan", "--abbott, --correlation, --spectrum",
                              "give one scan, or leave them out");
  for (const std::string& path : {files.abbott, files.correlation, files.spectrum})
    if (!path.empty() && !isTable(path)) return plotsCanBeMade();
  return {};
}

std::vector<double> curveRatios() {
  std::vector<double> ratios;
  for (int i = 0; i <= kRatioSteps; ++i) ratios.push_back(static_cast<double>(i) / kRatioSteps);
  return ratios;
}

void addCurves(const CurveFiles& files, engine::ArealOptions& options) {
  if (!files.abbott.empty()) {
    options.functional = true;
    const std::vector<double> ratios = curveRatios();
    options.at_ratios.insert(options.at_ratios.end(), ratios.begin(), ratios.end());
  }
  if (!files.correlation.empty() || !files.spectrum.empty()) options.spatial = options.analysis = true;
}

engine::Status writeCurves(const CurveFiles& files, const engine::ArealParameters& measured,
                           const engine::Grid& grid) {
  for (const auto& [path, option] :
       {std::pair(&files.correlation, "--correlation"), {&files.spectrum, "--spectrum"}})
    if (!path->empty() && measured.analysis == nullptr)
      return engine::inputError(fmt::format("the surface has no autocorrelation: {}",
                                            measured.spatial.no_sal.empty() ? "there was no memory for it"
                                                                            : measured.spatial.no_sal),
                                option, "leave the option out");
  if (!files.abbott.empty())
    if (auto status = writeAbbott(files.abbott, measured, grid); !status) return status;
  if (!files.correlation.empty())
    if (auto status = writeCorrelation(files.correlation, *measured.analysis); !status) return status;
  if (!files.spectrum.empty())
    if (auto status = writeSpectrum(files.spectrum, measured, grid); !status) return status;
  return {};
}

}  // namespace fettle::app
