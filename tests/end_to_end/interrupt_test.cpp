#include <csignal>

#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A file of this process's that grows threads only once its job runs: the moment to interrupt is when the
// program has more than one thread, not some time that a slow machine would miss.
bool hasWorkers(int pid) {
  int threads = 0;
  std::error_code gone;
  for (auto it = std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task", gone);
       !gone && it != std::filesystem::directory_iterator(); it.increment(gone))
    ++threads;
  return threads > 1;
}

TEST(Interrupt, CtrlCEndsAFilterCleanlyAndWritesNothing) {
  const TempFolder folder;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "1500x1500"}).status, 0);
  std::chrono::steady_clock::time_point sent;
  ProcessOptions options;
  options.while_running = [&sent](int pid) {
    if (!hasWorkers(pid)) return false;
    kill(pid, SIGINT);
    sent = std::chrono::steady_clock::now();
    return true;
  };
  // 1000 passes would take minutes.
  const Outcome outcome = fettle({"filter", folder.file("s.tif"), folder.file("o.tif"), "--filter", "median",
                                  "--window", "31", "--passes", "1000"},
                                 options);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.err, "fettle: error: cancelled, nothing was written\n");
  EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(5));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 1);
}

}  // namespace
}  // namespace fettle::tests
