// The same bits at every level of vector instructions, and from both compilers.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace fettle::tests {
namespace {

// What a program prints that hashes the results of all kernels; a level that the processor lacks is the best
// below it.
std::string hashes(const std::string& program, const std::string& level) {
  const Outcome outcome = runProcess({"/usr/bin/env", "FETTLE_CPU=" + level, program});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.out;
}

TEST(Kernels, GiveTheSameBitsAtEveryLevel) {
  const std::string plain = hashes(FETTLE_KERNEL_HASHES, "plain");
  EXPECT_GT(plain.size(), 1000U);
  EXPECT_EQ(hashes(FETTLE_KERNEL_HASHES, "avx2"), plain);
  EXPECT_EQ(hashes(FETTLE_KERNEL_HASHES, "avx512"), plain);
}

TEST(Kernels, GiveTheSameBitsFromClang) {
  const std::string program = FETTLE_CLANG_KERNEL_HASHES;
  if (program.empty()) GTEST_SKIP() << "no clang++, or a build with sanitizers";
  const std::string gcc = hashes(FETTLE_KERNEL_HASHES, "avx512");
  for (const std::string level : {"plain", "avx2", "avx512"}) EXPECT_EQ(hashes(program, level), gcc) << level;
}

}  // namespace
}  // namespace fettle::tests
