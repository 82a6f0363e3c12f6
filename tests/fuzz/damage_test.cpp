// Damaged files of every format under a plain generator, and the files that once broke an importer. What
// holds for each import is in importBytes.

#include <chrono>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/fuzz/import_fuzz.h"
#include "tests/fuzz/seeds.h"
#include "tests/support/source_tree.h"

namespace fettle::tests {
namespace {

void importText(const std::string& extension, const std::string& bytes) {
  importBytes(extension, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(Damage, EveryFormatThatIsReadHasASeed) {
  const auto seeds = fuzzSeeds();
  const std::string fuzzed = engine::readBytes(inSourceTree("tests/fuzz/extensions.txt"));
  for (const engine::FormatInfo& format : engine::formats()) {
    if (!format.reads || format.name == "Fettle") continue;
    EXPECT_NE(("\n" + fuzzed).find("\n" + std::string(format.extensions.front().substr(1)) + "\n"),
              std::string::npos)
        << format.name << " is missing from tests/fuzz/extensions.txt";
    bool found = false;
    for (const auto& [extension, bytes] : seeds) found = found || extension == format.extensions.front();
    EXPECT_TRUE(found) << format.name;
  }
}

TEST(Damage, SeedsAreSound) {
  const std::string path = ::testing::TempDir() + "fettle_seed";
  for (const auto& [extension, bytes] : fuzzSeeds()) {
    engine::writeBytes(path + extension, bytes);
    const auto scan = engine::load(path + extension);
    EXPECT_TRUE(scan) << extension << " " << (scan ? "" : scan.error().line());
    std::remove((path + extension).c_str());
  }
}

TEST(Damage, IsRefusedOrHarmlessAndNeverSlow) {
  constexpr std::uint32_t kSeed = 20;
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  double slowest = 0.0;
  std::string slowest_format;
  for (const auto& [extension, whole] : fuzzSeeds())
    for (int round = 0; round < 120; ++round) {
      std::string bad = whole;
      const std::size_t within = round % 2 == 0 ? std::min<std::size_t>(bad.size(), 400) : bad.size();
      for (int k = 0; k <= round % 3; ++k) {
        const std::size_t at = random() % std::min(within, bad.size());
        // A byte, a number of all ones at the end of its range, or a piece cut out.
        if (round % 5 == 0)
          bad.replace(at, std::min<std::size_t>(4, bad.size() - at), "\xff\xff\xff\x7f");
        else if (round % 7 == 0)
          bad.erase(at, random() % 9);
        else
          bad[at] = static_cast<char>(random());
        if (bad.empty()) bad.assign(1, 'x');
      }
      const auto start = std::chrono::steady_clock::now();
      importText(extension, bad);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (seconds > slowest) {
        slowest = seconds;
        slowest_format = extension;
      }
    }
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
#ifndef __SANITIZE_ADDRESS__  // which is slow, and keeps what was freed
  EXPECT_LT(slowest, 1.0) << slowest_format;
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 256 * 1024);
#endif
}

TEST(Damage, FilesThatOnceBrokeAnImporterNoLongerDo) {
  const std::filesystem::path folder = tests::inSourceTree("tests/fuzz/regressions");
  for (const auto& file : std::filesystem::directory_iterator(folder))
    importText(file.path().extension().string(), engine::readBytes(file.path().string()));
}

}  // namespace
}  // namespace fettle::tests
