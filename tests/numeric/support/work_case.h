#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "engine/field/version.h"
#include "engine/filter/catalogue.h"
#include "haptic/base/strokes.h"
#include "haptic/scene/scene.h"

namespace fettle::tests {

/// One step of work on a field: a global filter, or a recorded stylus session.
struct WorkStep {
  std::optional<engine::FilterSpec> filter;
  std::vector<haptic::StrokeSample> strokes;  ///< when it is no filter
  haptic::Scene scene;                        ///< with them
};

/// `start` after one step; max_change of either kind counts from `original`. Expects success.
[[nodiscard]] engine::Version worked(const engine::Version& start, const engine::Version& original,
                                     const WorkStep& step);

/// A failing case as a folder that a person can work through with the built program: scan.tif, marks.png, a
/// strokes file and a scene a session, and README with one `fettle` command line a step. `about` comes first
/// in it. Returns what to print: the folder and the same lines.
[[nodiscard]] std::string writeCase(const std::string& name, const std::string& about,
                                    const engine::Version& start, const std::vector<WorkStep>& steps);

}  // namespace fettle::tests
