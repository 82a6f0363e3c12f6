#pragma once

// Included before everything else in a build with planted errors (scripts/mutate): each is there, and the environment's
// FETTLE_PLANT chooses the one that is at work. With FETTLE_PLANT_MAP, a file, the process appends the numbers of the
// plants that it came past.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace fettle_planted {

inline constexpr int kMost = 4096;

inline int chosenNow() {
  const char* text = std::getenv("FETTLE_PLANT");
  return text == nullptr ? -1 : std::atoi(text);
}

inline const int chosen = chosenNow();
inline unsigned char passed[kMost];

// Writes what was passed when the process ends, one whole line for each.
struct Map {
  const char* path = std::getenv("FETTLE_PLANT_MAP");
  ~Map() {
    if (path == nullptr) return;
    const int file = ::open(path, O_WRONLY | O_APPEND | O_CREAT, 0644);
    for (int k = 0; file >= 0 && k < kMost; ++k) {
      if (passed[k] == 0) continue;
      char line[16];
      const int length = std::snprintf(line, sizeof line, "%d\n", k);
      if (::write(file, line, static_cast<unsigned>(length)) != length) break;
    }
    if (file >= 0) ::close(file);
  }
};
inline const Map map;

// Whether the plant is at work. What is computed while compiling has no plants.
constexpr bool at(int plant) noexcept {
  if (std::is_constant_evaluated()) return false;
  passed[plant] = 1;  // by any thread, always the same byte
  return chosen == plant;
}

}  // namespace fettle_planted
