#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <glm/vec2.hpp>

#include "app/texts/texts.h"
#include "app/window/actions.h"
#include "render/plan/camera.h"
#include "render/window/window.h"

namespace fettle::app {

/// Tools and tips around the cursor. A direction chooses: it is learnt by the hand, and the eye stays on the work. The
/// key or the button that opened it is held, and chooses when it is released; in the middle that is nothing. A tap,
/// without a direction, leaves it open: then a click or Enter chooses. Escape ends it. Arrow keys give a direction,
/// too. Threading: main.
class RadialMenu {
 public:
  struct Item {
    std::string_view name;
    Action action;
  };
  /// Clockwise from the top.
  static constexpr std::array<Item, 8> kItems{{{textOf("Smooth"), actionOf(haptic::Tool::kSmooth)},
                                               {textOf("Mark"), actionOf(haptic::Tool::kMark)},
                                               {textOf("Unmark"), actionOf(haptic::Tool::kUnmark)},
                                               {textOf("Lasso"), Action::kLasso},
                                               {textOf("View"), Action::kNavigate},
                                               {textOf("Ball tip"), Action::kBallTip},
                                               {textOf("Point tip"), Action::kPointTip},
                                               {textOf("Feel"), actionOf(haptic::Tool::kFeel)}}};
  static constexpr render::Key kKey = render::Key::kSpace;
  /// At scale 1 [pixels]: within which nothing is chosen; of the names.
  static constexpr double kMiddle_px = 24.0, kNames_px = 92.0;

  enum class By : std::uint8_t {
    kKey,
    kButton,
    kDevice,  ///< the tip of a device points, by follow(), and not the cursor
  };
  /// Opens at the cursor, brought into the picture.
  void open(const glm::dvec2& cursor, const render::Rectangle& picture, double scale, By by);
  void close() noexcept { active_ = false; }

  struct Outcome {
    bool used = false;  ///< by the menu: for nobody else
    std::optional<Action> chosen{};
  };
  [[nodiscard]] Outcome handle(const render::InputEvent& event);

  /// Opened by a device: where its tip is in the picture, and its button, which was pressed again or is not held.
  void follow(const glm::dvec2& tip) noexcept { point(tip); }
  [[nodiscard]] Outcome pressAgain() noexcept { return choose(); }
  [[nodiscard]] Outcome letGo() noexcept { return held_ == By::kDevice ? release() : Outcome{}; }
  [[nodiscard]] bool ofDevice() const noexcept { return active_ && of_device_; }

  [[nodiscard]] bool active() const noexcept { return active_; }
  /// The item in whose direction the cursor is, or that an arrow key chose.
  [[nodiscard]] std::optional<std::size_t> pointed() const noexcept { return pointed_; }
  /// How far its names reach from its middle [pixels].
  struct Reach {
    double left = 0.0, up = 0.0, right = 0.0, down = 0.0;
  };
  /// Where its middle is drawn: at the cursor, or as far from it as it takes to have all names in the picture; in the middle of a
  /// picture that is too small. Directions count from where the cursor was.
  [[nodiscard]] glm::dvec2 drawnAt(const Reach& names) const noexcept;

 private:
  void point(const glm::dvec2& cursor) noexcept;
  void turnTo(std::size_t item) noexcept;
  [[nodiscard]] Outcome press(const render::InputEvent& event);
  [[nodiscard]] Outcome choose() noexcept;
  [[nodiscard]] Outcome release() noexcept;

  bool active_ = false;
  std::optional<By> held_;  // what opened it, until it is released
  bool of_device_ = false;
  bool was_pointed_ = false;  // at an item, since it was opened
  std::optional<std::size_t> pointed_;
  glm::dvec2 middle_{0.0};
  render::Rectangle picture_{};
  double scale_ = 1.0;
};

}  // namespace fettle::app
