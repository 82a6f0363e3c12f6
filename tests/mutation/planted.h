#pragma once

// Included before everything else in a build with planted errors (scripts/mutate): each is there, and the environment's
// FETTLE_PLANT chooses the one that is at work. With FETTLE_PLANT_MAP, a file, the process appends the numbers of the
// plants that it came past: a test program after each case (map_cases.cpp), another when it ends.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>

namespace fettle_planted {

inline constexpr int kMost = 4096;

inline int chosenNow() {
  const char* text = std::getenv("FETTLE_PLANT");
  return text == nullptr ? -1 : std::atoi(text);
}

inline const int chosen = chosenNow();
inline unsigned char passed[kMost];
inline const char* const mapPath = std::getenv("FETTLE_PLANT_MAP");
inline bool caseByCase = false;

// Appends "NAME n n n...\n" in one write, which no other process's comes amid of, and forgets what was passed.
inline void tell(const char* name) {
  static char line[6 * kMost + 1024];
  int length = std::snprintf(line, 1000, "%s", name);
  for (int k = 0; k < kMost; ++k) {
    if (passed[k] != 0) length += std::snprintf(line + length, 8, " %d", k);
  }
  line[length++] = '\n';
  std::memset(passed, 0, sizeof passed);
  const int file = ::open(mapPath, O_WRONLY | O_APPEND | O_CREAT, 0644);
  if (file < 0) return;
  if (::write(file, line, static_cast<unsigned>(length)) != length) std::abort();
  ::close(file);
}

struct AtEnd {
  ~AtEnd() {
    if (mapPath != nullptr && !caseByCase) tell("-");
  }
};
inline const AtEnd atEnd;

// Whether the plant is at work. What is computed while compiling has no plants.
constexpr bool at(int plant) noexcept {
  if (std::is_constant_evaluated()) return false;
  passed[plant] = 1;  // by any thread, always the same byte
  return chosen == plant;
}

}  // namespace fettle_planted
