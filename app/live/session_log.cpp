#include "app/live/session_log.h"

#include <algorithm>

#include <glm/geometric.hpp>

namespace fettle::app {

engine::Status SessionLog::add(const haptic::TickRecord& record) {
  const double ms = 1e-6 * static_cast<double>(record.since_ns);
  const double size = glm::length(record.given_n);
  given_.peak_n = std::max(given_.peak_n, size);
  if (ms > 0.0) {
    given_.rate_n_per_ms = std::max(given_.rate_n_per_ms, glm::length(record.given_n - last_n_) / ms);
    given_.rise_n_per_ms = std::max(given_.rise_n_per_ms, (size - glm::length(last_n_)) / ms);
  }
  last_n_ = record.given_n;
  last_t_ = record.input.t;
  if (engine::Status status = strokes_.append(record.input); !status) return status;
  ++rows_;
  return {};
}

engine::Status SessionLog::flushIfDue() {
  if (last_t_ - flushed_t_ < 1.0) return {};
  flushed_t_ = last_t_;
  return strokes_.flush();
}

}  // namespace fettle::app
