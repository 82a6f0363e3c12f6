#include "engine/io/files/gdal_session.h"

#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

TEST(GdalSession, KeepsTheFirstFailureInPlainWordsAndNothingIsPrinted) {
  ::testing::internal::CaptureStderr();
  GdalSession session;
  CPLError(CE_Warning, CPLE_AppDefined, "what is only a warning");
  EXPECT_FALSE(session.failed());
  EXPECT_EQ(session.reason("nothing"), "nothing");
  CPLError(CE_Failure, CPLE_AppDefined, "/a/path.tif, band 1: TIFFFetch:the first.");
  CPLError(CE_Failure, CPLE_AppDefined, "what follows from it");
  EXPECT_TRUE(session.failed());
  EXPECT_EQ(session.reason("nothing"), "the first");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// Messages for GDAL's developers, which a user's environment may ask for, would come between those of the program: those of
// GDAL's own threads no session hears.
TEST(GdalSession, MessagesForDevelopersAreNotPrintedWhateverTheEnvironmentSays) {
  setenv("CPL_DEBUG", "ON", 1);
  { const GdalSession first; }
  ::testing::internal::CaptureStderr();
  std::thread([] { CPLDebug("FETTLE", "of a thread of its own"); }).join();
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  unsetenv("CPL_DEBUG");
}

}  // namespace
}  // namespace fettle::engine
