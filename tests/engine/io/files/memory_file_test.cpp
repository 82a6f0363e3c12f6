#include <gtest/gtest.h>

#include "engine/io/files/gdal_session.h"

namespace fettle::engine {
namespace {

TEST(MemoryFile, HoldsWhatItWasGivenAndBeforeAnythingIsWrittenNothing) {
  const GdalSession quiet;
  EXPECT_TRUE(MemoryFile(".tif").bytes().empty());
  const MemoryFile given(".txt", "some bytes");
  EXPECT_EQ(given.bytes(), "some bytes");
  EXPECT_NE(given.path(), MemoryFile(".txt", "others").path());
}

}  // namespace
}  // namespace fettle::engine
