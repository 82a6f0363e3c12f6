// The window's side of a headset on the test runtime (tests/xr_runtime).
#include "app/xr/headset_view.h"

#include <thread>

#include <gtest/gtest.h>

#include "tests/xr_runtime/xr_stage.h"

namespace fettle::app {
namespace {

using namespace std::chrono_literals;
using tests::XrStage;

TEST(HeadsetView, a_runtime_that_does_not_start_is_an_error_after_a_while) {
  const XrStage stage("start-hangs\n");
  stage.set();
  const auto view = HeadsetView::start({.frames = {}, .wake = {}, .starts_within = 100ms});
  ASSERT_FALSE(view);
  EXPECT_NE(view.error().line().find("runtime does not answer"), std::string::npos) << view.error().line();
  EXPECT_EQ(stage.count("session"), 0);
  // Its thread was left: where the runtime answers after all it ends what it has begun.
  stage.act("answer\n");
  for (int tries = 0; stage.count("instance destroyed") == 0 && tries < 2000; ++tries)
    std::this_thread::sleep_for(5ms);
  stage.expectLeftInOrder(XrStage::Session::kNeverRan);
}

TEST(HeadsetView, a_session_is_ended_in_order_and_one_that_hangs_is_left) {
  const XrStage stage("size 64 64\nrate 60\n0 head 0 0.3 -0.2 0 -45\n30 hang\n");
  stage.set();
  for (const bool hangs : {false, true}) {
    auto view = HeadsetView::start({});
    ASSERT_TRUE(view) << view.error().line();
    while (hangs && stage.count("hangs before frame 30") == 0) std::this_thread::sleep_for(5ms);
    while (hangs && !(*view)->stands()) std::this_thread::sleep_for(5ms);
    EXPECT_EQ((*view)->stands(), hangs);
    EXPECT_EQ((*view)->finish(), !hangs);
    EXPECT_EQ((*view)->state().over, !hangs);
    EXPECT_TRUE((*view)->finish()) << "nothing is waited for twice";
  }
  stage.act("answer\n");
  for (int tries = 0; stage.count("instance destroyed") < 2 && tries < 2000; ++tries)
    std::this_thread::sleep_for(5ms);
  EXPECT_EQ(stage.count("instance destroyed"), 2);
  stage.expectSilence();
}

}  // namespace
}  // namespace fettle::app
