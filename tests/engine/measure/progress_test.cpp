// What a progress bar shows of measuring: how much there is to do is said before it is done, and in the end all of it is.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "engine/measure/hills.h"
#include "engine/measure/spatial.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

double wavy(int c, int r) {
  return std::sin(0.31 * c) * std::cos(0.23 * r) + 0.01 * ((c * 7 + r * 13) % 17);
}

TEST(MeasuringProgress, OfHillsIsThatOfTheSamples) {
  const Surface surface = surfaceOf(90, 70, wavy);
  JobControl job;
  ASSERT_TRUE(mapHills(surface, 0.1, job));
  EXPECT_EQ(job.stage(), std::string("segmenting hills"));
  EXPECT_EQ(job.total(), 90U * 70U);
  EXPECT_LE(job.done(), job.total());
}

TEST(MeasuringProgress, OfCorrelatingEndsWithAllItsSteps) {
  JobControl job;
  ASSERT_TRUE(correlate(surfaceOf(90, 70, wavy), job));
  EXPECT_EQ(job.stage(), std::string("correlating"));
  EXPECT_GT(job.total(), 0U);
  EXPECT_EQ(job.done(), job.total());
}

}  // namespace
}  // namespace fettle::engine
