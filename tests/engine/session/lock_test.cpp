#include "engine/session/session_lock.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

TEST(SessionLock, ItsHolderIsAProcessOrAnotherProgram) {
  const tests::TempFolder folder;
  const std::string session = folder.file("a.fettle");
  const auto holder = [&](const std::string& line) {
    std::ofstream(session + "-lock") << line << '\n';
    return SessionLock::holder(session);
  };
  EXPECT_EQ(SessionLock::holder(session), "another program");
  EXPECT_EQ(holder("process 4711"), "process 4711");
  EXPECT_EQ(holder("4711"), "another program");
  // What no process is called is not shown.
  const std::string longest = "process " + std::string(23, '1');
  EXPECT_EQ(holder(longest), longest);
  EXPECT_EQ(holder(longest + "1"), "another program");
}

}  // namespace
}  // namespace fettle::engine
