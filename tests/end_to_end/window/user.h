#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tests/end_to_end/window/display.h"
#include "tests/end_to_end/window/view_program.h"
#include "tests/end_to_end/window/x_client.h"

namespace fettle::tests {

/// A person at the window: presses, moves, reads what is written and looks at the picture. Whatever is done
/// is waited for until the window says that it took it in and that what came of it is on the screen.
class User {
 public:
  using State = ViewProgram::State;
  struct Place {
    int x = 0, y = 0;
  };

  /// `name`: of the pictures that are kept when $FETTLE_WINDOW_SHOTS names a folder.
  User(const Display& display, ViewProgram& program, std::string name);

  /// A key with its modifiers ("ctrl+shift+s"), until the window rests again.
  State key(const std::string& name);
  /// The same, but only until the window has taken it in.
  State press(const std::string& name);
  /// Text into the field that has the keyboard, in place of what is selected there.
  void type(const std::string& text);
  /// Keys of a text, whoever takes them.
  void write(const std::string& text) { display_.hands({"type", "--delay", "0", text}); }
  void at(Place place);
  void down(int button);
  void up(int button);
  State wheel(int steps);  ///< up: positive
  /// From place to place with a button held, in so many steps, until the window rests.
  State drag(int button, Place from, Place to, int steps, const std::string& modifier = "");
  /// A stroke of the stylus: as drag() with the left button, waiting at each place until the stylus is there.
  State stroke(Place from, Place to, int steps);
  /// The same without waiting for the rest at its end: while something else continues.
  void draw(Place from, Place to, int steps);
  /// Clicks on what reads `text`, until the window rests. Panels are scrolled for it where they have to be.
  State click(const std::string& text, int count = 1);
  /// One click on what reads `text`, taken in by the window; whatever it began continues.
  void tap(const std::string& text);
  /// Types into the field to the right of the name that reads `name`, confirmed, until the window rests.
  State enter(const std::string& name, const std::string& value);
  /// The same, and the field is not left. Whether it was found.
  bool typeIn(const std::string& name, const std::string& value);
  /// Into the field that shows `now`, in place of what is there; the field is not left.
  void writeOver(const std::string& now, const std::string& text);
  /// Until nothing moves any more and everything asked for was done.
  State rest(const std::string& what = "rest");
  /// Whether a text is on the panels.
  [[nodiscard]] bool reads(const std::string& text);
  /// The same, after scrolling the panels as far as that takes.
  [[nodiscard]] bool readsScrolled(const std::string& text) { return scrolledTo(text).has_value(); }

  /// The surface of the picture without the colour bar and the status line.
  [[nodiscard]] Part surface();
  /// What is on the screen now, whatever moves there. Kept as look() does.
  Screen glance(const std::string& what);
  /// What is on the screen, at rest. Kept as a picture called `what` when pictures are kept.
  Screen look(const std::string& what);
  /// Looks until the screen is as asked for and stays so.
  Screen until(const std::string& what, const std::function<bool(const Screen&)>& is);
  /// Looks until the surface differs from `before` in at least `pixels` pixels.
  Screen changed(const std::string& what, const Screen& before, int pixels = 30);
  /// Looks until the surface is as in `as`.
  Screen same(const std::string& what, const Screen& as);

  ViewProgram& program() { return program_; }

 private:
  /// The middle of what reads `text`, where the mouse can take it.
  [[nodiscard]] static std::optional<Place> readable(const State& now, const std::string& text);
  /// The same, after scrolling the panels as far as that takes.
  [[nodiscard]] std::optional<Place> scrolledTo(const std::string& text);
  /// Whether there is such a text; the cursor is on it then.
  [[nodiscard]] bool pointAt(const std::string& text);
  void keep(const Screen& screen, const std::string& what);
  [[nodiscard]] State waitFor(const std::string& what, const std::function<bool(const State&)>& is) {
    return program_.until(name_ + ": " + what, is);
  }
  [[nodiscard]] std::uint64_t counter(const char* name);

  const Display& display_;
  ViewProgram& program_;
  std::string name_;
  int shots_ = 0;
};

}  // namespace fettle::tests
