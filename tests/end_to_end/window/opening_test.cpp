// A scan that takes a while to open: what is on the screen until it is seen.
#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

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

TEST_F(WindowTest, a_large_scan_is_seen_coarsely_first_and_goes_on_from_where_it_was_turned) {
  const std::string large = folder.file("large.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "3000x2800", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "coarse");
  const State coarse = program->until("a coarse picture", [](const State& s) { return s["coarse"] == true; });
  EXPECT_NE(coarse["texts"].dump().find("coarse picture, 1 sample in"), std::string::npos);
  EXPECT_FALSE(coarse.contains("tool")) << "nothing to touch yet";
  EXPECT_EQ(coarse["path"], "");
  (void)user.press("Left");
  const State whole = opened(*program);
  EXPECT_EQ(whole["coarse"], false);
  EXPECT_EQ(whole["texts"].dump().find("coarse picture"), std::string::npos);
  EXPECT_NE(whole["view"], coarse["view"]);
  const State report = quit(user);
  EXPECT_GT(report["open_coarse_picture_ms"], 0.0);
  EXPECT_GE(report["open_read_ms"], report["open_coarse_picture_ms"]);
}

// Halves the byte count of a block in the middle of a little-endian classic TIFF: its first rows, which are
// all that a coarse picture looks at, are whole.
bool cutABlockShort(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto number = [&](std::uint64_t at, int bytes) {
    std::uint64_t value = 0;
    file.seekg(static_cast<std::streamoff>(at));
    for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(file.get()) << (8 * i);
    return value;
  };
  constexpr std::uint64_t kTileByteCounts = 325, kLong = 4;
  const std::uint64_t directory = number(4, 4);
  const std::uint64_t entries = number(directory, 2);
  for (std::uint64_t entry = directory + 2; entry < directory + 2 + 12 * entries; entry += 12) {
    if (number(entry, 2) != kTileByteCounts || number(entry + 2, 2) != kLong) continue;
    const std::uint64_t at = number(entry + 8, 4) + 4 * (number(entry + 4, 4) - 1);
    const std::uint64_t whole = number(at, 4);
    const std::uint64_t cut = whole - whole / 16;
    file.seekp(static_cast<std::streamoff>(at));
    for (int i = 0; i < 4; ++i) file.put(static_cast<char>(cut >> (8 * i)));
    return static_cast<bool>(file.flush());
  }
  return false;
}

TEST_F(WindowTest, a_coarse_picture_goes_when_the_rest_of_the_scan_cannot_be_read) {
  const std::string broken = folder.file("broken.tif");
  // Packed: no reader can detect damage in plain blocks.
  const std::string whole = folder.file("whole.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", whole, "--size", "5120x5120", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "convert", whole, broken, "--compress", "deflate"}).status, 0);
  ASSERT_TRUE(cutABlockShort(broken));
  const auto program = start({});
  User user(display, *program, "broken");
  program->until("an empty window", [](const State& s) {
    return s["path"] == "" && s["texts"].dump().find("Drop a scan here") != std::string::npos;
  });
  const Screen empty = user.look("empty");
  EXPECT_EQ(other.drop(other.windowOf("fettle"), {broken}), "");
  program->until("a coarse picture", [](const State& s) { return s["coarse"] == true; });
  program->until("what is wrong",
                 [](const State& s) { return s["dialog"] == "message" && s["coarse"] == false; });
  (void)user.press("Return");
  program->until("no message", [](const State& s) { return s["dialog"] == "none"; });
  (void)user.same("empty again", empty);
  EXPECT_EQ(program->now()["path"], "");
}

}  // namespace
}  // namespace fettle::tests
