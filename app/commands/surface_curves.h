#pragma once

#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/work/outputs.h"
#include "engine/base/error.h"
#include "engine/measure/areal.h"

namespace fettle::app {

/// Files for the curves of a surface, each a drawing (.svg, .png) or its numbers (.csv); empty: not asked for.
struct CurveFiles {
  std::string abbott;       ///< material ratio curve
  std::string correlation;  ///< autocorrelation in the directions of its fastest and slowest decay
  std::string spectrum;     ///< power spectral density of profiles along x and y

  [[nodiscard]] bool any() const noexcept {
    return !abbott.empty() || !correlation.empty() || !spectrum.empty();
  }
};

/// --abbott, --correlation, --spectrum.
void addCurveOptions(Command command, CurveFiles& files);

/// As outputs to be checked.
[[nodiscard]] std::vector<Output> outputsOf(const CurveFiles& files);

/// Refuses what cannot be drawn before anything is read: drawings without gnuplot, curves of several scans.
[[nodiscard]] engine::Status checkCurves(const CurveFiles& files, std::size_t scans);

/// Adds what the curves need to what is measured. The heights at the ratios of the material ratio curve come last.
void addCurves(const CurveFiles& files, engine::ArealOptions& options);

/// Writes them, each file whole or not at all. `measured` was measured with addCurves(). Errors (kInput): a curve that the
/// samples do not determine, with the reason; those of drawing and writing.
[[nodiscard]] engine::Status writeCurves(const CurveFiles& files, const engine::ArealParameters& measured,
                                         const engine::Grid& grid, engine::JobControl& job);

}  // namespace fettle::app
