// Sound in the window: ticked on, heard, muted; a session without an audio device.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

// What was played, with SDL's own device that writes it to a file: floats.
struct Heard {
  std::size_t samples = 0;
  double loudest = 0.0;
};
Heard heardIn(const std::string& path, std::uintmax_t from_byte = 0) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(from_byte / sizeof(float) * sizeof(float)));
  Heard heard;
  for (float sample = 0.0F; file.read(reinterpret_cast<char*>(&sample), sizeof(sample)); ++heard.samples)
    heard.loudest = std::max(heard.loudest, std::abs(static_cast<double>(sample)));
  return heard;
}

// High enough for all of the panel Haptics.
class SoundTest : public WindowTest {
 protected:
  SoundTest() : WindowTest(1100, 1500) {}
  // That panel alone.
  static State openHaptics(User& user) {
    (void)user.key("7");
    for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
    return user.click("Haptics");
  }
  // A stroke over the middle of the part, so many pixels long.
  static State strokeOver(User& user, int length, int steps) {
    const State picture = user.program().now()["picture"];
    const int x = picture[0].get<int>() + picture[2].get<int>() / 2 - length / 2;
    const int y = picture[1].get<int>() + picture[3].get<int>() / 2;
    return user.stroke({x, y}, {x + length, y}, steps);
  }
};

TEST_F(SoundTest, sound_is_ticked_heard_and_muted) {
  const std::string raw = folder.file("heard.raw");
  const auto program = start({scan}, {{"SDL_AUDIODRIVER", "disk"}, {"SDL_DISKAUDIOFILE", raw}});
  User user(display, *program, "sound");
  (void)opened(*program);
  const State silent = openHaptics(user);
  EXPECT_EQ(silent["sound"], "");
  EXPECT_FALSE(std::filesystem::exists(raw)) << "no device before a scene has sound";
  const State on = user.click("sound");
  EXPECT_EQ(on["sound"], "disk");
  EXPECT_EQ(on["notices"], State::array());
  EXPECT_EQ(on["muted"], false);
  (void)user.key("s");
  (void)strokeOver(user, 200, 12);
  (void)user.look("playing");
  EXPECT_GT(heardIn(raw).loudest, 0.005);
  EXPECT_EQ(user.click("mute")["muted"], true);
  const std::uintmax_t muted_from = std::filesystem::file_size(raw) + 16384;
  (void)strokeOver(user, 200, 12);
  const Heard muted = heardIn(raw, muted_from);
  EXPECT_GT(muted.samples, 4800U);
  EXPECT_EQ(muted.loudest, 0.0);
  EXPECT_EQ(user.click("sound")["sound"], "");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(SoundTest, the_volume_is_heard_and_kept_for_the_next_start) {
  const std::string raw = folder.file("volume.raw");
  const std::map<std::string, std::string> on_disk{{"SDL_AUDIODRIVER", "disk"}, {"SDL_DISKAUDIOFILE", raw}};
  const auto program = start({scan}, on_disk);
  User user(display, *program, "volume");
  (void)opened(*program);
  (void)openHaptics(user);
  EXPECT_EQ(user.click("sound")["volume"], 0.5);
  // Typed: Ctrl and a click make a field of a slider.
  const auto type = [&](const std::string& shown, const std::string& percent) {
    display.hands({"keydown", "ctrl"});
    user.tap(shown);
    display.hands({"keyup", "ctrl"});
    program->until("a field", [](const State& s) { return s["text_field"] == true; });
    user.write(percent);
    program->until("typed", [&](const State& s) { return s["field_text"] == percent; });
    (void)user.press("Return");
    return program->until("taken",
                          [](const State& s) { return s["text_field"] == false && s["settled"] == true; });
  };
  const auto strokeHeard = [&] {
    const std::uintmax_t from = std::filesystem::file_size(raw) + 16384;
    (void)strokeOver(user, 200, 12);
    return heardIn(raw, from).loudest;
  };
  (void)user.key("t");  // feels, and leaves no work to be asked about
  const double half = strokeHeard();
  EXPECT_GT(half, 0.005);
  EXPECT_EQ(type("50 %", "10")["volume"], 0.1);
  const double tenth = strokeHeard();
  EXPECT_GT(tenth, 0.0);
  EXPECT_LT(tenth, 0.6 * half);
  // Beyond the end of the slider there is its end.
  EXPECT_EQ(type("10 %", "400")["volume"], 1.0);
  EXPECT_GT(strokeHeard(), half);
  (void)type("100 %", "30");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  const auto again = start({scan}, on_disk);
  EXPECT_EQ(opened(*again)["volume"], 0.3);
  again->signal(SIGTERM);
  EXPECT_EQ(again->wait(), 0) << again->err();
  expectSilence(*again);
}

TEST_F(SoundTest, without_an_audio_device_a_notice_says_so_and_the_hand_still_works) {
  const auto program = start({scan}, {{"SDL_AUDIODRIVER", "none_such"}});
  User user(display, *program, "no_sound");
  (void)opened(*program);
  (void)openHaptics(user);
  (void)user.click("sound");
  const State on = program->until("the notice", [](const State& s) { return !s["notices"].empty(); });
  EXPECT_EQ(on["sound"], "");
  ASSERT_EQ(on["notices"].size(), 1U);
  EXPECT_EQ(on["notices"][0].get<std::string>().rfind("no sound: no audio device answers", 0), 0U)
      << on["notices"];
  // Once, not with every change of the scene.
  EXPECT_EQ(user.click("friction")["notices"].size(), 1U);
  (void)user.look("notice");
  (void)user.key("s");
  EXPECT_EQ(strokeOver(user, 100, 3)["steps"], 1);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
