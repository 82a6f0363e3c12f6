// A field that is larger than the memory it may take, on one machine.

#include <csignal>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/io/tiff/plain_tiff.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A surface with noise in rows that repeat, so that making it takes no time.
void writeField(const std::string& path, int width, int height) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  const auto layout = engine::createPlainTiff(grid, path);
  ASSERT_TRUE(layout) << layout.error().line();
  auto rows = engine::PlainRows::open(path, *layout);
  ASSERT_TRUE(rows);
  constexpr int kRows = 64;
  std::vector<float> z(static_cast<std::size_t>(width) * kRows);
  std::uint32_t random = 1;
  for (float& height_here : z) {
    random = random * 1664525U + 1013904223U;
    height_here = 1e-3F * static_cast<float>(random >> 22);
  }
  for (int row = 0; row < height; row += kRows)
    ASSERT_TRUE(rows->write(row, std::min(kRows, height - row), z.data()));
}

TEST(ShardsInTurn, AFieldOfTwiceTheMemoryIsFilteredInItWithTheBitsOfOneRun) {
  const TempFolder folder;
  const std::string scan = folder.file("big.tif"), out = folder.file("out.tif");
  writeField(scan, 8192, 8192);  // 256 MiB of samples
  const std::vector<std::string> filter{"filter", scan, out, "--filter", "box", "--threads", "1"};
  std::vector<std::string> in_turn = filter;
  in_turn.insert(in_turn.end(), {"--shards-in-turn", "--memory", "130MB", "--json"});
  const Outcome done = fettle(in_turn);
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_LE(done.peak_bytes, 130'000'000U);
  const auto report = nlohmann::json::parse(done.out);
  EXPECT_GT(report["bands"], 1);
  std::vector<std::string> whole = filter;
  whole[2] = folder.file("whole.tif");
  EXPECT_EQ(fettleJson(whole)["hash"], report["hash"]);
  EXPECT_FALSE(std::filesystem::exists(out + ".shards"));
  expectRefused(fettle({"filter", scan, out, "--filter", "box", "--shards-in-turn", "--memory", "20MB"}),
                "a band of one row of tiles takes");
}

TEST(ShardsInTurn, ShardsThatWerePlannedForOthersStay) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), out = folder.file("out.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "64x300"}).status, 0);
  (void)fettleJson({"plan", "filter", scan, out, "--filter", "box", "--shards", "2"});
  (void)fettleJson({"filter", scan, out, "--filter", "box", "--shard", "1"});
  expectRefused(fettle({"filter", scan, out, "--filter", "box", "--shards-in-turn"}),
                "gather its shards, or remove the folder");
  EXPECT_EQ(fettleJson({"status", out})["done"], nlohmann::json({1}));
}

TEST(ShardsInTurn, TheirPlanIsNoneForOtherProcesses) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), out = folder.file("out.tif");
  writeField(scan, 4096, 1024);
  const std::vector<std::string> words{"filter", scan, out, "--filter", "box", "--threads", "1"};
  const auto with = [&](std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  ProcessOptions kill_it;
  kill_it.while_running = [&](int pid) {
    if (!std::filesystem::exists(out + ".shards/shard-1.json")) return false;
    kill(pid, SIGKILL);
    return true;
  };
  const auto in_turn = with(words, {"--shards-in-turn", "--memory", "105MB"});
  EXPECT_NE(fettle(in_turn, kill_it).status, 0);
  const auto bands = nlohmann::json::parse(std::ifstream(out + ".shards/plan.json"))["shards"].get<int>();
  expectRefused(fettle({"submit", out, "--engine", "local"}), "worked on in turn by one process");
  // A plan of as many shards would be the same work, and is another's.
  const auto plan = with(with({"plan"}, words), {"--shards", std::to_string(bands)});
  expectRefused(fettle(plan), "there is another plan");
  (void)fettleJson(with(plan, {"--again"}));
  EXPECT_EQ(fettle({"submit", out, "--engine", "local"}).status, 0);
  expectRefused(fettle(in_turn), "there is another plan");
}

TEST(ShardsInTurn, KilledInTheMiddleTheSameCommandContinues) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), out = folder.file("out.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "2048x640"}).status, 0);
  const std::vector<std::string> filter{"filter",   scan,   out,         "--filter", "tv",
                                        "--window", "21",   "--threads", "1",        "--shards-in-turn",
                                        "--memory", "100MB"};
  ProcessOptions kill_it;
  kill_it.while_running = [&](int pid) {
    if (!std::filesystem::exists(out + ".shards/shard-2.json")) return false;
    kill(pid, SIGKILL);
    return true;
  };
  EXPECT_NE(fettle(filter, kill_it).status, 0);
  EXPECT_FALSE(std::filesystem::exists(out));
  const auto report = fettleJson(filter);
  EXPECT_GE(report["bands_kept"], 2);
  EXPECT_LT(report["bands_kept"], report["bands"]);
  EXPECT_EQ(
      fettleJson({"filter", scan, folder.file("whole.tif"), "--filter", "tv", "--window", "21"})["hash"],
      report["hash"]);
}

TEST(ShardsInTurn, WithMoreMemoryOrNoneGivenTheBandsThatAreDoneAreKept) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif");
  writeField(scan, 4096, 1024);
  // Cut off after a band, and continued by a command that alone would take fewer bands.
  for (const std::vector<std::string>& memory : {std::vector<std::string>{"--memory", "400MB"}, {}}) {
    const std::string out = folder.file(memory.empty() ? "b.tif" : "a.tif");
    const std::vector<std::string> filter{"filter", scan,        out, "--filter",
                                          "box",    "--threads", "1", "--shards-in-turn"};
    const auto with = [&](const std::vector<std::string>& more) {
      std::vector<std::string> words = filter;
      words.insert(words.end(), more.begin(), more.end());
      return words;
    };
    ProcessOptions kill_it;
    kill_it.while_running = [&](int pid) {
      if (!std::filesystem::exists(out + ".shards/shard-1.json")) return false;
      kill(pid, SIGKILL);
      return true;
    };
    EXPECT_NE(fettle(with({"--memory", "105MB"}), kill_it).status, 0);
    const auto planned = nlohmann::json::parse(std::ifstream(out + ".shards/plan.json"))["shards"];
    ASSERT_GT(planned, 2);
    const auto report = fettleJson(with(memory));
    EXPECT_EQ(report["bands"], planned);
    EXPECT_GE(report["bands_kept"], 1);
  }
}

TEST(ShardsInTurn, WhatIsNotWrittenRowByRowIsRefusedBeforeAnythingIsDone) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "64x300"}).status, 0);
  for (const std::vector<std::string>& out :
       {std::vector<std::string>{folder.file("out.asc")}, {folder.file("out.tif"), "--compress", "zstd"}}) {
    std::vector<std::string> words{"filter", scan};
    words.insert(words.end(), out.begin(), out.end());
    words.insert(words.end(), {"--filter", "box", "--shards-in-turn"});
    expectRefused(fettle(words), "written row by row");
    EXPECT_FALSE(std::filesystem::exists(out.front() + ".shards"));
  }
}

}  // namespace
}  // namespace fettle::tests
