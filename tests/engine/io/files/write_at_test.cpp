#include "engine/io/files/write_at.h"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

TEST(WriteAt, PutsAllBytesWhereTheyBelongAndLeavesTheRest) {
  const tests::TempFolder folder;
  writeBytes(folder.file("f"), "0123456789");
  const int file = ::open(folder.file("f").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(file, 0);
  EXPECT_EQ(writeAt(file, "abc", 4), 0);
  EXPECT_EQ(writeAt(file, "", 2), 0);
  EXPECT_EQ(writeAt(file, "xy", 9), 0);
  EXPECT_EQ(lseek(file, 0, SEEK_CUR), 0);
  // More than the system takes from a pipe or a disk at once.
  const std::string large(std::size_t{3} << 20, 'z');
  EXPECT_EQ(writeAt(file, large, 20), 0);
  ::close(file);
  EXPECT_EQ(readBytes(folder.file("f")), "0123abc78xy" + std::string(9, '\0') + large);
}

TEST(WriteAt, GivesTheSystemsErrorAndEnds) {
  const int full = ::open("/dev/full", O_RDWR | O_CLOEXEC);
  ASSERT_GE(full, 0);
  EXPECT_EQ(writeAt(full, "abc", 0), ENOSPC);
  ::close(full);
  EXPECT_EQ(writeAt(full, "abc", 0), EBADF);
}

}  // namespace
}  // namespace fettle::engine
