#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/version.h"
#include "tests/end_to_end/window/user.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {

/// A field from a file; ends the test program when there is none.
[[nodiscard]] engine::Version load(const std::string& path);

/// Where two fields of one size differ.
struct Differences {
  std::int64_t changed = 0;         ///< samples, bit for bit
  std::int64_t changed_marked = 0;  ///< of those that are marked in the second
  std::int64_t marked = 0;          ///< in the second
  std::int32_t first_row = -1, last_row = -1;
  std::int32_t first_column = -1, last_column = -1;
  double most = 0.0;  ///< largest change [height unit]
};
[[nodiscard]] Differences compare(const engine::Version& a, const engine::Version& b);

/// A virtual display, a simulated scan, and the real program on both; the validation layers watch it all.
class WindowTest : public ::testing::Test {
 protected:
  /// How frames reach the display: Vulkan's layers see those alone that Vulkan shows.
  enum class Frames { kShared, kThroughVulkan };
  WindowTest() : WindowTest(1100, 800) {}
  explicit WindowTest(Frames frames) : WindowTest(1100, 800, frames) {}
  WindowTest(int width, int height, Frames frames = Frames::kShared);
  void SetUp() override;
  /// Whether a picture that has been drawn changes once more when nothing else does: by four rays per pixel.
  enum class AtRest { kPlain, kSmooth };
  /// Starts the program with these arguments, at the size of the display unless they say another.
  std::unique_ptr<ViewProgram> start(std::vector<std::string> arguments,
                                     const std::map<std::string, std::string>& environment = {},
                                     AtRest at_rest = AtRest::kPlain) const;
  /// Waits until it shows the scan and rests.
  static User::State opened(ViewProgram& program);
  /// Ctrl+Shift+S to a path, until it is written.
  static void saveAs(User& user, const std::string& path);
  /// Ctrl+Q, and the end: exit status 0 and no word from the validation layers. Its report.
  static User::State quit(User& user);
  /// The same where there is unsaved work: it is dropped when the question comes.
  static User::State quitWithoutSaving(User& user);
  static void expectSilence(const ViewProgram& program);

  TempFolder folder;
  Display display;
  XClient other;
  std::string scan = folder.file("part.tif");
  int width_, height_;

 private:
  static User::State endOf(ViewProgram& program);
};

}  // namespace fettle::tests
