#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::tests {

/// What a program needs to find the test runtime with a script, watched by the validation layer of OpenXR, and what both
/// say about it afterwards.
class XrStage {
 public:
  explicit XrStage(const std::string& script) { act(script); }
  /// Continues the script, also while it runs: whole lines.
  void act(const std::string& lines) const {
    std::ofstream(folder_.file("script.txt"), std::ios::app) << lines << std::flush;
  }
  /// Copies the kept pictures where $FETTLE_WINDOW_SHOTS names a folder.
  ~XrStage() {
    const char* const shots = std::getenv("FETTLE_WINDOW_SHOTS");
    if (shots == nullptr) return;
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().extension() == ".png")
        std::filesystem::copy_file(entry.path(),
                                   std::filesystem::path(shots) /
                                       (std::string(test->name()) + "." + entry.path().filename().string()),
                                   std::filesystem::copy_options::overwrite_existing);
  }
  XrStage(const XrStage&) = delete;
  XrStage& operator=(const XrStage&) = delete;

  [[nodiscard]] std::map<std::string, std::string> environment() const {
    return {{"XR_RUNTIME_JSON", FETTLE_XR_RUNTIME},
            {"FETTLE_XR_SCRIPT", folder_.file("script.txt")},
            {"FETTLE_XR_KEEP", folder_.path().string()},
            {"XR_ENABLE_API_LAYERS", "XR_APILAYER_LUNARG_core_validation"},
            {"XR_CORE_VALIDATION_EXPORT_TYPE", "text"},
            {"XR_CORE_VALIDATION_FILE_NAME", folder_.file("validation.txt")}};
  }
  /// For this process itself.
  void set() const {
    for (const auto& [name, value] : environment()) setenv(name.c_str(), value.c_str(), 1);
  }

  /// What the runtime noted.
  [[nodiscard]] std::string log() const { return bytesOf(folder_.file("log.txt")); }
  /// How often a text is in it.
  [[nodiscard]] int count(const std::string& text) const {
    const std::string all = log();
    int times = 0;
    for (std::size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) ++times;
    return times;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  /// What the layer wrote: no file where all is well. It opens one for a process, with its first instance.
  [[nodiscard]] std::string validation() const { return bytesOf(folder_.file("validation.txt")); }
  void expectSilence() const {
    EXPECT_EQ(count("wrong:"), 0) << log();
    EXPECT_EQ(validation(), "");
  }
  /// That all was destroyed, the swapchains before their session, that after its end and before the instance.
  enum class Session { kEnded, kLost, kNeverRan };
  void expectLeftInOrder(Session session) const {
    const std::string all = log();
    const auto last = [&](const char* line) { return all.rfind(std::string(line) + "\n"); };
    const int destroyed = count("swapchain destroyed\n");
    EXPECT_GT(destroyed, 0) << all;
    EXPECT_EQ(count("swapchain ") - destroyed, destroyed) << all;
    const std::size_t end = session == Session::kEnded  ? last("session ended")
                            : session == Session::kLost ? last("state LOSS_PENDING")
                                                        : last("state READY");
    EXPECT_LT(end, last("swapchain destroyed")) << all;
    EXPECT_LT(last("swapchain destroyed"), last("session destroyed")) << all;
    EXPECT_LT(last("session destroyed"), last("instance destroyed")) << all;
    EXPECT_NE(last("instance destroyed"), std::string::npos) << all;
  }

 private:
  TempFolder folder_;
};

}  // namespace fettle::tests
