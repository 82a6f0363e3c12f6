#include "engine/resume/kept_work.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/pass.h"
#include "tests/engine/resume/scan.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::bytesOf;
using tests::TempFolder;

constexpr std::int32_t kWidth = 330, kHeight = 290;

// Everything that a user sees of a result.
struct Seen {
  std::uint64_t hash;
  std::int64_t changed;
  double max_change, rms_change;
  friend bool operator==(const Seen&, const Seen&) = default;
};

Seen seen(const Filtered& filtered) {
  return {contentHash(filtered.field), filtered.report.changed, filtered.report.max_change,
          filtered.report.rms_change};
}

Seen uninterrupted(const Version& scan, const FilterSpec& spec) {
  JobControl job;
  return seen(applyFilter(scan, scan, spec, job).value());
}

KeepOptions at(const std::string& path, double every = 0.0) {
  KeepOptions options;
  options.path = path;
  options.every_seconds = every;
  return options;
}

Result<std::unique_ptr<KeptWork>> openFor(const Version& scan, const FilterSpec& spec, KeepOptions options) {
  return KeptWork::open(std::move(options), identityOf(scan, scan, spec, ""), scan);
}

Result<Filtered> run(const Version& scan, const FilterSpec& spec, FilterWork& work, JobControl& job) {
  FilterTuning tuning;
  tuning.work = &work;
  tuning.block_side = 64;
  return applyFilter(scan, scan, spec, tuning, job);
}

// Passes everything on, and cancels the job after so many blocks.
class CutAfter : public FilterWork {
 public:
  CutAfter(FilterWork& work, JobControl& job, int blocks) : work_(work), job_(job), left_(blocks) {}
  Result<State> begin(const Version& input) override { return work_.begin(input); }
  Status beginPass(const State& before) override { return work_.beginPass(before); }
  bool isDone(const TileRect& block) override { return work_.isDone(block); }
  void done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) override {
    work_.done(block, made, first);
    if (left_.fetch_sub(1) == 1) job_.cancel();
  }
  void addMade(std::vector<NewTile>& made) override { work_.addMade(made); }
  std::optional<Rounds> roundsBefore() override { return work_.roundsBefore(); }
  bool wantsRounds() override { return work_.wantsRounds(); }
  void roundDone(const Rounds& rounds) override { work_.roundDone(rounds); }

 private:
  FilterWork& work_;
  JobControl& job_;
  std::atomic<int> left_;
};

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// As CutAfter, and each block is a part of the file of its own.
class KeepEach final : public CutAfter {
 public:
  KeepEach(KeptWork& work, JobControl& job, int blocks) : CutAfter(work, job, blocks), kept_(work) {}
  void done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) override {
    CutAfter::done(block, made, first);
    EXPECT_TRUE(kept_.keep());
  }

 private:
  KeptWork& kept_;
};

// Leaves the kept work of a filter that was cut after so many blocks.
void leaveWork(const Version& scan, const FilterSpec& spec, const std::string& path, int blocks) {
  JobControl job;
  auto kept = openFor(scan, spec, at(path));
  ASSERT_TRUE(kept) << kept.error().line();
  KeepEach cut(**kept, job, blocks);
  ASSERT_FALSE(run(scan, spec, cut, job));
}

class CutAnywhere : public testing::TestWithParam<Filter> {};

TEST_P(CutAnywhere, WithAnyThreadsComesToTheBitsOfOneRun) {
  const Filter& filter = GetParam();
  std::mt19937 random(7);
  // Nine squares of those that work in squares, thirty blocks of the others.
  const bool squares = filter.grid > 1;
  const Version scan = squares ? scanWithEverything(530, 520) : scanWithEverything(kWidth, kHeight);
  const unsigned most = squares ? 3 : 12;
  for (const int passes : {1, 3}) {
    const TempFolder folder;
    const std::string path = folder.file("work");
    const Seen wanted = uninterrupted(scan, specFor(filter.kind, passes, 2));
    int runs = 0;
    double share = 0.0;
    for (;; ++runs) {
      ASSERT_LT(runs, 100);
      const FilterSpec spec = specFor(filter.kind, passes, 1 + runs % 3);
      JobControl job;
      auto kept = openFor(scan, spec, at(path));
      ASSERT_TRUE(kept) << kept.error().line();
      EXPECT_EQ((*kept)->damagedBytes(), 0U);
      EXPECT_GE((*kept)->shareAtStart(passes), share);
      share = (*kept)->shareAtStart(passes);
      CutAfter cut(**kept, job, 1 + static_cast<int>(random() % most));
      const auto filtered = run(scan, spec, cut, job);
      if (!filtered) {
        ASSERT_EQ(filtered.error().kind, ErrorKind::kCancelled);
        continue;
      }
      EXPECT_EQ(seen(*filtered), wanted) << passes << " passes";
      (*kept)->finish();
      break;
    }
    EXPECT_GT(runs, 1);
    EXPECT_GT(share, 0.2);
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
}

INSTANTIATE_TEST_SUITE_P(KeptWork, CutAnywhere, testing::ValuesIn(filters().begin(), filters().end()),
                         [](const auto& each) {
                           std::string name(each.param.word);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(KeptWork, ALimitOfChangeOnlyMarksAndAnInvertedScanContinueToo) {
  const Version scan = scanWithEverything(kWidth, kHeight);
  FilterSpec limited = specFor(FilterKind::kMedian, 2, 2);
  limited.max_change = 0.05;
  FilterSpec only = specFor(FilterKind::kGaussian, 2, 2);
  only.scope = FilterScope::kOnlyMarks;
  const std::pair<Version, FilterSpec> cases[] = {
      {scan, limited}, {scan, only}, {scan.inverted(), specFor(FilterKind::kBilateral, 1, 2)}};
  for (const auto& [field, spec] : cases) {
    const TempFolder folder;
    leaveWork(field, spec, folder.file("work"), 5);
    JobControl job;
    const auto kept = openFor(field, spec, at(folder.file("work")));
    ASSERT_TRUE(kept);
    EXPECT_GT((*kept)->shareAtStart(spec.passes), 0.0);
    EXPECT_EQ(seen(run(field, spec, **kept, job).value()), uninterrupted(field, spec));
  }
}

TEST(KeptWork, WhatIsThereIsNotWorkedOutAgainAndProgressBeginsThere) {
  const Version scan = scanWithEverything(kWidth, kHeight);
  const FilterSpec spec = specFor(FilterKind::kTotalVariation, 1, 1);
  const TempFolder folder;
  leaveWork(scan, spec, folder.file("work"), 9);
  JobControl job;
  const auto kept = openFor(scan, spec, at(folder.file("work")));
  ASSERT_TRUE(kept);
  const auto all = static_cast<int>((kWidth + 63) / 64 * ((kHeight + 63) / 64));
  CutAfter count(**kept, job, all - 9);  // the block after the last would cancel
  EXPECT_FALSE(run(scan, spec, count, job));
  EXPECT_EQ(job.done(), job.total());
}

TEST(KeptWork, OfAnotherScanMarkLineFilterOrProcessorItIsRefusedAndLeftAsItIs) {
  const Version scan = scanWithEverything(kWidth, kHeight);
  const FilterSpec spec = specFor(FilterKind::kGeneralisedVariation, 1, 2);
  const TempFolder folder;
  const std::string path = folder.file("work");
  leaveWork(scan, spec, path, 1);
  const std::string before = bytesOf(path);

  std::map<std::string, WorkIdentity> others;
  others["another scan"] = identityOf(scanWithEverything(kWidth, kHeight, 2), scan, spec, "");
  LiveField marked(scan, Growth::kAllowed);
  ASSERT_TRUE(marked.setMark(100, 100, true));
  others["other marks"] = identityOf(marked.snapshot(), scan, spec, "");
  auto lines = std::make_shared<std::vector<EdgeLine>>(1);
  lines->front().points.resize(2);
  others["other edge lines"] = identityOf(scan.withLines(lines), scan, spec, "");
  FilterSpec numbers = spec;
  numbers.range_sigma *= 1.0 + 0x1p-52;
  others["other numbers"] = identityOf(scan, scan, numbers, "");
  others["another processor"] = identityOf(scan, scan, spec, "a device");
  WorkIdentity revised = identityOf(scan, scan, spec, "");
  ASSERT_EQ(revised.parts.front().first, "revision");
  revised.parts.front().second += "0";
  others["another version"] = revised;
  FilterSpec limited = spec;
  limited.max_change = 1.0;
  others["another original"] = identityOf(scan, scan, limited, "");
  for (const auto& [what, identity] : others) {
    const auto kept = KeptWork::open(at(path), identity, scan);
    ASSERT_FALSE(kept) << what;
    EXPECT_EQ(kept.error().kind, ErrorKind::kInput);
    EXPECT_NE(kept.error().line().find("delete the file"), std::string::npos);
    EXPECT_EQ(bytesOf(path), before) << what;
  }
  // The number of threads makes no difference to a result.
  EXPECT_TRUE(openFor(scan, specFor(FilterKind::kGeneralisedVariation, 1, 5), at(path)));
}

TEST(KeptWork, DamageAnywhereIsSeenAndNeverChangesABit) {
  const Version scan = scanWithEverything(kWidth, kHeight);
  int begun_anew = 0, cut = 0;
  // A file of blocks alone, and one that begins with a whole state, without which nothing counts.
  for (const int passes : {1, 2}) {
    const FilterSpec spec = specFor(FilterKind::kBox, passes, 2);
    const Seen wanted = uninterrupted(scan, spec);
    const TempFolder folder;
    const std::string path = folder.file("work");
    leaveWork(scan, spec, path, passes == 1 ? 25 : 40);  // of 30 blocks a pass
    const std::string whole = bytesOf(path);
    ASSERT_GT(whole.size(), 300'000U);
    std::mt19937 random(3);
    for (int i = 0; i < 60; ++i) {
      std::string bytes = whole;
      // Half of the places in the head, the small records and the first tiles.
      const std::size_t place = i % 2 == 0 ? random() % bytes.size() : random() % 400;
      if (i % 3 == 0)
        bytes.resize(place);
      else if (i % 3 == 1)
        bytes[place] = static_cast<char>(bytes[place] ^ (1 << random() % 8));
      else
        bytes.replace(place, 16, 16, '\xff');
      write(path, bytes);
      const auto kept = openFor(scan, spec, at(path));
      // What no longer begins as kept work is somebody else's file; an identity with a flipped bit is not read.
      if (!kept) {
        EXPECT_LT(place, 8U) << kept.error().line();
        EXPECT_EQ(bytesOf(path), bytes);
        continue;
      }
      const double share = (*kept)->shareAtStart(spec.passes);
      EXPECT_TRUE((*kept)->damagedBytes() > 0 || bytes.size() < whole.size());
      begun_anew += share == 0.0 ? 1 : 0;
      cut += share > 0.0 ? 1 : 0;
      JobControl job;
      EXPECT_EQ(seen(run(scan, spec, **kept, job).value()), wanted) << i;
    }
  }
  EXPECT_GT(begun_anew, 10);
  EXPECT_GT(cut, 5);
}

TEST(KeptWork, AFileOfSomethingElseIsRefusedAndLeft) {
  const Version scan = scanWithEverything(64, 64);
  const FilterSpec spec = specFor(FilterKind::kBox, 1, 1);
  const TempFolder folder;
  write(folder.file("work"), "a scan of somebody");
  const auto other = openFor(scan, spec, at(folder.file("work")));
  ASSERT_FALSE(other);
  EXPECT_EQ(bytesOf(folder.file("work")), "a scan of somebody");
  fs::create_directory(folder.file("folder"));
  EXPECT_FALSE(openFor(scan, spec, at(folder.file("folder"))));
  EXPECT_FALSE(openFor(scan, spec, at(folder.file("no such folder") + "/work")));
}

TEST(KeptWork, TwoProcessesDoNotShareIt) {
  const Version scan = scanWithEverything(64, 64);
  const FilterSpec spec = specFor(FilterKind::kBox, 1, 1);
  const TempFolder folder;
  const auto first = openFor(scan, spec, at(folder.file("work")));
  ASSERT_TRUE(first);
  const auto second = openFor(scan, spec, at(folder.file("work")));
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().line().find("another process"), std::string::npos);
}

// By the clock alone: with an interval longer than the work nothing is written but the end, when the work is cut.
TEST(KeptWork, IsWrittenByTimeAndAtACut) {
  const Version scan = scanWithEverything(kWidth, kHeight);
  const FilterSpec spec = specFor(FilterKind::kBox, 1, 2);
  const TempFolder folder;
  const std::string path = folder.file("work");
  {
    const auto kept = openFor(scan, spec, at(path, 1000.0));
    ASSERT_TRUE(kept);
    const auto begun = fs::file_size(path);
    JobControl job;
    ASSERT_TRUE(run(scan, spec, **kept, job));
    EXPECT_EQ(fs::file_size(path), begun);
    EXPECT_EQ((*kept)->secondsWriting(), 0.0);
  }
  const auto kept = openFor(scan, spec, at(path));
  ASSERT_TRUE(kept);
  EXPECT_EQ((*kept)->shareAtStart(1), 1.0);
}

}  // namespace
}  // namespace fettle::engine
