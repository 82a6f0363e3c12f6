#include "engine/base/memory.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

constexpr std::uint64_t kMega = std::uint64_t{1} << 20;

// The files of a system with 8,000 MB of memory available, and of what limits its processes.
class AvailableMemory : public testing::Test {
 protected:
  void SetUp() override {
    write("proc/meminfo", "MemTotal:       16384000 kB\nMemFree: 1024 kB\nMemAvailable:    8192000 kB\n");
  }

  void write(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_.path() / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  void limit(const std::string& group, std::uint64_t most, std::uint64_t used, std::uint64_t cache = 0) {
    write(group + "/memory.max", std::to_string(most) + "\n");
    write(group + "/memory.current", std::to_string(used) + "\n");
    write(group + "/memory.stat", "anon 17\ninactive_file " + std::to_string(cache / 4) + "\nactive_file " +
                                      std::to_string(cache - cache / 4) + "\n");
  }
  [[nodiscard]] std::uint64_t found() const { return availableMemory(folder_.path().string()); }

  fettle::tests::TempFolder folder_;
};

TEST_F(AvailableMemory, IsTheSystemsWhereNothingLimitsTheProcess) {
  EXPECT_EQ(found(), 8000 * kMega);
  write("proc/self/cgroup", "0::/user.slice/session-1.scope\n");
  EXPECT_EQ(found(), 8000 * kMega);
  write("sys/fs/cgroup/user.slice/session-1.scope/memory.max", "max\n");
  write("sys/fs/cgroup/user.slice/session-1.scope/memory.current", "1048576\n");
  EXPECT_EQ(found(), 8000 * kMega);
}

TEST_F(AvailableMemory, IsTheRestOfTheProcesssGroupWithItsFileCache) {
  write("proc/self/cgroup", "0::/user.slice/session-1.scope\n");
  limit("sys/fs/cgroup/user.slice/session-1.scope", 1000 * kMega, 700 * kMega, 200 * kMega);
  EXPECT_EQ(found(), 500 * kMega);
  // Of another process's group nothing counts, and a limit above what the system has is none.
  limit("sys/fs/cgroup/user.slice/session-2.scope", 10 * kMega, 9 * kMega);
  EXPECT_EQ(found(), 500 * kMega);
  limit("sys/fs/cgroup/user.slice/session-1.scope", 90000 * kMega, 700 * kMega);
  EXPECT_EQ(found(), 8000 * kMega);
  limit("sys/fs/cgroup/user.slice/session-1.scope", 1000 * kMega, 1700 * kMega, 200 * kMega);
  EXPECT_EQ(found(), 0U);
}

TEST_F(AvailableMemory, IsTheRestOfTheContainersGroup) {
  write("proc/self/cgroup", "0::/\n");
  limit("sys/fs/cgroup", 3000 * kMega, 1000 * kMega);
  EXPECT_EQ(found(), 2000 * kMega);
}

TEST_F(AvailableMemory, IsTheRestOfTheGroupOfTheFirstInterface) {
  write("proc/self/cgroup", "12:cpu,cpuacct:/other\n5:memory:/job/7\n0::/unlimited\n");
  const std::string group = "sys/fs/cgroup/memory/job/7";
  write(group + "/memory.limit_in_bytes", std::to_string(800 * kMega));
  write(group + "/memory.usage_in_bytes", std::to_string(300 * kMega));
  write(group + "/memory.stat", "inactive_file 0\nactive_file " + std::to_string(100 * kMega) + "\n");
  EXPECT_EQ(found(), 600 * kMega);
}

TEST_F(AvailableMemory, IsNoneWhereNothingIsKnown) {
  EXPECT_EQ(availableMemory(folder_.file("nothing")), 0U);
  // Of this system it is known.
  EXPECT_GT(availableMemory(), kMega);
}

}  // namespace
}  // namespace fettle::engine
