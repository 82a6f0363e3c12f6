#pragma once

#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/end_to_end/window/view_program.h"

namespace fettle::tests {

/// One thing that must come up while the monkey plays: a tool, a dialog, a panel, a way of seeing.
struct Reach {
  std::string kind, what;
  std::function<bool(const ViewProgram::State&)> is;
  /// Steps there, one a frame: what xdotool's key takes, "drop FILE", "panel NAME", "over X Y" (per cent of the picture), "type TEXT", "hold KEY", "release KEY".
  std::vector<std::string> way;
  int times = 0;                      ///< reported so far
  std::function<void()> before = {};  ///< lays out what the way needs, which chance may have used up
};

/// Keys, clicks, strokes and texts without sense, from a seed. It is curious: it clicks on what it has
/// clicked on least, and now and then goes where it has been least.
class Monkey {
 public:
  using State = ViewProgram::State;

  Monkey(std::uint64_t seed, int width, int height);

  /// How many things to do before the next frame: 1 to 50, each order of size as often as another.
  [[nodiscard]] int actions();
  /// Words for one call of xdotool, of so many actions of a user at a window in this state.
  [[nodiscard]] std::vector<std::string> burst(int count, const State& state);
  /// The same for one step of a way; no words for a drop. "panel NAME" opens that panel, or comes nearer to
  /// it.
  [[nodiscard]] std::vector<std::string> step(const std::string& step, const State& state);
  /// Words that let go of the button that is held, if one is.
  [[nodiscard]] std::vector<std::string> letGo();
  /// A number below `end`.
  [[nodiscard]] int below(int end) { return static_cast<int>(random_() % static_cast<std::uint64_t>(end)); }

 private:
  void key(std::vector<std::string>& words, const State& state);
  void mouse(std::vector<std::string>& words, const State& state);
  void click(std::vector<std::string>& words, const State& state);
  void stroke(std::vector<std::string>& words, const State& state);

  std::mt19937_64 random_;
  int width_, height_;
  std::map<std::string, int> clicked_;  // texts without their digits
  std::string held_;                    // button of a stroke that continues in the next frames
};

/// The panels, from above.
[[nodiscard]] const std::vector<std::string>& namesOfPanels();

/// What xdotool calls the key of each action of the window, with its modifiers.
[[nodiscard]] const std::vector<std::string>& keysOfActions();

}  // namespace fettle::tests
