#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#ifndef MADV_PAGEOUT
#define MADV_PAGEOUT 21  // Linux 5.4
#endif

namespace fettle::tests {

/// The pages under an object.
class Pages {
 public:
  template <class T>
  explicit Pages(const T* object) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    begin_ = reinterpret_cast<std::uintptr_t>(object) & ~(page - 1);
    const std::uintptr_t end = (reinterpret_cast<std::uintptr_t>(object + 1) + page - 1) & ~(page - 1);
    bytes_ = end - begin_;
    count_ = bytes_ / page;
  }
  /// Asks the system to write them out and forget them; what is locked stays. False where it cannot.
  bool sendOut() const {
    auto* at = reinterpret_cast<void*>(begin_);
    return msync(at, bytes_, MS_SYNC) == 0 && madvise(at, bytes_, MADV_PAGEOUT) == 0;
  }
  [[nodiscard]] bool allInMemory() const {
    std::vector<unsigned char> states(count_);
    if (mincore(reinterpret_cast<void*>(begin_), bytes_, states.data()) != 0) return false;
    for (const unsigned char state : states)
      if ((state & 1U) == 0) return false;
    return true;
  }

 private:
  std::uintptr_t begin_ = 0;
  std::size_t bytes_ = 0;
  std::size_t count_ = 0;
};

}  // namespace fettle::tests
