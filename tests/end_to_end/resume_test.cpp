#include <csignal>
#include <cstdlib>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/filter/catalogue.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int filesIn(const TempFolder& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
}

// Ends the program with a signal after this time, if it still runs.
ProcessOptions endedAfter(std::chrono::duration<double> delay, int signal) {
  ProcessOptions options;
  options.while_running = [delay, signal, begun = std::chrono::steady_clock::now()](int pid) {
    if (std::chrono::steady_clock::now() - begun < delay) return false;
    kill(pid, signal);
    return true;
  };
  return options;
}

// Ends the program with a signal as soon as so many bytes of work are kept.
ProcessOptions endedWith(const std::string& work, std::size_t bytes, int signal) {
  ProcessOptions options;
  options.while_running = [work, bytes, signal](int pid) {
    std::error_code none;
    const auto size = fs::file_size(work, none);
    if (none || size < bytes) return false;
    kill(pid, signal);
    return true;
  };
  return options;
}

// A run without end where it is not cut: each filter so often that it takes some tenths of a second.
int passesFor(const engine::Filter& filter) {
  return filter.grid > 1 ? 1 : filter.keeps_edges ? 8 : 40;
}

class KilledAgainAndAgain : public testing::TestWithParam<engine::Filter> {};

TEST_P(KilledAgainAndAgain, AFilterComesToTheBytesOfOneRun) {
  const char* asked = std::getenv("FETTLE_KILLS");
  const int kills_wanted = asked != nullptr ? std::atoi(asked) : 4;
  const engine::Filter& filter = GetParam();
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "500x460"}).status, 0);
  const std::vector<std::string> whole{"filter",
                                       in,
                                       folder.file("whole.tif"),
                                       "--filter",
                                       std::string(filter.word),
                                       "--passes",
                                       std::to_string(passesFor(filter))};
  const Outcome once = fettle(whole);
  ASSERT_EQ(once.status, 0) << once.err;
  const std::string wanted = bytesOf(whole[2]);
  std::mt19937 random(11);
  int kills = 0;
  for (int round = 0; round < 200 && kills < kills_wanted; ++round) {
    std::vector<std::string> command = whole;
    command[2] = out;
    const std::string threads = std::to_string(1 + round % 3);
    command.insert(command.end(), {"--resume", "--resume-every", "0", "--threads", threads});
    const double share = static_cast<double>(random() % 1000) / 1000.0;
    const Outcome outcome = fettle(command, endedAfter(share * once.seconds, SIGKILL));
    if (outcome.status == 0) {
      ASSERT_EQ(bytesOf(out), wanted) << "after " << kills << " kills";
      ASSERT_FALSE(fs::exists(out + ".resume"));
      fs::remove(out);
    } else {
      ASSERT_EQ(outcome.status, 128 + SIGKILL) << outcome.err;
      ++kills;
    }
  }
  EXPECT_EQ(kills, kills_wanted);
  std::vector<std::string> last = whole;
  last[2] = out;
  last.emplace_back("--resume");
  ASSERT_EQ(fettle(last).status, 0);
  EXPECT_EQ(bytesOf(out), wanted);
  EXPECT_FALSE(fs::exists(out + ".resume"));
  EXPECT_FALSE(fs::exists(out + ".resume.new"));
}

INSTANTIATE_TEST_SUITE_P(Resume, KilledAgainAndAgain,
                         testing::ValuesIn(engine::filters().begin(), engine::filters().end()),
                         [](const auto& each) { return std::string(each.param.word); });

class Resume : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(fettle({"synth", in, "--size", "700x600"}).status, 0); }
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"filter", in, out, "--filter", "tgv", "--resume", "--resume-every", "0"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  TempFolder folder;
  std::string in = folder.file("s.tif"), out = folder.file("o.tif"), work = out + ".resume";
};

TEST_F(Resume, CtrlCKeepsTheWorkSaysSoAndTheSameCommandContinues) {
  const Outcome cut = fettle(command({}), endedWith(work, 600'000, SIGINT));
  expectFailed(cut, "cancelled, the same command continues with what is kept in " + work);
  EXPECT_FALSE(fs::exists(out));
  std::vector<std::string> again = command({"--json"});
  const Outcome done = fettle(again);
  ASSERT_EQ(done.status, 0) << done.err;
  const auto report = nlohmann::json::parse(done.out);
  EXPECT_GT(report.at("resumed_share").get<double>(), 0.1);
  const auto once = fettleJson({"filter", in, folder.file("once.tif"), "--filter", "tgv"});
  for (const char* key : {"hash", "changed", "max_change", "rms_change"})
    EXPECT_EQ(report.at(key), once.at(key)) << key;
  EXPECT_EQ(filesIn(folder), 3);
}

TEST_F(Resume, AFullDiskIsAWarningAndThenTheErrorOfTheOutputAndNothingIsLost) {
  ProcessOptions full;
  full.file_limit = 1'200'000;  // the output has 1.7 MB
  const Outcome outcome = fettle(command({}), full);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("finished work is not kept until this is mended"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("the same command then continues"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(out));
  ASSERT_TRUE(fs::exists(work));
  EXPECT_LE(fs::file_size(work), *full.file_limit);
  const Outcome done = fettle(command({}));
  ASSERT_EQ(done.status, 0) << done.err;
  ASSERT_EQ(fettle({"filter", in, folder.file("once.tif"), "--filter", "tgv"}).status, 0);
  EXPECT_EQ(bytesOf(out), bytesOf(folder.file("once.tif")));
  EXPECT_FALSE(fs::exists(work));
}

TEST_F(Resume, DamagedWorkIsAWarningAndForeignWorkAnError) {
  ASSERT_NE(fettle(command({}), endedWith(work, 900'000, SIGKILL)).status, 0);
  expectRefused(fettle(command({"--range-sigma", "1um"})), "of another filter or other numbers of it");
  const std::string bytes = bytesOf(work);
  std::ofstream(work, std::ios::binary) << bytes.substr(0, bytes.size() - 5);
  const Outcome done = fettle(command({}));
  EXPECT_EQ(done.status, 0);
  EXPECT_NE(done.err.find("worked out again"), std::string::npos) << done.err;
  ASSERT_EQ(fettle({"filter", in, folder.file("once.tif"), "--filter", "tgv"}).status, 0);
  EXPECT_EQ(bytesOf(out), bytesOf(folder.file("once.tif")));
}

TEST_F(Resume, AFieldInAStoreAndABatchContinueToo) {
  const std::string folder_out = folder.file("cleaned");
  const std::vector<std::string> batch{
      "filter", in,        "--out-dir",           folder_out, "--filter", "tgv", "--resume", "--resume-every",
      "0",      "--store", folder.path().string()};
  const std::string batch_work = folder_out + "/s.tif.resume";
  ASSERT_NE(fettle(batch, endedWith(batch_work, 600'000, SIGKILL)).status, 0);
  ASSERT_TRUE(fs::exists(batch_work));
  ASSERT_EQ(fettle(batch).status, 0);
  ASSERT_EQ(fettle({"filter", in, folder.file("once.tif"), "--filter", "tgv"}).status, 0);
  EXPECT_EQ(bytesOf(folder_out + "/s.tif"), bytesOf(folder.file("once.tif")));
  EXPECT_FALSE(fs::exists(batch_work));
}

TEST_F(Resume, WhereNothingCanBeKeptItIsRefusedAtOnce) {
  expectRefused(fettle({"filter", in, "-", "--to", "xyz", "--filter", "box", "--resume"}),
                "next to standard output");
  expectRefused(fettle({"filter", in, out, "--filter", "box", "--resume-every", "5"}), "add --resume");
  expectRefused(fettle({"filter", in, "--suggest", "--tolerance", "1um", "--resume"}), "--resume");
  std::ofstream(work) << "notes";
  expectRefused(fettle(command({})), "no kept work");
  EXPECT_EQ(bytesOf(work), "notes");
  const Outcome without = fettle({"filter", in, out, "--filter", "box"});
  EXPECT_EQ(without.status, 0);
  EXPECT_NE(without.err.find("give --resume to continue it"), std::string::npos);
}

}  // namespace
}  // namespace fettle::tests
