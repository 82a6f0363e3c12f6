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
  /// Asks the system to write them out and forget them, which it does with all that are not locked. Whether
  /// it took any.
  bool sendOut() const {
    const std::size_t page = bytes_ / count_;
    msync(reinterpret_cast<void*>(begin_), bytes_, MS_SYNC);
    bool any = false;
    for (std::uintptr_t at = begin_; at < begin_ + bytes_; at += page)
      any = madvise(reinterpret_cast<void*>(at), page, MADV_PAGEOUT) == 0 || any;
    return any;
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
