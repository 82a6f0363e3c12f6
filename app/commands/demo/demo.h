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

/// What the demonstration is made of. The defaults are the ones the README's table is printed with.
struct DemoOptions {
  std::string folder;
  std::string part = "bracket";
  int side = 2048;        ///< samples along each side
  double noise = 1.0;     ///< scale of the simulated scanner's noise
  double outliers = 0.0;  ///< share of mixed pixels beside steps
  double dropouts = 0.0;  ///< scale of lost samples
  int window = 7;         ///< of the global filters
  int passes = 3;         ///< of the global filters
  std::uint64_t seed = 1;
  /// Where the close-up pictures look, as fractions of the field: the ribs of the bracket by default.
  std::vector<double> look_at = {0.38, 0.68};
};

/// One way of cleaning the scan, and how far its result is from the truth.
struct DemoResult {
  std::string name;   ///< stable: "noisy", "box", "heg-box", ...
  std::string title;  ///< for people
  engine::Version field;
  engine::TruthFigures figures;
};

/// Everything the demonstration found, ready to be drawn and tabulated.
struct DemoRun {
  engine::SimulatedScan scan;
  engine::Version touched;  ///< after the operator's strokes: smoothed along edges, edges marked
  haptic::ReplayReport strokes;
  std::vector<DemoResult> results;  ///< noisy, touched, then filter alone and HEG for each filter
};

/// The demonstration's filter of one kind, of engine::plainFilters().
[[nodiscard]] engine::FilterSpec demoFilter(engine::FilterKind kind, const DemoOptions& options);

/// The whole process of Potter, Johnson and Cohen (2004) on a simulated scan: operator strokes, local
/// smoothing, marking, global filters; and the same filters without a hand, for comparison. Writes scan,
/// truth, edges, strokes, scene, marks and every result into the folder.
[[nodiscard]] engine::Result<DemoRun> runDemo(const DemoOptions& options, engine::JobControl& job);

/// Draws the pictures of a run into the folder; returns their file names.
[[nodiscard]] engine::Result<std::vector<std::string>> drawDemo(const DemoRun& run,
                                                                const DemoOptions& options,
                                                                engine::JobControl& job);

}  // namespace fettle::app
