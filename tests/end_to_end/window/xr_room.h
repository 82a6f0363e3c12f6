#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "render/png/png.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/xr_runtime/xr_stage.h"

namespace fettle::tests {

// A head over the table, whose top lies at 0.75 m and 0.55 m ahead, and which looks down at it; 0.15 m behind it is a screen
// of 1.1 m x 0.8 m, a millimetre for each of the window's pixels.
inline constexpr const char* kRoom = "size 480 500\nrate 45\n0 head 0 1.45 -0.05 0 -42\n";
inline constexpr double kScreenY_m = 1.35, kTableZ_m = -0.6;

/// The program with a scripted headset on (tests/xr_runtime), and hands in its room.
class XrRoomTest : public WindowTest {
 protected:
  using State = User::State;
  explicit XrRoomTest(Frames frames = Frames::kShared) : WindowTest(frames), stage(kRoom) {}

  std::unique_ptr<ViewProgram> startIn(std::vector<std::string> more = {},
                                       std::map<std::string, std::string> environment = {}) const {
    more.insert(more.begin(), {scan, "--xr"});
    environment.merge(stage.environment());
    auto program = start(more, environment);
    (void)opened(*program);
    program->until("the field is in the room",
                   [](const State& s) { return s["headset"] == "shown" && s["room"]["mm"] > 0.0; });
    return program;
  }
  // A hand at a place that looks down.
  static std::string over(const char* hand, double x, double y, double z = kTableZ_m, int frame = 1) {
    return fmt::format("+{} {} {} {} {} 0 -70\n", frame, hand, x, y, z);
  }
  // A hand whose ray meets a pixel of the window's frame.
  static std::string at(const char* hand, double px, double py, int frame = 1) {
    return fmt::format("+{} {} {} {} -0.6 0 0\n", frame, hand, 1e-3 * px - 0.55,
                       kScreenY_m + 0.4 - 1e-3 * py);
  }
  static std::string set(const char* what, double value, int frame = 1) {
    return fmt::format("+{} {} {}\n", frame, what, value);
  }
  // The middle of what reads `text`.
  static User::Place middleOf(ViewProgram& program, const std::string& text) {
    const State now = program.now();
    for (const State& t : now["texts"])
      if (t["text"] == text)
        return {t["at"][0].get<int>() + t["at"][2].get<int>() / 2,
                t["at"][1].get<int>() + t["at"][3].get<int>() / 2};
    ADD_FAILURE() << text << " is not in " << now["texts"].dump();
    return {};
  }
  // A hand points at a pixel of the window's frame, with the head up to it.
  void pointAt(ViewProgram& program, User::Place place) const {
    stage.act("+1 head 0 1.45 -0.05 0 -12\n" + at("right", place.x, place.y));
    (void)program.until("the cursor there", [&](const State& s) {
      return s["room"]["points"] == true && std::abs(s["cursor"][0].get<int>() - place.x) <= 1 &&
             std::abs(s["cursor"][1].get<int>() - place.y) <= 1;
    });
  }
  static State tipIs(ViewProgram& program, const State& hand) {
    return program.until("the tip " + hand.dump(), [&](const State& s) { return s["room"]["tip"] == hand; });
  }
  // Keeps what is seen some frames from now; its number.
  int keep(int frames = 2) const {
    const int before = stage.count("\nframe ");
    stage.act(fmt::format("+{} keep\n", frames));
    for (int tries = 0; stage.count("\nframe ") == before && tries < 2000; ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::string log = stage.log();
    return std::atoi(log.c_str() + log.rfind("\nframe ") + 7);
  }
  render::Image seen(int frame, const char* eye, const char* what = "") const {
    const auto image = render::readPng(stage.file(fmt::format("frame{}.{}{}.png", frame, eye, what)));
    EXPECT_TRUE(image) << stage.log();
    return image ? *image : render::Image{};
  }
  static int pixelsApart(const render::Image& a, const render::Image& b) {
    int apart = 0;
    for (std::size_t i = 0; i + 3 < std::min(a.rgba.size(), b.rgba.size()); i += 4)
      apart += std::equal(&a.rgba[i], &a.rgba[i] + 3, &b.rgba[i]) ? 0 : 1;
    return apart;
  }
  // The strongest vibration told to a hand since `from` of the log.
  double strongest(const std::string& hand, std::size_t from) const {
    std::istringstream lines(stage.log().substr(from));
    double most = 0.0;
    for (std::string line; std::getline(lines, line);)
      if (line.find("haptics " + hand) == 0 && line.find("stopped") == std::string::npos)
        most = std::max(most, std::atof(line.c_str() + 9 + hand.size()));
    return most;
  }
  // The last word about a hand's vibration.
  std::string lastWord(const std::string& hand) const {
    const std::string log = stage.log();
    const std::size_t begin = log.rfind("haptics " + hand);
    return begin == std::string::npos ? "" : log.substr(begin, log.find('\n', begin) - begin);
  }

  // The headset's next frames tell a hand nothing more.
  void expectStops(const std::string& hand) const {
    for (int tries = 0; lastWord(hand).find("stopped") == std::string::npos && tries < 2000; ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_NE(lastWord(hand).find("stopped"), std::string::npos) << lastWord(hand);
  }

  XrStage stage;
};

}  // namespace fettle::tests
