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

TEST(ReadUnits, LengthsAlongASurfaceGoByItsSpacing) {
  EXPECT_EQ(readAcrossAs(0.05, 1.0, "mm"), (ReadAs{"mm", 1.0}));
  EXPECT_EQ(readAcrossAs(0.5, 1000.0, "m").name, "m");
  const ReadAs of_film = readAcrossAs(0.977, 1e-6, "nm");  // of an atomic force microscope
  EXPECT_EQ(of_film.name, "um");
  EXPECT_DOUBLE_EQ(of_film.size, 1000.0);
}

TEST(ReadUnits, OnTheScreenMicrometresHaveTheirSign) {
  EXPECT_EQ(readLengthAs(0.02, 1.0, "mm").name, "um");
  const ReadAs as = readOnScreenAs(0.02, 1.0, "mm");
  EXPECT_EQ(as.name, "\u00b5m");
  EXPECT_DOUBLE_EQ(0.02 / as.size, 20.0);
}

}  // namespace
}  // namespace fettle::app
