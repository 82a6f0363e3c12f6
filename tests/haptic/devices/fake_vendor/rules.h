#pragma once

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <vector>

namespace fettle::fake {

/// What a maker's library would have refused, or a device suffered from: the fakes check each call and note what was against a rule.
/// Threading: any.
class Rules {
 public:
  void check(bool held, const char* rule) {
    if (held) return;
    const std::lock_guard lock(mutex_);
    if (broken_.size() < 100) broken_.emplace_back(rule);
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    broken_.clear();
  }
  [[nodiscard]] std::vector<std::string> broken() const {
    const std::lock_guard lock(mutex_);
    return broken_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> broken_;
};

/// The three components that a test sets or reads while the library's thread uses them. Each is atomic; a test changes one at a time.
struct Triple {
  std::atomic<double> x{0.0}, y{0.0}, z{0.0};
  void set(double a, double b, double c) {
    x = a;
    y = b;
    z = c;
  }
  [[nodiscard]] double length() const { return std::hypot(x.load(), y.load(), z.load()); }
};

/// A turned frame, by rows; as it is until it is set. A test sets it while the device does not move.
struct Frame {
  std::atomic<double> row[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  void set(const double (&to)[3][3]) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) row[r][c] = to[r][c];
  }
};

/// At the program's end: the rules that were broken, a line each, in the file that FAKE_VENDOR_LOG names.
inline void writeLog(const Rules& rules) {
  const char* const path = std::getenv("FAKE_VENDOR_LOG");
  if (path == nullptr) return;
  std::FILE* const file = std::fopen(path, "w");
  if (file == nullptr) return;
  for (const std::string& rule : rules.broken()) std::fprintf(file, "%s\n", rule.c_str());
  std::fclose(file);
}

}  // namespace fettle::fake
