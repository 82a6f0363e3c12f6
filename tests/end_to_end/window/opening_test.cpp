// A scan that takes a while to open: what is on the screen until it is seen.
#include <csignal>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = Hand::State;

TEST_F(WindowTest, a_large_scan_says_what_it_is_at_until_it_is_seen) {
  const std::string large = folder.file("large.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "1100x1000", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  const auto says = [](const State& s, const char* what) {
    return s["texts"].dump().find(what) != std::string::npos;
  };
  program->until("the first picture is made",
                 [&](const State& s) { return says(s, "making the first picture"); });
  EXPECT_FALSE(says(opened(*program), "making the first picture"));
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  const State report = program->report();
  EXPECT_GT(report["open_read_ms"], 0.0);
  EXPECT_GE(report["open_touched_ms"], report["open_read_ms"]);
  EXPECT_GE(report["open_first_picture_ms"], report["open_touched_ms"]);
  EXPECT_GE(report["open_whole_picture_ms"], report["open_first_picture_ms"]);
}

}  // namespace
}  // namespace fettle::tests
