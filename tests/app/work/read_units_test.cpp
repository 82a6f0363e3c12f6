#include "app/work/read_units.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(ReadUnits, OneIsAsManyOfAnotherAsTheirSizesSay) {
  EXPECT_DOUBLE_EQ(*ratioOfUnits("mm", "\u00b5m"), 1000.0);
  EXPECT_DOUBLE_EQ(*ratioOfUnits("um", "mm"), 1e-3);
  EXPECT_DOUBLE_EQ(*ratioOfUnits("m", "nm"), 1e9);
  EXPECT_EQ(ratioOfUnits("counts", "counts"), 1.0) << "whatever it is, it is the same";
  EXPECT_EQ(ratioOfUnits("counts", "mm"), std::nullopt);
  EXPECT_EQ(ratioOfUnits("mm", "counts"), std::nullopt);
}

TEST(ReadUnits, OnTheScreenMicrometresHaveTheirSign) {
  EXPECT_EQ(readLengthAs(0.02, 1.0, "mm").name, "um");
  const ReadAs as = readOnScreenAs(0.02, 1.0, "mm");
  EXPECT_EQ(as.name, "\u00b5m");
  EXPECT_DOUBLE_EQ(0.02 / as.size, 20.0);
}

}  // namespace
}  // namespace fettle::app
