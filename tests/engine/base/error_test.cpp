#include "engine/base/error.h"

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

TEST(Error, LineJoinsWhatIsThere) {
  EXPECT_EQ((Error{ErrorKind::kInput, "no such file", "a.tif", "check the name"}.line()),
            "no such file, a.tif, check the name");
  EXPECT_EQ((Error{ErrorKind::kFailed, "no device", "", "install a driver"}.line()),
            "no device, install a driver");
}

TEST(Error, LineStaysOneLineWhateverTheFileIsCalled) {
  EXPECT_EQ((Error{ErrorKind::kInput, "no such file", "a\nb\x1b[31m.tif", ""}.line()),
            "no such file, a b [31m.tif");
}

}  // namespace
}  // namespace fettle::engine
