#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/live/hand.h"
#include "tests/end_to_end/live/live_program.h"
#include "tests/haptic/devices/fake_hidapi/fake_woody.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {

using Firmware = fake::FakeWoody::Firmware;

inline constexpr double kPlate_mm = 100.0;

/// A session of the built program on a fake WoodenHaptics device: a bumpy plate of 100 mm, felt with half a
/// N/mm; the stylus starts in its home pose, 205 mm above.
class Session {
 public:
  explicit Session(Firmware firmware, std::vector<std::string> more_arguments = {},
                   double side_mm = kPlate_mm);

  /// Until force is given: calibrated by the device's own button (P14) or by key (W8), armed by key.
  void arm();
  void calibrate();
  /// A machine that holds the program up for 50 ms makes a fault of it, as it should: whether that was so
  /// since the last wait for words. The hand has come out then, armed again and gone back to where it was.
  bool armedAgainAfterAFault();
  /// The hand goes there [mm, desk] in so long, and the call returns when it is there.
  void goTo(const glm::dvec3& desk_mm, std::chrono::milliseconds length);
  /// From above down to the surface and `mm` of the hand into it, at the middle.
  void touch(double mm);
  /// Holds the stylus button, or chooses the tool that acts always.
  void use(char tool_key);
  void release();
  /// Waits until the device gives force, or none; fails the test when it does not within 30 s. For force,
  /// arms again after a fault.
  void expectForce();
  void expectNoForce();
  /// Ends by key, expects success, compares the recording with a replay of its own, with the scene that was felt, returns the report.
  nlohmann::json end();

  /// What the device felt since `from`; prints it as a row of the table of attacks.
  Felt felt(const std::string& attack, std::size_t from = 0);

  Firmware firmware;
  TempFolder folder;
  fake::FakeWoody woody;
  std::unique_ptr<LiveProgram> program;
  std::string scan, strokes, out, marks;

 private:
  glm::dvec3 at_{0.0};  // where the hand went last [mm, desk]
};

/// The profile's limits for woody_v2015.
inline constexpr double kPeak_n = 5.0;
inline constexpr double kSlew_n_per_ms = 1.0;

/// No report on stderr of a sanitizer, whichever was built in.
void expectNoSanitizerReport(const LiveProgram& program);

/// A rough plate at height 0, as a TIFF.
void writePlate(const std::string& path, double side_mm = kPlate_mm);

[[nodiscard]] bool eventually(const std::function<bool()>& holds);

inline std::string firmwareName(Firmware firmware) {
  return firmware == Firmware::kW8 ? "W8" : "P14";
}

}  // namespace fettle::tests
