// Many scans that several processes share.

#include <csignal>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class ShardsOfAList : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 5; ++i) {
      scans_.push_back(folder_.file("s" + std::to_string(i) + ".tif"));
      ASSERT_EQ(fettle({"synth", scans_.back(), "--size", "40x30", "--seed", std::to_string(i)}).status, 0);
    }
  }
  [[nodiscard]] std::vector<std::string> command(std::vector<std::string> first,
                                                 const std::vector<std::string>& last) const {
    first.insert(first.end(), scans_.begin(), scans_.end());
    first.insert(first.end(), last.begin(), last.end());
    return first;
  }

  TempFolder folder_;
  std::vector<std::string> scans_;
};

TEST_F(ShardsOfAList, HaveEachScanOnceAndTheReportOfOneRun) {
  const std::string whole = folder_.file("whole"), out = folder_.file("out");
  const auto all = fettleJson(command({"filter"}, {"--out-dir", whole, "--filter", "tv"}));
  for (const char* shard : {"3/3", "1/3"})
    (void)fettleJson(command({"filter"}, {"--out-dir", out, "--filter", "tv", "--shard", shard}));
  expectFailed(fettle({"gather", out}), "1 of 3 shards is not done: 2");
  (void)fettleJson(command({"filter"}, {"--out-dir", out, "--filter", "tv", "--shard", "2/3"}));
  const auto gathered = fettleJson({"gather", out});
  EXPECT_EQ(gathered["done"], 5);
  ASSERT_EQ(gathered["files"].size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(gathered["files"][i]["in"], scans_[i]);
    EXPECT_EQ(gathered["files"][i]["hash"], all["files"][i]["hash"]);
  }
  // More shards than scans: some have nothing to do.
  const auto none = fettleJson(command({"convert"}, {"--out-dir", folder_.file("c"), "--shard", "7/7"}));
  EXPECT_EQ(none["done"], 0);
}

TEST_F(ShardsOfAList, OfMeasuringHaveTheirReportsInAFolder) {
  const std::string folder = folder_.file("m");
  for (const char* shard : {"1/2", "2/2"})
    (void)fettleJson(command(
        {"measure"}, {"--only", "height", "--noise-trials", "0", "--shard", shard, "--shard-dir", folder}));
  const auto gathered = fettleJson({"gather", folder});
  EXPECT_EQ(gathered["done"], 5);
  const auto alone = fettleJson({"measure", scans_[3], "--only", "height", "--noise-trials", "0"});
  EXPECT_EQ(gathered["files"][3]["sq"], alone["sq"]);
  expectRefused(fettle(command({"measure"}, {"--shard", "1/2"})), "--shard-dir");
}

TEST_F(ShardsOfAList, OfSuggestingAndComparingHaveTheReportsOfOneRun) {
  const std::string out = folder_.file("suggested"), worn = folder_.file("worn");
  const std::vector<std::string> suggest{"--out-dir", out, "--suggest", "--tolerance", "20um"};
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  for (const char* shard : {"1/2", "2/2"}) {
    (void)fettleJson(with(command({"filter"}, suggest), {"--shard", shard}));
    (void)fettleJson(command({"compare", scans_[0]}, {"--shard", shard, "--shard-dir", worn}));
  }
  const auto suggested = fettleJson({"gather", out});
  ASSERT_EQ(suggested["files"].size(), 5U);
  const auto alone = fettleJson({"filter", scans_[3], "--suggest", "--tolerance", "20um"});
  EXPECT_EQ(suggested["files"][3]["noise"], alone["noise"]);
  EXPECT_EQ(suggested["files"][3]["pick"]["method"], alone["pick"]["method"]);
  // The outputs are named, and not written.
  const auto& commands = suggested["files"][3]["commands"];
  ASSERT_FALSE(commands.empty()) << suggested["files"][3]["why"];
  EXPECT_NE(commands.back().get<std::string>().find(scans_[3] + " --out-dir " + out + " --filter"),
            std::string::npos)
      << commands;
  EXPECT_FALSE(std::filesystem::exists(out + "/s3.tif"));
  // They run as they are, each with marks of its own.
  for (const auto& command : commands) {
    std::istringstream words(command.get<std::string>());
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    arguments.erase(arguments.begin());
    const Outcome done = fettle(arguments);
    EXPECT_EQ(done.status, 0) << command << done.err;
    if (arguments.front() == "mark") {
      EXPECT_TRUE(std::filesystem::exists(scans_[3] + ".marks.png"));
    }
  }
  EXPECT_TRUE(std::filesystem::exists(out + "/s3.tif"));

  const auto compared = fettleJson({"gather", worn});
  ASSERT_EQ(compared["files"].size(), 5U);
  EXPECT_EQ(compared["files"][0]["max_abs"], 0.0);
  EXPECT_EQ(compared["files"][3]["rms"], fettleJson({"compare", scans_[0], scans_[3]})["rms"]);
  expectRefused(fettle(command({"compare", scans_[0]}, {"--deviation", folder_.file("d.tif")})),
                "a deviation is written of two scans");
  expectRefused(fettle(command({"compare", scans_[0]}, {"--shard", "1/2"})), "--shard-dir");
}

TEST_F(ShardsOfAList, AreGatheredAsTheTextOfOneRun) {
  const std::string out = folder_.file("suggested"), worn = folder_.file("worn"), m = folder_.file("m");
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const std::vector<std::string> compare = command({"compare", scans_[0]}, {"--align", "level"});
  const std::vector<std::string> measure = command({"measure"}, {"--only", "height", "--noise-trials", "0"});
  const std::vector<std::string> suggest =
      command({"filter"}, {"--out-dir", out, "--suggest", "--tolerance", "20um"});
  for (const char* k : {"1", "2"}) {
    const std::string shard = k + std::string("/2");
    (void)fettleJson(with(compare, {"--shard", shard, "--shard-dir", worn}));
    // A table of each shard's own makes no other command of it.
    (void)fettleJson(
        with(measure, {"--shard", shard, "--shard-dir", m, "--csv", folder_.file(std::string(k) + ".csv")}));
    (void)fettleJson(with(suggest, {"--shard", shard}));
  }
  EXPECT_EQ(fettle({"gather", worn}).out, fettle(compare).out);
  EXPECT_EQ(fettle({"gather", m}).out, fettle(measure).out);
  // Its seconds are measured.
  const Outcome suggested = fettle({"gather", out});
  EXPECT_EQ(suggested.status, 0) << suggested.err;
  for (const std::string& scan : scans_)
    EXPECT_NE(suggested.out.find("fettle filter " + scan + " --out-dir " + out), std::string::npos)
        << suggested.out;
  EXPECT_NE(suggested.out.find("5 done, 0 failed"), std::string::npos) << suggested.out;
}

TEST_F(ShardsOfAList, WhatRefusesEveryScanIsRefusedOnceAndNoShardIsDone) {
  const std::string worn = folder_.file("worn");
  for (const std::vector<std::string>& words :
       {command({"compare", folder_.file("none.tif")}, {"--shard", "1/2", "--shard-dir", worn}),
        command({"compare", scans_[0]}, {"--shard", "1/2", "--shard-dir", worn, "--edges", scans_[1]}),
        command({"compare", scans_[0]}, {"--shard", "1/2", "--shard-dir", worn, "--rotation", "5"}),
        command({"compare", scans_[0]}, {"--shard", "1/2", "--shard-dir", worn, "--tolerance", "5um"})}) {
    expectRefused(fettle(words), "");
    EXPECT_FALSE(std::filesystem::exists(worn));
  }
}

TEST_F(ShardsOfAList, OfSuggestingWriteNothingAndAskForNoRoom) {
  // A folder is in the place of an output, which is only named.
  const std::string out = folder_.file("out");
  std::filesystem::create_directory(out);
  std::filesystem::create_directory(out + "/s1.tif");
  const auto suggested =
      fettleJson({"filter", scans_[0], scans_[1], "--out-dir", out, "--suggest", "--tolerance", "20um"});
  EXPECT_EQ(suggested["done"], 2);
}

TEST_F(ShardsOfAList, ANominalShapeIsTheLastOfThoseCompared) {
  const std::string mesh = folder_.file("nominal.stl");
  (void)fettleJson({"convert", scans_[0], mesh});
  const auto all = fettleJson({"compare", scans_[0], scans_[1], scans_[2], mesh});
  ASSERT_EQ(all["files"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all["files"][i]["in"], scans_[i]);
    EXPECT_EQ(all["files"][i]["rms"], fettleJson({"compare", scans_[i], mesh})["rms"]);
  }
}

TEST_F(ShardsOfAList, OfTwoCommandsAreNotPutTogether) {
  const std::string out = folder_.file("out");
  const auto shard = [&](const char* filter, const char* k, const ProcessOptions& options = {}) {
    return fettle(command({"filter"},
                          {"--out-dir", out, "--filter", filter, "--shard", k, "--force", "--threads", "1"}),
                  options);
  };
  ASSERT_EQ(shard("tv", "1/2").status, 0);
  ASSERT_EQ(shard("box", "2/2").status, 0);
  expectFailed(fettle({"gather", out}), "shard 2 was done by another command");
  ASSERT_EQ(shard("box", "1/2").status, 0);
  EXPECT_EQ(fettleJson({"gather", out})["done"], 5);
  // A shard that is begun again and does not end is not done, whatever it did before. Its scans are large enough to be cut off.
  for (const std::size_t i : {1U, 3U}) ASSERT_EQ(fettle({"synth", scans_[i], "--size", "800x800"}).status, 0);
  ProcessOptions kill_it;
  kill_it.while_running = [&](int pid) {
    if (std::filesystem::exists(out + "/shards/2-of-2.json")) return false;
    kill(pid, SIGKILL);
    return true;
  };
  EXPECT_NE(shard("tgv", "2/2", kill_it).status, 0);
  expectFailed(fettle({"gather", out}), "1 of 2 shards is not done: 2");
}

}  // namespace
}  // namespace fettle::tests
