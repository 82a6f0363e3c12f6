#include "bench/machine.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "engine/base/stopwatch.h"

namespace fettle::bench {

std::string machine() {
  std::string processor = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) {
      processor = line.substr(std::min(line.find(':') + 2, line.size()));
      break;
    }
#ifdef NDEBUG
  const char* build = "release";
#else
  const char* build = "with assertions";
#endif
  return fmt::format("{} x {}, {}, {}", processor, std::thread::hardware_concurrency(), __VERSION__, build);
}

double copyBytesPerSecond() {
  constexpr std::size_t kBytes = std::size_t{64} << 20;
  const std::vector<char> from(kBytes, 1);
  std::vector<char> to(kBytes, 0);
  double best = 0.0;
  for (int i = 0; i < 5; ++i) {
    const engine::Stopwatch watch;
    std::memcpy(to.data(), from.data(), kBytes);
    const double seconds = watch.seconds();
    best = std::max(best, static_cast<double>(kBytes) / seconds);
  }
  return best;
}

}  // namespace fettle::bench
