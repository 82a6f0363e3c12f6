#include <filesystem>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

int entriesOf(const TempFolder& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
}

// Memory and disk do not depend on what else the machine does; of time only the order is asked here.
TEST(Estimate, ForesawMemoryAndDiskWithinATenthAndTheOrderOfTheTime) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "2500x2500"}).status, 0);
  const auto before = fettleJson({"filter", in, out, "--filter", "planes", "--passes", "4", "--estimate"});
  EXPECT_EQ(entriesOf(folder), 1) << "an estimate leaves no file";
  const auto report = fettleJson({"filter", in, out, "--filter", "planes", "--passes", "4"});
  ASSERT_TRUE(report.contains("estimate"));
  for (const auto& estimate : {before, report["estimate"]}) {
    EXPECT_NEAR(estimate.at("memory_bytes").get<double>() / report.at("peak_memory_bytes").get<double>(), 1.0,
                0.1);
    EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / report.at("disk_bytes").get<double>(), 1.0, 0.1);
    EXPECT_EQ(report.at("disk_bytes"), fs::file_size(out));
    const double time = estimate.at("filter_seconds").get<double>() / report.at("seconds").get<double>();
    EXPECT_GT(time, 0.1);
    EXPECT_LT(time, 10.0);
  }
}

TEST(Estimate, KnowsFormatsThatPackAndKeptWork) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "1500x1500"}).status, 0);
  for (const std::string name : {"o.asc", "o.fettle", "o.ply"}) {
    const std::string out = folder.file(name);
    const auto estimate = fettleJson({"filter", in, out, "--filter", "planes", "--estimate", "--resume"});
    EXPECT_NEAR(estimate.at("kept_bytes").get<double>(), 4.0 * 1500 * 1500, 0.1 * 4.0 * 1500 * 1500);
    ASSERT_EQ(fettle({"filter", in, out, "--filter", "planes"}).status, 0);
    EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out)), 1.0, 0.1)
        << name;
  }
}

TEST(Estimate, ShortWorkBeginsWithoutAWord) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "300x300"}).status, 0);
  const Outcome outcome = fettle({"filter", in, folder.file("o.tif"), "--filter", "median"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_FALSE(fettleJson({"filter", in, folder.file("o.tif"), "--filter", "median"}).contains("estimate"));
}

}  // namespace
}  // namespace fettle::tests
