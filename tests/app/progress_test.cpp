#include <gtest/gtest.h>

#include "app/terminal.h"

namespace fettle::app {
namespace {

TEST(Progress, OfOneJobIsItsOwnBar) {
  engine::JobControl job;
  job.begin("filtering", 200);
  job.advance(50);
  EXPECT_EQ(progressText(job, nullptr), "filtering [#######.......................]  25 %");
  job.cancel();
  EXPECT_TRUE(progressText(job, nullptr).ends_with("%  stopping"));
}

TEST(Progress, OfManyFilesIsOneBarForAllAndTheShareOfTheOneAtWork) {
  engine::JobControl job;
  BatchState batch;
  batch.count = 10;
  batch.done = 3;
  job.begin("reading", 8);
  job.advance(6);
  EXPECT_EQ(progressText(job, &batch), "[#########.....................] 4 of 10, reading  75 %");
  // A stage that has not said how long it is, and the moment after the last file.
  job.begin("writing", 0);
  batch.done = 10;
  EXPECT_EQ(progressText(job, &batch), "[##############################] 10 of 10, writing   0 %");
}

}  // namespace
}  // namespace fettle::app
