#include "bench/accuracy/measure.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

namespace fettle::bench {

void summarise(std::vector<double> errors, AccuracyRow& row) {
  row.error = row.error_p99 = row.error_worst = 0.0;
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  row.error = std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(errors.size())));
  row.error_p99 = errors[std::max<std::size_t>(rank, 1) - 1];
  row.error_worst = errors.back();
}

void spread(std::vector<double> costs, AccuracyRow& row) {
  assert(!costs.empty());
  std::sort(costs.begin(), costs.end());
  row.cost = costs[costs.size() / 2];
  row.cost_worst = costs.back();
}

std::uint64_t hashOf(std::span<const double> values) {
  std::uint64_t h = 14695981039346656037ULL;
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 64; i += 8) h = (h ^ (bits >> i & 0xff)) * 1099511628211ULL;
  }
  return h;
}

const AccuracyRow& rowOf(const Study& study, const std::string& subject, const std::string& method) {
  const auto found = std::find_if(study.rows.begin(), study.rows.end(), [&](const AccuracyRow& row) {
    return row.subject == subject && row.method == method;
  });
  assert(found != study.rows.end());
  return *found;
}

}  // namespace fettle::bench
