#include "app/commands/surface_curves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "app/commands/surface_plots.h"
#include "app/plots/gnuplot.h"
#include "app/work/streams.h"
#include "app/work/surface_numbers.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/profile_spectrum.h"

namespace fettle::app {

namespace {

// Standard output takes the numbers: a drawing there would be of one of two kinds.
bool isTable(const std::string& path) {
  return path == "-" || withDot(std::filesystem::path(path).extension().string()) == ".csv";
}

engine::Status drawTo(const std::string& path, const std::string& script) {
  if (withDot(std::filesystem::path(path).extension().string()) == ".png") return drawnAsPng(script, path);
  const auto svg = drawnByGnuplot(script);
  if (!svg) return tl::unexpected(svg.error());
  return engine::writeFileAtomically(path, *svg);
}

std::string abbottTable(const engine::ArealParameters& measured) {
  const std::span<const double> heights = curveHeights(measured);
  const std::vector<double> ratios = curveRatios();
  std::string text = "ratio,height\n";
  for (std::size_t i = 0; i < ratios.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g}\n", ratios[i], heights[i]);
  return text;
}

std::string correlationTable(const engine::SpatialAnalysis& analysis) {
  const std::vector<DecayCurve> curves = decayCurves(analysis);
  std::size_t longest = 0;
  for (const DecayCurve& curve : curves) longest = std::max(longest, curve.values.size());
  std::string text = "distance_mm";
  for (const DecayCurve& curve : curves)
    fmt::format_to(std::back_inserter(text), ",at_{:.4g}_degrees", curve.degrees);
  for (std::size_t i = 0; i < longest; ++i) {
    fmt::format_to(std::back_inserter(text), "\n{:.9g}", static_cast<double>(i) * decayStepMm(analysis));
    for (const DecayCurve& curve : curves)
      text += i < curve.values.size() ? fmt::format(",{:.9g}", curve.values[i]) : ",";
  }
  return text + "\n";
}

std::string spectrumTable(const engine::ArealParameters& measured, const engine::Grid& grid) {
  const double sq_mm = measured.sq * grid.height_unit.mm;
  std::string text = "axis,frequency_per_mm,density_mm3\n";
  for (const auto& [axis, name] : {std::pair(engine::ProfileAxis::kX, "x"), {engine::ProfileAxis::kY, "y"}}) {
    const engine::ProfileSpectrum spectrum =
        engine::profileSpectrum(measured.analysis->correlation, axis, sq_mm * sq_mm);
    for (std::size_t i = 0; i < spectrum.density.size(); ++i)
      fmt::format_to(std::back_inserter(text), "{},{:.9g},{:.9g}\n", name, spectrum.frequency(i),
                     spectrum.density[i]);
  }
  return text;
}

}  // namespace

void addCurveOptions(Command command, CurveFiles& files) {
  command.add(
      {{.name = "--abbott",
        .to = &files.abbott,
        .text =
            "Material ratio (Abbott) curve of one scan: .svg or .png, or its numbers as .csv, which - has",
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
    outputs.push_back(isTable(path) ? Output{path, OutputKind::kText, ".csv"}
                                    : Output{path, OutputKind::kPlot});
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

void addCurves(const CurveFiles& files, engine::ArealOptions& options) {
  if (!files.abbott.empty()) {
    options.functional = true;
    const std::vector<double> ratios = curveRatios();
    options.at_ratios.insert(options.at_ratios.end(), ratios.begin(), ratios.end());
  }
  if (!files.correlation.empty() || !files.spectrum.empty()) options.spatial = options.analysis = true;
}

engine::Status writeCurves(const CurveFiles& files, const engine::ArealParameters& measured,
                           const engine::Grid& grid, engine::JobControl& job) {
  if (!files.abbott.empty() && std::isnan(measured.sq))
    return engine::inputError(
        fmt::format("the surface has no material ratio curve: {}", measured.not_stated.front().reason),
        "--abbott", "leave the option out");
  for (const auto& [path, option] :
       {std::pair(&files.correlation, "--correlation"), {&files.spectrum, "--spectrum"}})
    if (!path->empty() && measured.analysis == nullptr)
      return engine::inputError(fmt::format("the surface has no autocorrelation: {}",
                                            measured.spatial.no_sal.empty() ? "there was no memory for it"
                                                                            : measured.spatial.no_sal),
                                option, "leave the option out");
  if (!files.spectrum.empty() && !hasSpectrum(measured))
    return engine::inputError("the surface has no power spectrum: no samples of a line lie beside each other",
                              "--spectrum", "leave the option out");
  const PlottedState state[] = {{"", &measured}};
  const auto write = [&job](const std::string& path, const auto& table, const auto& plot) -> engine::Status {
    if (path.empty()) return {};
    if (!isTable(path)) return drawTo(path, plot());
    return writeTo(path, ".csv", job,
                   [&](const std::string& file) { return engine::writeFileAtomically(file, table()); });
  };
  if (auto status = write(
          files.abbott, [&] { return abbottTable(measured); }, [&] { return abbottPlot(state, grid); });
      !status)
    return status;
  if (auto status = write(
          files.correlation, [&] { return correlationTable(*measured.analysis); },
          [&] { return correlationPlot(state); });
      !status)
    return status;
  return write(
      files.spectrum, [&] { return spectrumTable(measured, grid); },
      [&] { return spectrumPlot(state, grid); });
}

}  // namespace fettle::app
