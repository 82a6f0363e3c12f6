#include "bench/accuracy/truth_errors.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "bench/accuracy/measure.h"
#include "engine/base/job.h"
#include "engine/compare/compare.h"
#include "engine/filter/catalogue.h"

namespace fettle::bench {

engine::Result<TruthErrors> truthErrors(const engine::Version& field, const engine::SimulatedScan& scan) {
  engine::JobControl quiet;
  const auto figures = engine::compareToTruth(field, scan.truth, scan.edges, quiet);
  if (!figures) return tl::unexpected(figures.error());
  return TruthErrors{1e3 * figures->rmse, 1e3 * figures->rmse_flat, 1e3 * figures->rmse_edge,
                     engine::contentHash(field)};
}

engine::Result<TruthErrors> errorsAfter(const engine::FilterSpec& spec, const engine::Version& field,
                                        const engine::SimulatedScan& scan) {
  engine::JobControl quiet;
  const auto filtered = engine::applyFilter(field, scan.scan, spec, quiet);
  if (!filtered) return tl::unexpected(filtered.error());
  return truthErrors(filtered->field, scan);
}

AccuracyRow rowOfErrors(std::string subject, std::string method, const std::vector<TruthErrors>& runs,
                        std::vector<double> costs) {
  AccuracyRow row{std::move(subject), std::move(method)};
  row.error_p99 = row.wrong = std::numeric_limits<double>::quiet_NaN();
  spread(std::move(costs), row);
  double flats = 0.0, near = 0.0, worst_near = 0.0;
  const auto n = static_cast<double>(runs.size());
  for (const TruthErrors& run : runs) {
    row.error += run.all / n;
    row.error_worst = std::max(row.error_worst, run.all);
    flats += run.flats / n;
    near += run.near / n;
    worst_near = std::max(worst_near, run.near);
  }
  row.hash = runs.front().hash;
  row.more = {flats, near, worst_near};
  return row;
}

}  // namespace fettle::bench
