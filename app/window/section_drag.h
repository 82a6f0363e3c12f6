#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <glm/vec2.hpp>

#include "app/window/window_picture.h"
#include "app/work/section_tool.h"
#include "engine/field/version.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// Sections under the mouse. Without a tool an end of the chosen one is dragged, and a click on another chooses it. With Ctrl+Shift, which a
/// tool leaves free, an end of any or a whole line is dragged. Escape puts back what is dragged. Threading: main.
class SectionDrag {
 public:
  struct Scope {
    const engine::Version& field;
    const WindowPicture& picture;
    const render::View& view;
    SectionTool& sections;
    bool tool_on;
  };

  /// Whether the press of a button begins a drag, whatever else it would do.
  [[nodiscard]] static bool begins(const render::InputEvent& event, const Scope& scope);
  /// Whether it used the event; a click is passed on, for it may turn the view, too.
  bool handle(const render::InputEvent& event, const Scope& scope);
  [[nodiscard]] bool active() const noexcept { return held_.has_value(); }
  /// The section stays where it is.
  void stop() noexcept;
  /// The section is where it was.
  void cancel(SectionTool& sections);

 private:
  enum class Part : std::uint8_t { kFrom, kTo, kLine };
  struct Found {
    std::size_t section;
    Part part;
  };
  struct Held {
    Part part;
    glm::dvec2 grip_mm;  // where it was taken hold of
    KeptSection before;
  };

  [[nodiscard]] static std::optional<glm::dvec2> placeOf(const render::InputEvent& event, const Scope& scope);
  [[nodiscard]] static std::optional<Found> find(const glm::dvec2& place_mm, const Scope& scope);
  [[nodiscard]] static std::optional<Found> grasp(const render::InputEvent& event, const Scope& scope);
  void move(const glm::dvec2& place_mm, const engine::Version& field, SectionTool& sections) const;

  std::optional<Held> held_;
  std::optional<glm::dvec2> pressed_;  // [pixels] where a click began
};

}  // namespace fettle::app
