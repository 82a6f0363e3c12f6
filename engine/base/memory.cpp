#include "engine/base/memory.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

namespace fettle::engine {

namespace {

std::optional<std::uint64_t> numberIn(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  if (file >> number) return number;
  return std::nullopt;
}

// The number after `key` in a file of lines "key number ...".
std::optional<std::uint64_t> numberOf(const std::string& path, std::string_view key) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string word;
    std::uint64_t number = 0;
    if (words >> word && word == key && words >> number) return number;
  }
  return std::nullopt;
}

// Memory left within a control group's limit. Its files have different names in versions 2 and 1 of the
// interface.
std::optional<std::uint64_t> leftOf(const std::string& group, const char* limit_name, const char* used_name) {
  const auto limit = numberIn(group + limit_name);
  const auto used = numberIn(group + used_name);
  if (!limit || !used) return std::nullopt;
  // Pages of files are released when memory is needed.
  std::uint64_t cache = 0;
  for (const char* key : {"inactive_file", "active_file"})
    cache += numberOf(group + "/memory.stat", key).value_or(0);
  const std::uint64_t taken = *used > cache ? *used - cache : 0;
  return *limit > taken ? *limit - taken : 0;
}

}  // namespace

std::uint64_t availableMemory(const std::string& root) {
  constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t available = kUnknown;
  if (const auto kilobytes = numberOf(root + "/proc/meminfo", "MemAvailable:")) available = *kilobytes * 1024;
  const auto consider = [&available](std::optional<std::uint64_t> left) {
    if (left) available = std::min(available, *left);
  };
  // A container shows its own group as the root of all.
  const std::string all = root + "/sys/fs/cgroup", memory = all + "/memory";
  consider(leftOf(all, "/memory.max", "/memory.current"));
  consider(leftOf(memory, "/memory.limit_in_bytes", "/memory.usage_in_bytes"));
  std::ifstream groups(root + "/proc/self/cgroup");
  std::string line;
  while (std::getline(groups, line)) {
    // "number:controllers:path"; version 2 has no controllers.
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string path = line.substr(second + 1);
    if (controllers.empty()) consider(leftOf(all + path, "/memory.max", "/memory.current"));
    if (controllers == "memory")
      consider(leftOf(memory + path, "/memory.limit_in_bytes", "/memory.usage_in_bytes"));
  }
  return available == kUnknown ? 0 : available;
}

ResidentMemory residentMemory() {
  const auto bytes = [](std::string_view key) {
    return numberOf("/proc/self/status", key).value_or(0) * 1024;
  };
  return {bytes("VmRSS:"), bytes("VmHWM:"), bytes("RssAnon:")};
}

void releaseFreeMemory() {
  malloc_trim(0);
}

void keepFreeMemory() noexcept {
  // Setting one of these ends what the library adapts by itself, so that all three are set. What it adapts at most:
  constexpr int kLargestInHeap = 32 << 20;
  static_cast<void>(mallopt(M_MMAP_THRESHOLD, kLargestInHeap));
  static_cast<void>(mallopt(M_TRIM_THRESHOLD, 256 << 20));
  static_cast<void>(mallopt(M_TOP_PAD, 16 << 20));
}

bool resetPeak() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5";
  file.flush();
  return file.good();
}

}  // namespace fettle::engine
