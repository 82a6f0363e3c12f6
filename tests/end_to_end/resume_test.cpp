#include <algorithm>
#include <csignal>
#include <cstdlib>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/filter/catalogue.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

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

// Interrupts the program as soon as it catches the signal, which is before it reads anything.
ProcessOptions interruptedAtOnce() {
  ProcessOptions options;
  options.while_running = [](int pid) {
    std::ifstream status(fmt::format("/proc/{}/status", pid));
    for (std::string word; status >> word;) {
      if (word != "SigCgt:") continue;
      unsigned long long caught = 0;
      status >> std::hex >> caught;
      if ((caught >> (SIGINT - 1) & 1U) == 0) return false;
      kill(pid, SIGINT);
      return true;
    }
    return false;
  };
  return options;
}

// A run without end where it is not cut: each filter so often that it takes some tenths of a second.
int passesFor(const engine::Filter& filter) {
  return filter.grid > 1 || !filter.sampled ? 1 : filter.keeps_edges ? 8 : 40;
}

class KilledAgainAndAgain : public testing::TestWithParam<engine::Filter> {};

TEST_P(KilledAgainAndAgain, AFilterComesToTheBytesOfOneRun) {
  const char* asked = std::getenv("FETTLE_KILLS");
  const int kills_wanted = asked != nullptr ? std::atoi(asked) : 4;
  const engine::Filter& filter = GetParam();
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "500x460"}).status, 0);
  std::vector<std::string> whole{"filter",
                                 in,
                                 folder.file("whole.tif"),
                                 "--filter",
                                 std::string(filter.word),
                                 "--passes",
                                 std::to_string(passesFor(filter))};
  if (filter.nesting.exists()) whole.insert(whole.end(), {fmt::format("--{}", filter.nesting_word), "4"});
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
  EXPECT_FALSE(fs::exists(out + ".resume.rounds"));
  EXPECT_FALSE(fs::exists(out + ".resume.rounds.new"));
}

// A filter that goes over the whole field in rounds has no block to keep until the last one is done.
TEST(ResumedRounds, ARobustFilterGoesOnAfterTheRoundThatWasKept) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "500x460"}).status, 0);
  for (const std::string filter : {"robust-gaussian", "robust-spline"}) {
    std::vector<std::string> command{
        "filter", in, folder.file("whole.tif"), "--filter", filter, "--cutoff", "4", "--force"};
    ASSERT_EQ(fettle(command).status, 0);
    command[2] = out;
    command.insert(command.end(), {"--resume", "--resume-every", "0"});
    const Outcome cut = fettle(command, endedWith(out + ".resume.rounds", 1, SIGKILL));
    ASSERT_EQ(cut.status, 128 + SIGKILL) << cut.err;
    // Also where nothing but rounds was kept.
    const Outcome without = fettle({"filter", in, out, "--filter", "box"});
    EXPECT_NE(without.err.find("give --resume to continue it"), std::string::npos) << without.err;
    ASSERT_TRUE(fs::remove(out));
    const auto report = fettleJson(command);
    EXPECT_GT(report["resumed_rounds"], 0) << filter;
    EXPECT_EQ(bytesOf(out), bytesOf(folder.file("whole.tif"))) << filter;
    // Damaged rounds are worked out again, rounds of other work are not taken.
    std::ofstream(out + ".resume.rounds") << "FTLROUND and no more";
    EXPECT_FALSE(fettleJson(command).contains("resumed_rounds")) << filter;
    EXPECT_EQ(bytesOf(out), bytesOf(folder.file("whole.tif"))) << filter;
    EXPECT_FALSE(fs::exists(out + ".resume.rounds"));
  }
}

INSTANTIATE_TEST_SUITE_P(Resume, KilledAgainAndAgain,
                         testing::ValuesIn(engine::filters().begin(), engine::filters().end()),
                         [](const auto& each) {
                           std::string name(each.param.word);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

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

// Before the kept work is read again: the scan, its noise and the line before long work come first.
TEST_F(Resume, CtrlCBeforeTheKeptWorkIsReadStillNamesIt) {
  const std::string recipe = folder.file("clean.toml"),
                    named = "cancelled, the same command continues with what is kept in ";
  std::ofstream(recipe)
      << "recipe = 1\n[[step]]\ndo = \"invert\"\n[[step]]\ndo = \"filter\"\nfilter = \"tgv\"\n";
  const std::vector<std::string> applied{"apply", recipe, in, out, "--resume", "--resume-every", "0"};
  const std::string step = out + ".step2.resume";
  for (const auto& [again, kept] : {std::pair(command({}), work), std::pair(applied, step)}) {
    expectFailed(fettle(again, endedWith(kept, 600'000, SIGINT)), named + kept);
    expectFailed(fettle(again, interruptedAtOnce()), named + kept);
  }
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

// A batch that is cut in its second scan: the first one is not done again, and its bytes and report are those of before.
TEST_F(Resume, ABatchDoesOnlyWhatIsMissingAndSaysSo) {
  const std::string other = folder.file("t.tif"), bad = folder.file("bad.tif"), to = folder.file("cleaned");
  ASSERT_EQ(fettle({"synth", other, "--size", "700x600", "--seed", "5"}).status, 0);
  const std::vector<std::string> batch{"filter",   in,    other,      "--out-dir",      to,
                                       "--filter", "tgv", "--resume", "--resume-every", "0"};
  ASSERT_NE(fettle(batch, endedWith(to + "/t.tif.resume", 300'000, SIGKILL)).status, 0);
  ASSERT_TRUE(fs::exists(to + "/s.tif.finished"));
  const auto written = fs::last_write_time(to + "/s.tif");
  std::vector<std::string> json = batch;
  json.emplace_back("--json");
  // A scan that cannot be read keeps the notes of the others.
  std::ofstream(bad) << "no scan";
  std::vector<std::string> with_bad = batch;
  with_bad.insert(with_bad.begin() + 3, bad);
  const Outcome failed = fettle(with_bad);
  EXPECT_EQ(failed.status, 1);
  EXPECT_NE(failed.err.find("s.tif: finished by an earlier run, kept"), std::string::npos) << failed.err;
  EXPECT_NE(failed.err.find("only the scans that failed"), std::string::npos) << failed.err;
  EXPECT_NE(failed.out.find("kept, finished before"), std::string::npos) << failed.out;
  EXPECT_EQ(fs::last_write_time(to + "/s.tif"), written);
  // What was changed since is not taken for finished.
  std::ofstream(to + "/t.tif", std::ios::app) << "more";
  const auto report = fettleJson(json);
  EXPECT_TRUE(report["files"][0]["finished_before"].get<bool>());
  EXPECT_FALSE(report["files"][1].contains("finished_before"));
  for (const char* name : {"s.tif", "t.tif"}) {
    const auto once = fettleJson({"filter", folder.file(name), folder.file("once.tif"), "--filter", "tgv"});
    EXPECT_EQ(bytesOf(to + "/" + name), bytesOf(folder.file("once.tif"))) << name;
    EXPECT_EQ(report["files"][name[0] == 's' ? 0 : 1]["hash"], once["hash"]);
    EXPECT_FALSE(fs::exists(to + "/" + name + ".finished"));
    EXPECT_FALSE(fs::exists(to + "/" + name + ".resume"));
  }
}

TEST_F(Resume, OtherNumbersAreWorkedOutThoughAnOutputIsFinished) {
  const std::string to = folder.file("cleaned"), bad = folder.file("bad.tif");
  std::ofstream(bad) << "no scan";
  const auto with = [&](const char* window) {
    return std::vector<std::string>{"filter",   in,       bad,        "--out-dir", to,
                                    "--filter", "median", "--resume", "--window",  window};
  };
  EXPECT_EQ(fettle(with("3")).status, 1);
  EXPECT_NE(fettle(with("3")).out.find("finished before"), std::string::npos);
  EXPECT_EQ(fettle(with("5")).out.find("finished before"), std::string::npos);
  ASSERT_EQ(fettle({"filter", in, folder.file("once.tif"), "--filter", "median", "--window", "5"}).status, 0);
  EXPECT_EQ(bytesOf(to + "/s.tif"), bytesOf(folder.file("once.tif")));
}

// A recipe that is cut in its last filter reads the finished filter back and goes on in the one that was cut.
TEST_F(Resume, ARecipeGoesOnInTheStepThatWasCut) {
  const std::string recipe = folder.file("clean.toml"), work2 = out + ".step3.resume";
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"planes\"\n"
                           "[[step]]\ndo = \"mark_edges\"\n"
                           "[[step]]\ndo = \"filter\"\nfilter = \"tgv\"\nmax_change = \"40um\"\n";
  const std::vector<std::string> apply{"apply", recipe, in, out, "--resume", "--resume-every", "0"};
  const Outcome cut = fettle(apply, endedWith(work2, 600'000, SIGINT));
  expectFailed(cut, "the same command continues with what is kept in " + work2);
  const Outcome ignored = fettle({"apply", recipe, in, folder.file("else.tif")});
  EXPECT_EQ(ignored.status, 0);
  std::vector<std::string> again = apply;
  again.emplace_back("--json");
  const Outcome done = fettle(again);
  ASSERT_EQ(done.status, 0) << done.err;
  const auto report = nlohmann::json::parse(done.out);
  EXPECT_EQ(report["steps"][0]["resumed_share"], 1.0);
  EXPECT_GT(report["steps"][2]["resumed_share"].get<double>(), 0.1);
  EXPECT_EQ(bytesOf(out), bytesOf(folder.file("else.tif")));
  EXPECT_EQ(filesIn(folder), 4) << "scan, recipe and two results";
  expectRefused(fettle({"apply", recipe, in, "-", "--to", "tif", "--resume"}), "next to standard output");
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
