#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>

namespace fettle::fake {

/// What a test in another process sets and reads while a program uses a replacement of a maker's library: a file that both map. What the
/// device applied stays in it when the program is killed.
struct SharedPage {
  static constexpr std::size_t kMost = 200'000;  // forces

  std::atomic<bool> plugged{true}, stalled{false}, garbage{false};
  std::atomic<double> up_mm{30.0};                  ///< of the hand, above the middle of the workspace
  std::atomic<double> right_mm{0.0}, away_mm{0.0};  ///< of it, likewise
  std::atomic<double> turn_rad{
      0.0};  ///< of the stylus, from one that lies and points away, about the vertical, seen from above
  std::atomic<bool> wrist{false};  ///< libdhd.so: the device measures how it is held
  std::atomic<int> buttons{0};     ///< that are held, the first is bit 0
  std::atomic<std::size_t> forces{0};
  std::atomic<float>
      force_n[kMost];  ///< strength of each force that was applied, about a millisecond after the one before

  void push(double strength_n) {
    const std::size_t n = forces.load();
    if (n < kMost) force_n[n] = static_cast<float>(strength_n);
    if (n < kMost) forces = n + 1;
  }

  /// The mapped file, made where it is not there; null where it cannot be.
  [[nodiscard]] static SharedPage* map(const char* path) {
    if (path == nullptr) return nullptr;
    const bool made = access(path, F_OK) != 0;
    const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || ftruncate(file, sizeof(SharedPage)) != 0) return nullptr;
    void* const memory = mmap(nullptr, sizeof(SharedPage), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (memory == MAP_FAILED) return nullptr;
    return made ? new (memory) SharedPage : static_cast<SharedPage*>(memory);
  }
};

}  // namespace fettle::fake
