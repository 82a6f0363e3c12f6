#pragma once

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/mosaic/join.h"

namespace fettle::app {

/// A mosaic of scans some of which lay under a form.
struct FormedMosaic {
  engine::Version field;  ///< what is seen of it under the first scan's form, or its samples
  std::string left_out;   ///< why no form lies over it though one lay over scans; empty else
};

/// The first scan's form lies over the mosaic where a form lies over every scan and none is farther from the first's, moved with its scan,
/// than the first scan's noise. `scans`: that were joined, without a form; `forms`: of each one's heights, or null;
/// `names`: for what is said. Errors: kFailed without memory; kCancelled. Thread: any; a long job.
[[nodiscard]] engine::Result<FormedMosaic> underCommonForm(const engine::JoinedScans& joined,
                                                           const std::vector<engine::Version>& scans,
                                                           const std::vector<engine::FieldForm>& forms,
                                                           const std::vector<std::string>& names,
                                                           engine::JobControl& job);

}  // namespace fettle::app
