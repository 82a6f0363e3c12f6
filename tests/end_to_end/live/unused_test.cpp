// Nothing of what other makers' devices need is in the program while no such device is used, no library of theirs, no socket; and nothing
// of an audio device while no scene has sound. Each look is also made where it is used, so that it would notice.
#include <algorithm>
#include <cmath>
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
  void start(const std::string& device, const std::string& scene = "") {
    std::vector<std::string> arguments{
        "record", folder_.file("flat.tif"), folder_.file("s.csv"), folder_.file("o.tif"), "--device", device,
        "--keys"};
    if (!scene.empty()) {
      std::ofstream(folder_.file("scene.toml")) << scene;
      arguments.insert(arguments.end(), {"--scene", folder_.file("scene.toml")});
    }
    program_ = std::make_unique<LiveProgram>(arguments, folder_.path().string(), service_.address());
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

// A hand that lands, strokes and lifts, for a minute.
std::string strokingHand(const TempFolder& folder) {
  std::vector<haptic::StrokeSample> strokes;
  for (int i = 0; i <= 600; ++i) {
    const double t = 0.1 * i;
    strokes.push_back({t, {50.0 + 5.0 * std::sin(t), 50.0, std::cos(4.0 * t)}, haptic::Tool::kFeel});
  }
  EXPECT_TRUE(haptic::writeStrokes(folder.file("hand.csv"), strokes));
  return "hand:" + folder.file("hand.csv");
}

constexpr const char* kSounding = "effects = [\"spring\", \"friction\", \"sound\"]\n";
constexpr const char* kSilentScene = "effects = [\"spring\", \"friction\"]\n";

TEST_F(UnusedParts, ASceneWithoutSoundLoadsNothingOfAnAudioDevice) {
  setenv("SDL_AUDIODRIVER", "disk", 1);
  setenv("SDL_DISKAUDIOFILE", folder_.file("heard.raw").c_str(), 1);
  ASSERT_NO_FATAL_FAILURE(start(strokingHand(folder_), kSilentScene));
  for (const char* other : {"libSDL", "libasound", "libpulse", "libpipewire"})
    EXPECT_FALSE(maps(other)) << other;
  end();
  EXPECT_FALSE(std::filesystem::exists(folder_.file("heard.raw")));
}

TEST_F(UnusedParts, ASceneWithSoundPlaysWhatTheHandTouches) {
  setenv("SDL_AUDIODRIVER", "disk", 1);
  setenv("SDL_DISKAUDIOFILE", folder_.file("heard.raw").c_str(), 1);
  ASSERT_NO_FATAL_FAILURE(start(strokingHand(folder_), kSounding));
  EXPECT_TRUE(maps("libSDL2-2.0")) << "the look would have noticed";
  // As it was asked for: floats, one channel, 48 kHz. A hand that lands is heard.
  const auto loudest = [&] {
    std::ifstream file(folder_.file("heard.raw"), std::ios::binary);
    float most = 0.0F;
    for (float sample = 0.0F; file.read(reinterpret_cast<char*>(&sample), sizeof(sample));)
      most = std::max(most, std::isfinite(sample) ? std::abs(sample) : 2.0F);
    return most;
  };
  EXPECT_TRUE(eventually([&] { return loudest() > 0.005F; })) << program_->err();
  end();
  EXPECT_LE(loudest(), 1.0F);
}

TEST_F(UnusedParts, WithoutAnAudioDeviceThereIsOneLineAndTheSessionIsTheSame) {
  setenv("SDL_AUDIODRIVER", "none_such", 1);
  ASSERT_NO_FATAL_FAILURE(start(strokingHand(folder_), kSounding));
  EXPECT_TRUE(program_->says("active")) << program_->err();
  end();
  const std::string err = program_->err();
  const std::size_t first = err.find("no sound: no audio device answers");
  ASSERT_NE(first, std::string::npos) << err;
  EXPECT_EQ(err.find("no sound", first + 1), std::string::npos) << err;
}

}  // namespace
}  // namespace fettle::tests
