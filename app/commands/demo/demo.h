#pragma once

#include <string>
#include <vector>

#include "app/commands/command.h"
#include "engine/compare/compare.h"
#include "engine/field/version.h"
#include "engine/filter/catalogue.h"
#include "engine/scanner/scanner.h"
#include "haptic/tick/replay.h"

namespace fettle::app {

/// Options of the demonstration. The table of the README is printed with the defaults.
struct DemoOptions {
  std::string folder;
  std::string part = "bracket";
  int side = 2048;        ///< samples along each side
  double noise = 1.0;     ///< scale of the simulated scanner's noise
  double outliers = 0.0;  ///< share of mixed pixels next to steps
  double dropouts = 0.0;  ///< scale of lost samples
  int window = 7;         ///< of the global filters
  int passes = 3;         ///< of the global filters
  std::uint64_t seed = 1;
  /// Centre of the close-up pictures, as fractions of the field: the ribs of the bracket by default.
  std::vector<double> look_at = {0.38, 0.68};
};

/// One way of cleaning the scan, and the error of its result against the truth.
struct DemoResult {
  std::string name;   ///< stable: "noisy", "box", "heg-box", ...
  std::string title;  ///< for display
  engine::Version field;
  engine::TruthFigures figures;
};

/// All results of the demonstration, ready to be drawn and tabulated.
struct DemoRun {
  engine::SimulatedScan scan;
  engine::Version touched;  ///< after the operator's strokes: smoothed along edges, edges marked
  haptic::ReplayReport strokes;
  /// noisy, touched, filter alone and HEG for each plain filter; then the variations alone, and the generalised one
  /// with the lines located from the marking strokes and with the true ones.
  std::vector<DemoResult> results;
};

/// The demonstration's filter of one kind, of engine::plainFilters().
[[nodiscard]] engine::FilterSpec demoFilter(engine::FilterKind kind, const DemoOptions& options);

/// The whole process of Potter, Johnson and Cohen (2004) on a simulated scan: operator strokes, local
/// smoothing, marking, global filters; and the same filters without strokes, for comparison. Writes scan,
/// truth, edges, strokes, scene, marks and every result into the folder.
[[nodiscard]] engine::Result<DemoRun> runDemo(const DemoOptions& options, engine::JobControl& job);

/// Draws the pictures of a run into the folder; returns their file names.
[[nodiscard]] engine::Result<std::vector<std::string>> drawDemo(const DemoRun& run,
                                                                const DemoOptions& options,
                                                                engine::JobControl& job);

}  // namespace fettle::app
