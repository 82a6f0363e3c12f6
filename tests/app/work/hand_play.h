#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "app/work/filter_preview.h"
#include "app/work/form_tool.h"
#include "app/work/height_tool.h"
#include "app/work/loop_client.h"
#include "app/work/session_keeper.h"

namespace fettle::tests {

/// contentHash of what a session stores of a state: of one that is seen under a form its samples.
[[nodiscard]] std::uint64_t storedHash(const engine::Version& state);

/// A person at the window, without the window: random strokes with the mouse as stylus, undo and redo,
/// filters applied during a stroke, marks, scenes, forms taken out and put back, holes filled, lines levelled. On the real loop, in real time.
class HandPlay {
 public:
  HandPlay(app::LoopClient& client, app::SessionKeeper& keeper, std::uint64_t seed)
      : client_(client), keeper_(keeper), random_(seed) {}

  /// One thing a person does; says what.
  std::string act();
  /// A plane is taken out.
  void takeOutPlane();
  /// What is seen becomes the heights.
  void makeHeights();
  /// Holes are filled, or lines levelled.
  void make(const haptic::HeightsMaker& maker);
  /// This filter, applied during a stroke.
  void apply(const engine::FilterSpec& spec);
  /// Until nothing is under way: no stroke, no filter, every step handed over.
  void settle();
  /// Until all that was done lies on the disk.
  void untilKept();
  /// Things that went wrong and a person would read.
  [[nodiscard]] const std::vector<app::Notice>& notices() const { return notices_; }

 private:
  void wait(std::uint64_t ticks);
  void press(double u, double v, bool held);
  std::string stroke(bool ends);
  std::string filter(bool under_a_stroke);
  std::string marks();
  std::string lines();
  std::string scene();
  std::string form();
  std::string heights();
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  app::LoopClient& client_;
  app::SessionKeeper& keeper_;
  std::mt19937_64 random_;
  app::FilterPreview filters_;
  app::FormTool form_;
  app::HeightTool heights_;
  std::vector<app::Notice> notices_;
  double u_ = 0.5, v_ = 0.5;  // where the cursor is, in fractions of the field
};

}  // namespace fettle::tests
