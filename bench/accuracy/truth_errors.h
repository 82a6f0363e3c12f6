#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/accuracy/study.h"
#include "engine/base/error.h"
#include "engine/filter/filter.h"
#include "engine/scanner/scanner.h"

namespace fettle::bench {

/// How far a field is from its part's truth, root mean squares [um].
struct TruthErrors {
  double all = 0.0;
  double flats = 0.0;  ///< farther than 12 samples from a true edge
  double near = 0.0;   ///< within 3 samples of one
  std::uint64_t hash = 0;
};

/// Of a field of the size of `scan`. Errors: kCancelled never; kFailed without memory.
[[nodiscard]] engine::Result<TruthErrors> truthErrors(const engine::Version& field,
                                                      const engine::SimulatedScan& scan);

/// Of `field` after a filter, whose largest change is measured from the scan.
[[nodiscard]] engine::Result<TruthErrors> errorsAfter(const engine::FilterSpec& spec,
                                                      const engine::Version& field,
                                                      const engine::SimulatedScan& scan);

/// A row of means over runs, not empty: error [um] over all with its worst run; `columns` are the flats, near edges and
/// near edges of the worst run [um]; the hash is the first run's. `costs`: of each run, in the study's unit.
[[nodiscard]] AccuracyRow rowOfErrors(std::string subject, std::string method,
                                      const std::vector<TruthErrors>& runs, std::vector<double> costs);

}  // namespace fettle::bench
