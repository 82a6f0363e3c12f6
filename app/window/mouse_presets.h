#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "app/texts/texts.h"
#include "render/window/window.h"

namespace fettle::app {

/// The mouse buttons that move the view, as in other programs. In all of them: wheel = zoom to the cursor, and
/// Alt+left drag = turn, for hands without a middle button. While a tool is on, the left button is the stylus.
///
/// What only one hand-held axis can do there is left out here, since the vertical stays upright: rolling
/// (CloudCompare Shift+left, MeshLib Ctrl+middle), and MeshLab's movement along the view.
enum class Habits : std::uint8_t {
  kBlender,       ///< middle = turn, Shift+middle = pan, Ctrl+middle = zoom
  kCloudCompare,  ///< left = turn, right = pan, middle = zoom
  kMeshLab,       ///< left = turn, middle or Ctrl+left = pan, Shift+left = zoom
  kMeshLib,       ///< middle = turn, right = pan
};

struct MousePreset {
  Habits habits;
  std::string_view word;  ///< in the settings' file
  std::string_view line;  ///< of the menu
};
/// In the order of the enumeration.
inline constexpr std::array<MousePreset, 4> kMousePresets{{
    {Habits::kBlender, "blender", textOf("Blender: middle turns, Shift+middle moves, Ctrl+middle zooms")},
    {Habits::kCloudCompare, "cloudcompare", textOf("CloudCompare: left turns, right moves, middle zooms")},
    {Habits::kMeshLab, "meshlab", textOf("MeshLab: left turns, middle moves, Shift+left zooms")},
    {Habits::kMeshLib, "meshlib", textOf("MeshLib: middle turns, right moves")},
}};

/// The effect of a drag on the view.
enum class Drag : std::uint8_t { kNone, kTurn, kPan, kZoom };

/// What the press of a button begins. `tool_on`: the left button is the stylus.
///
/// In Blender and MeshLib a drag with the left button selects, which is no work here while no tool is on: then
/// it turns, and moves with Shift.
[[nodiscard]] Drag dragOf(render::MouseButton button, const render::Modifiers& modifiers, Habits habits,
                          bool tool_on) noexcept;

}  // namespace fettle::app
