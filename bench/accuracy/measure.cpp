#include "bench/accuracy/measure.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "engine/base/statistics.h"

namespace fettle::bench {

void summarise(std::vector<double> errors, AccuracyRow& row) {
  const engine::ErrorSummary summary = engine::errorSummary(std::move(errors));
  row.error = summary.mean;
  row.error_p99 = summary.p99;
  row.error_worst = summary.worst;
}

void spread(std::vector<double> costs, AccuracyRow& row) {
  const engine::TimeSpread times = engine::timeSpread(std::move(costs));
  row.cost = times.median;
  row.cost_worst = times.worst;
}

const AccuracyRow& rowOf(const Study& study, const std::string& subject, const std::string& method) {
  const auto found = std::find_if(study.rows.begin(), study.rows.end(), [&](const AccuracyRow& row) {
    return row.subject == subject && row.method == method;
  });
  assert(found != study.rows.end());
  return *found;
}

}  // namespace fettle::bench
