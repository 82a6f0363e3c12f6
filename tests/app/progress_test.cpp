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

TEST(Progress, SaysHowLongTheStageStillTakesOnceThatIsKnown) {
  engine::JobControl job;
  RemainingTime remaining;
  job.begin("filtering", 1000);
  EXPECT_FALSE(remaining.at(0.0, job, nullptr));
  job.advance(5);
  EXPECT_FALSE(remaining.at(10.0, job, nullptr)) << "less than a hundredth says little";
  job.advance(245);
  EXPECT_DOUBLE_EQ(remaining.at(100.0, job, nullptr).value(), 300.0);
  EXPECT_EQ(progressText(job, nullptr, 300.0),
            "filtering [#######.......................]  25 %, about 5 min left");
  // Another stage has a rate of its own.
  job.begin("writing", 10);
  EXPECT_FALSE(remaining.at(101.0, job, nullptr));
  job.advance(5);
  EXPECT_DOUBLE_EQ(remaining.at(121.0, job, nullptr).value(), 20.0);
  job.cancel();
  EXPECT_TRUE(progressText(job, nullptr, 20.0).ends_with("%  stopping"));
}

TEST(Progress, OfAStageThatIsSeenLateOnlyWhatWasDoneSinceThenCounts) {
  engine::JobControl job;
  RemainingTime remaining;
  job.begin("filtering", 1000);
  job.advance(600);
  EXPECT_FALSE(remaining.at(50.0, job, nullptr));
  job.advance(5);
  EXPECT_FALSE(remaining.at(54.0, job, nullptr)) << "less than a hundredth since it was first seen";
  job.advance(95);
  EXPECT_DOUBLE_EQ(remaining.at(60.0, job, nullptr).value(), 30.0);
}

TEST(Progress, OfABatchTheTimeIsThatOfAllFilesThatAreLeft) {
  engine::JobControl job;
  BatchState batch;
  batch.count = 5;
  RemainingTime remaining;
  EXPECT_FALSE(remaining.at(0.0, job, &batch));
  EXPECT_FALSE(remaining.at(50.0, job, &batch)) << "no file is finished";
  batch.done = 2;
  EXPECT_DOUBLE_EQ(remaining.at(60.0, job, &batch).value(), 90.0);
  EXPECT_DOUBLE_EQ(remaining.at(70.0, job, &batch).value(), 80.0);
  EXPECT_DOUBLE_EQ(remaining.at(900.0, job, &batch).value(), 0.0) << "a file slower than those before";
}

}  // namespace
}  // namespace fettle::app
