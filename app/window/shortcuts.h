#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "render/window/window.h"

namespace fettle::app {

/// Everything a person can ask for without pointing at something. Menus, keys and the shortcut list all come
/// from the one table in shortcuts.cpp.
enum class Action : std::uint8_t {
  kOpen,
  kSave,
  kSaveAs,
  kExport,
  kQuit,
  kUndo,
  kRedo,
  kNavigate,
  kFeel,
  kSmooth,
  kMark,
  kUnmark,
  kBrushRadius,
  kBrushStrength,
  kBrushSmaller,
  kBrushLarger,
  kInvert,
  kShowMarks,
  kClearMarks,
  kInvertMarks,
  kLasso,
  kBox,
  kEdges,
  kEdgesMore,
  kEdgesFewer,
  kEdgesThicker,
  kEdgesThinner,
  kEdgesCoarser,
  kEdgesFiner,
  kKeepWithin,
  kFilterNext,
  kFilterPreview,
  kFilterBeside,
  kFilterDrop,
  kFilterApply,
  kWindowLarger,
  kWindowSmaller,
  kMorePasses,
  kFewerPasses,
  kFilterScope,
  kFilterMaxChange,
  kDeviation,
  kContours,
  kNextMap,
  kStereo,
  kSplitPreview,
  kSplitLeft,
  kSplitRight,
  kLightLeft,
  kLightRight,
  kLightHigher,
  kLightLower,
  kTheme,
  kFurniture,
  kMouseHabits,
  kViewAll,
  kViewLastStroke,
  kViewFront,
  kViewBack,
  kViewRight,
  kViewLeft,
  kViewTop,
  kProjection,
  kTurnLeft,
  kTurnRight,
  kTiltUp,
  kTiltDown,
  kPanLeft,
  kPanRight,
  kPanUp,
  kPanDown,
  kZoomIn,
  kZoomOut,
  kArm,
  kDisarm,
  kCalibrate,
  kShortcuts,
  kSidePanel,
  kEnterPanels,
};

struct Shortcut {
  Action action;
  std::string_view section;  ///< "File", "Edit", "Tool", "Marks", "Filter", "View", "Device", "Help"
  std::string_view name;     ///< what it does, for menus and the list
  render::Key key = render::Key::kNone;
  render::Modifiers modifiers{};
  render::Key other_key = render::Key::kNone;  ///< for keyboards that lack the first
};

[[nodiscard]] std::span<const Shortcut> shortcuts();
[[nodiscard]] const Shortcut& shortcutOf(Action action);
/// What a key stands for; nothing for keys without a meaning.
[[nodiscard]] std::optional<Action> actionOf(render::Key key, render::Modifiers modifiers);
/// Whether a key takes the force back, which no dialog and no tool may keep it from: that of Action::kDisarm,
/// unless it is a letter being typed into a field, and Pause always.
enum class Typing : std::uint8_t { kNo, kYes };
[[nodiscard]] bool disarms(render::Key key, render::Modifiers modifiers, Typing typing);
/// "Ctrl+Shift+S", "F1", "keypad 7".
[[nodiscard]] std::string keyText(render::Key key, render::Modifiers modifiers);

}  // namespace fettle::app
