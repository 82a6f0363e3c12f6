// A fake WoodenHaptics device as a process, for trying the whole program without hardware:
//
//   mkdir /tmp/hid && fake_woody /tmp/hid p14            (or w8)
//   FETTLE_FAKE_HID=/tmp/hid LD_LIBRARY_PATH=<folder of the fake libhidapi-hidraw.so.0> fettle devices
//
// Commands on standard input, one a line: unplug, plug, stall, resume, pause MS, garbage, short, oversized,
// turn A B C (encoder counts), press, release, calibrate, log, quit.
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>

#include "tests/haptic/devices/fake_hidapi/fake_woody.h"

int main(int count, char** arguments) {
  using fettle::fake::FakeWoody;
  if (count < 3) {
    std::fputs("usage: fake_woody FOLDER w8|p14 [NAME [SERIAL]]\n", stderr);
    return 2;
  }
  const bool w8 = std::string(arguments[2]) == "w8";
  FakeWoody woody(arguments[1], count > 3 ? arguments[3] : "woody",
                  w8 ? FakeWoody::Firmware::kW8 : FakeWoody::Firmware::kP14, count > 4 ? arguments[4] : "");
  woody.plug();
  const std::size_t size = w8 ? 8 : 14;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "quit") break;
    if (word == "unplug") woody.unplug();
    if (word == "plug") woody.plug();
    if (word == "stall") woody.stallOut(true);
    if (word == "resume") woody.stallOut(false);
    if (word == "press") woody.pressStylus(true);
    if (word == "release") woody.pressStylus(false);
    if (word == "calibrate") woody.pressCalibration();
    if (word == "garbage") woody.sendRaw(std::vector<std::uint8_t>(size, 0x5A));
    if (word == "short") woody.sendRaw({1, 2, 3});
    if (word == "oversized") woody.sendRaw(std::vector<std::uint8_t>(200, 0x77));
    if (word == "pause") {
      int ms = 0;
      words >> ms;
      woody.pause(std::chrono::milliseconds(ms));
    }
    if (word == "turn") {
      std::array<std::int32_t, 3> counts{};
      words >> counts[0] >> counts[1] >> counts[2];
      woody.turnTo(counts);
    }
    const fettle::fake::WoodyLog log = woody.log();
    std::printf(
        "inputs %llu outputs %llu odd %llu presets %llu watchdog %llu direct %llu mA %d %d %d most %d\n",
        static_cast<unsigned long long>(log.inputs), static_cast<unsigned long long>(log.outputs),
        static_cast<unsigned long long>(log.odd_outputs), static_cast<unsigned long long>(log.presets),
        static_cast<unsigned long long>(log.watchdog_fired),
        static_cast<unsigned long long>(log.direct_zeros), log.ma[0], log.ma[1], log.ma[2], log.most_ma);
    std::fflush(stdout);
  }
}
