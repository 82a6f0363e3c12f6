// The program with devices behind their makers' libraries: `fettle devices`, a session, and what the device applies when it is attacked.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/live/session.h"
#include "tests/haptic/devices/fake_vendor/shared_page.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;

struct Maker {
  const char* word;
  const char* file;
  const char* library;
  double max_force_n;
};
void PrintTo(const Maker& maker, std::ostream* out) {
  *out << maker.word;
}
constexpr Maker kTouch{"touch", "libHD.so", FETTLE_FAKE_HD, 3.3};
constexpr Maker kOmega{"forcedimension", "libdhd.so", FETTLE_FAKE_DHD, 12.0};

class LibraryDevice : public testing::TestWithParam<Maker> {
 protected:
  void SetUp() override {
    // The program looks for it there.
    std::filesystem::create_symlink(GetParam().library, folder_.file(GetParam().file));
    setenv("FAKE_VENDOR_PAGE", folder_.file("page").c_str(), 1);
    setenv("FAKE_VENDOR_LOG", folder_.file("broken").c_str(), 1);
    page_ = fake::SharedPage::map(folder_.file("page").c_str());
    ASSERT_NE(page_, nullptr);
  }
  void start() {
    const std::string scan = folder_.file("flat.tif");
    ASSERT_NO_FATAL_FAILURE(writePlate(scan));
    program_ = std::make_unique<LiveProgram>(
        std::vector<std::string>{"record", scan, folder_.file("s.csv"), folder_.file("o.tif"), "--device",
                                 GetParam().word, "--keys", "--json"},
        folder_.path().string());
  }
  void armUntil(const char* state) {
    ASSERT_TRUE(eventually([&] {
      program_->press('a');
      return program_->says(state, 2s);
    })) << program_->err();
  }
  // The program armed, and the hand pressing into the surface.
  void press() {
    ASSERT_NO_FATAL_FAILURE(start());
    ASSERT_NO_FATAL_FAILURE(armUntil(" s: active"));
    pressDown();
    ASSERT_TRUE(eventually([&] { return now() > 0.2; })) << program_->err();
  }
  // The next forces, about a millisecond apart.
  [[nodiscard]] double strongestOfTheNext(std::size_t count) {
    const std::size_t first = page_->forces;
    EXPECT_TRUE(eventually([&] { return page_->forces >= first + count; }));
    double most = 0.0;
    for (std::size_t i = first; i < page_->forces; ++i)
      most = std::max(most, static_cast<double>(page_->force_n[i].load()));
    return most;
  }
  void pressDown() {
    for (double up = page_->up_mm; up > -2.0; up -= 0.1) {
      page_->up_mm = up;
      std::this_thread::sleep_for(2ms);  // the speed of the hand
    }
  }
  [[nodiscard]] double now() const {
    const std::size_t n = page_->forces;
    return n == 0 ? 0.0 : static_cast<double>(page_->force_n[n - 1].load());
  }
  // Prints the row of docs/safety.md; the guard's limits hold at the device.
  void expectWithinLimits(const char* attack) {
    double peak = 0.0, rise = 0.0, before = 0.0;
    for (std::size_t i = 0; i < page_->forces; ++i) {
      const double f = static_cast<double>(page_->force_n[i].load());
      peak = std::max(peak, f);
      rise = std::max(rise, f - before);
      before = f;
    }
    std::printf("| %-45s | %-14s | %6.3f | %7.4f | %6.3f |\n", attack, GetParam().word, peak, rise, now());
    std::fflush(stdout);
    EXPECT_LE(peak, GetParam().max_force_n * 1.001);
    EXPECT_GT(peak, 0.2);
    // One tick of rise; where the machine held the loop up, as many ticks at once as the guard allows.
    EXPECT_LE(rise, 2.0);
    EXPECT_EQ(now(), 0.0);
  }
  [[nodiscard]] std::string broken() const {
    std::ifstream file(folder_.file("broken"));
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TempFolder folder_;
  fake::SharedPage* page_ = nullptr;
  std::unique_ptr<LiveProgram> program_;
};
INSTANTIATE_TEST_SUITE_P(Makers, LibraryDevice, testing::Values(kTouch, kOmega),
                         [](const auto& i) { return std::string(i.param.word); });

TEST_P(LibraryDevice, IsListedWithItsLimitsWhileItIsThere) {
  const auto listed = [&] {
    LiveProgram program({"devices", "--json"}, folder_.path().string());
    EXPECT_EQ(program.wait(), 0) << program.err();
    return program.report();
  };
  const auto rowIn = [](const nlohmann::json& report) {
    for (const auto& row : report["devices"])
      if (row["id"].get<std::string>().starts_with(GetParam().word)) return row;
    return nlohmann::json();
  };
  const nlohmann::json row = rowIn(listed());
  EXPECT_EQ(row["state"], "ready");
  EXPECT_EQ(row["max_force_n"], GetParam().max_force_n);
  page_->plugged = false;
  const nlohmann::json gone = rowIn(listed());
  EXPECT_TRUE(gone.is_null() || gone["state"] != "ready") << gone;
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, ArmedInsideTheSurfaceThenTakenOutAndPressed) {
  page_->up_mm = -2.0;
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_NO_FATAL_FAILURE(armUntil(" s: armed"));
  EXPECT_EQ(strongestOfTheNext(300), 0.0);
  page_->up_mm = 30.0;
  EXPECT_TRUE(program_->says(" s: active")) << program_->err();
  pressDown();
  EXPECT_TRUE(eventually([&] { return now() > 0.2; }));
  program_->press('q');
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectWithinLimits("armed 2 mm inside, taken out, pressed");
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, DisarmedWhilePressingAndArmedThere) {
  ASSERT_NO_FATAL_FAILURE(press());
  program_->press('d');
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  ASSERT_NO_FATAL_FAILURE(armUntil(" s: armed"));
  EXPECT_EQ(strongestOfTheNext(300), 0.0);
  program_->press('q');
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectWithinLimits("disarmed while pressing, armed there");
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, UnpluggedWhilePressingAndBack) {
  ASSERT_NO_FATAL_FAILURE(press());
  page_->plugged = false;
  EXPECT_TRUE(program_->says("fault, unplugged")) << program_->err();
  page_->up_mm = 30.0;
  page_->plugged = true;
  EXPECT_TRUE(program_->says("device connected")) << program_->err();
  program_->press('q');
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectWithinLimits("unplugged while pressing, back");
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, GarbageWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  page_->garbage = true;
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  page_->garbage = false;
  program_->press('q');
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectWithinLimits("poses NaN and 1e30");
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, StandsWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  page_->stalled = true;
  EXPECT_TRUE(program_->says("fault")) << program_->err();
  page_->stalled = false;
  EXPECT_TRUE(eventually([&] { return now() == 0.0; }));
  program_->press('q');
  EXPECT_EQ(program_->wait(), 0) << program_->err();
  expectWithinLimits("library's thread or call stands");
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, CtrlCWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  program_->signal(SIGINT);
  program_->wait();
  expectWithinLimits("Ctrl-C while pressing");
  EXPECT_EQ(broken(), "");
}

TEST_P(LibraryDevice, CrashWhilePressing) {
  ASSERT_NO_FATAL_FAILURE(press());
  program_->signal(SIGSEGV);
  program_->wait();
  expectWithinLimits("SIGSEGV while pressing");
}

}  // namespace
}  // namespace fettle::tests
