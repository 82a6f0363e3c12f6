#include "app/window/mouse_presets.h"

#include "engine/base/rows.h"

namespace fettle::app {
namespace {

using render::MouseButton;

static_assert(engine::inOrder(kMousePresets, &MousePreset::habits,
                              static_cast<Habits>(kMousePresets.size())));

Drag leftDrag(const render::Modifiers& m, Habits habits) {
  if (habits == Habits::kCloudCompare) return Drag::kTurn;
  if (habits != Habits::kMeshLab) return m.shift ? Drag::kPan : Drag::kTurn;
  return m.control ? Drag::kPan : m.shift ? Drag::kZoom : Drag::kTurn;
}

Drag middleDrag(const render::Modifiers& m, Habits habits) {
  switch (habits) {
    case Habits::kBlender:
      return m.shift ? Drag::kPan : m.control ? Drag::kZoom : Drag::kTurn;
    case Habits::kCloudCompare:
      return Drag::kZoom;
    case Habits::kMeshLab:
      return m.alt ? Drag::kTurn : Drag::kPan;
    case Habits::kMeshLib:
      break;
  }
  return Drag::kTurn;
}

}  // namespace

Drag dragOf(MouseButton button, const render::Modifiers& modifiers, Habits habits, bool tool_on) noexcept {
  switch (button) {
    case MouseButton::kLeft:
      if (modifiers.alt) return Drag::kTurn;
      return tool_on ? Drag::kNone : leftDrag(modifiers, habits);
    case MouseButton::kMiddle:
      return middleDrag(modifiers, habits);
    case MouseButton::kRight:
      // In the other two a menu, which there is none of here.
      return habits == Habits::kCloudCompare || habits == Habits::kMeshLib ? Drag::kPan : Drag::kNone;
    case MouseButton::kOther:
      break;
  }
  return Drag::kNone;
}

}  // namespace fettle::app
