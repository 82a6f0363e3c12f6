#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "engine/session/session.h"
#include "python/scan.h"

namespace fettle::python {

/// One step of a session.
struct SessionStep {
  std::int64_t number = 0;  ///< it led to the state of that number
  std::string name;
  std::string kind;  ///< "stroke", "filter", "mark", "invert", "import", "lines", "form"
  std::string time;  ///< UTC, ISO 8601
};

/// A session file as it was when it was read: the scan it began with, its states and its journal. Does not change
/// the file. Threading: any thread may read one.
class SessionReader {
 public:
  /// Errors: fettle.InputError, fettle.Error, KeyboardInterrupt and what `progress` raises.
  [[nodiscard]] static SessionReader open(const std::string& path, const std::string& scan_path,
                                          const pybind11::object& progress);

  [[nodiscard]] std::int64_t state() const noexcept {
    return session_.history.number();
  }  ///< the present one
  [[nodiscard]] std::int64_t first() const noexcept { return session_.history.first(); }
  [[nodiscard]] std::int64_t last() const noexcept { return session_.history.last(); }
  /// The steps that are held: first() + 1 .. last().
  [[nodiscard]] std::vector<SessionStep> steps() const;
  /// The field in a state, first() .. last(). Errors: fettle.InputError for others.
  [[nodiscard]] Scan field(std::int64_t state) const;
  [[nodiscard]] Scan original() const;
  [[nodiscard]] const std::string& scanPath() const noexcept { return session_.scan.path; }

 private:
  explicit SessionReader(engine::Session session) : session_(std::move(session)) {}
  engine::Session session_;
};

}  // namespace fettle::python
