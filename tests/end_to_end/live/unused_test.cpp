// Nothing of what other makers' devices need is in the program while no such device is used: no library of theirs, no socket. Each look is
// also made where the device is used, so that it would notice.
#include <cstdlib>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "haptic/base/strokes.h"
#include "tests/end_to_end/live/session.h"
#include "tests/haptic/devices/fake_vendor/fake_inverse_service.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;

// The files that the running program maps.
std::string mapsOf(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/maps");
  return {std::istreambuf_iterator<char>(file), {}};
}

// Connections over TCP: fake HID devices have sockets of their own.
int tcpSocketsOf(pid_t pid) {
  const std::string process = "/proc/" + std::to_string(pid);
  std::set<std::string> tcp;
  for (const char* kind : {"tcp", "tcp6"}) {
    std::ifstream table(process + "/net/" + kind);
    std::string line;
    std::getline(table, line);  // headings
    while (std::getline(table, line)) {
      std::istringstream words(line);
      std::string word;
      for (int column = 0; column < 10; ++column) words >> word;  // the tenth is the inode
      tcp.insert("socket:[" + word + "]");
    }
  }
  int sockets = 0;
  for (const auto& entry : std::filesystem::directory_iterator(process + "/fd")) {
    std::error_code closed;
    if (tcp.count(std::filesystem::read_symlink(entry, closed).string()) > 0) ++sockets;
  }
  return sockets;
}

// What a makers' device needs, in place as if all of it were installed.
class UnusedParts : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_symlink(FETTLE_FAKE_HD, folder_.file("libHD.so"));
    std::filesystem::create_symlink(FETTLE_FAKE_DHD, folder_.file("libdhd.so"));
    setenv("FAKE_VENDOR_PAGE", folder_.file("page").c_str(), 1);
    ASSERT_NO_FATAL_FAILURE(writePlate(folder_.file("flat.tif")));
  }
  // A session with this device, until it runs.
  void start(const std::string& device) {
    program_ = std::make_unique<LiveProgram>(
        std::vector<std::string>{"record", folder_.file("flat.tif"), folder_.file("s.csv"),
                                 folder_.file("o.tif"), "--device", device, "--keys"},
        folder_.path().string(), service_.address());
    ASSERT_TRUE(program_->says("device")) << program_->err();
  }
  void end() {
    program_->press('q');
    EXPECT_EQ(program_->wait(), 0) << program_->err();
  }
  [[nodiscard]] bool maps(const std::string& file) const {
    return mapsOf(program_->pid()).find(file) != std::string::npos;
  }

  TempFolder folder_;
  fake::FakeInverseService service_;
  std::unique_ptr<LiveProgram> program_;
};

TEST_F(UnusedParts, OneDeviceLoadsNothingOfAnother) {
  fake::FakeWoody woody(folder_.path().string(), "woody", Firmware::kW8);
  woody.plug();
  ASSERT_NO_FATAL_FAILURE(start("woodenhaptics"));
  EXPECT_TRUE(maps("libhidapi")) << "the device's own library: the look would have noticed";
  for (const char* other : {"fake_hd", "fake_dhd", "libHD", "libdhd", "openxr"})
    EXPECT_FALSE(maps(other)) << other;
  EXPECT_EQ(tcpSocketsOf(program_->pid()), 0);
  EXPECT_EQ(service_.received().ever_connected, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("page"))) << "a maker's library was called";
  end();
}

TEST_F(UnusedParts, ASimulatedHandLoadsNothingOfAny) {
  const std::vector<haptic::StrokeSample> strokes{{0.0, {50.0, 50.0, 5.0}, haptic::Tool::kFeel},
                                                  {60.0, {51.0, 50.0, 5.0}, haptic::Tool::kFeel}};
  ASSERT_TRUE(haptic::writeStrokes(folder_.file("hand.csv"), strokes));
  ASSERT_NO_FATAL_FAILURE(start("hand:" + folder_.file("hand.csv")));
  for (const char* other : {"fake_hd", "fake_dhd", "libHD", "libdhd", "openxr"})
    EXPECT_FALSE(maps(other)) << other;
  EXPECT_EQ(tcpSocketsOf(program_->pid()), 0);
  EXPECT_EQ(service_.received().ever_connected, 0);
  end();
}

TEST_F(UnusedParts, AMakersDeviceLoadsItsOwnLibraryAlone) {
  ASSERT_NO_FATAL_FAILURE(start("touch"));
  EXPECT_TRUE(maps("fake_hd"));
  EXPECT_FALSE(maps("fake_dhd"));
  EXPECT_EQ(tcpSocketsOf(program_->pid()), 0);
  EXPECT_EQ(service_.received().ever_connected, 0);
  end();
}

TEST_F(UnusedParts, TheServicesDeviceOpensOneSocketAndNoLibrary) {
  ASSERT_NO_FATAL_FAILURE(start("inverse3"));
  EXPECT_TRUE(eventually([&] { return service_.received().messages > 10; })) << program_->err();
  EXPECT_EQ(tcpSocketsOf(program_->pid()), 1);
  EXPECT_FALSE(maps("fake_hd") || maps("fake_dhd"));
  end();
}

}  // namespace
}  // namespace fettle::tests
