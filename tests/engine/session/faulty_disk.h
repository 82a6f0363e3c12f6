#pragma once

#include <cstdint>

namespace fettle::engine {

/// While one lives, every new database connection of this process goes through it to the real files. It can
/// be made to run full, and to lose power. One at a time.
class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  enum class Fault : std::uint8_t { kOnce, kFromThenOn };
  /// The n-th write, flush or truncation from now on (1 = the next) fails: a write as on a full disk, a flush
  /// as on a broken one.
  void failAt(std::int64_t n, Fault fault);
  /// No more faults.
  void heal();
  /// Writes, flushes and truncations since failAt or heal.
  [[nodiscard]] std::int64_t operations() const;
  /// Whether a fault has struck since failAt.
  [[nodiscard]] bool struck() const;

  /// Everything fails from now on, and what was written but not flushed is taken back from the real files:
  /// all of it with `keep_of_256` = 0, else each write stays with that chance, as a disk that writes in any
  /// order leaves it.
  void cutPower(int keep_of_256, std::uint64_t seed);
};

}  // namespace fettle::engine
