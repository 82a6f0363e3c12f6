// Many scans that several processes share.

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

}  // namespace
}  // namespace fettle::tests
