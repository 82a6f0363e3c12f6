#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptic/base/tools.h"
#include "render/window/window.h"

namespace fettle::app {

struct Parts;

/// All commands of the user that need no pointing, in the order of the table in actions.cpp: a new one needs
/// an entry here, a row there, and its function.
enum class Action : std::uint8_t {
  kOpen,
  kReadAs,
  kJoin,
  kSave,
  kSaveAs,
  kExport,
  kOpenScene,
  kSaveScene,
  kExportSections,
  kExportReport,
  kQuit,
  kUndo,
  kRedo,
  kNavigate,
  kFirstTool,  ///< one for each tool, in their order: see actionOf(tool)
  kLastTool = kFirstTool + haptic::kTools - 1,
  kRadialMenu,
  kPointTip,
  kBallTip,
  kBrushRadius,
  kBrushStrength,
  kBrushSmaller,
  kBrushLarger,
  kInvert,
  kKeepWithin,
  kShowMarks,
  kClearMarks,
  kInvertMarks,
  kRemoveMarked,
  kDrawLines,
  kNextLine,
  kRemoveLine,
  kJoinLine,
  kClearLines,
  kNextPlace,
  kHidePlaces,
  kLasso,
  kBox,
  kEdges,
  kEdgesMore,
  kEdgesFewer,
  kEdgesThicker,
  kEdgesThinner,
  kEdgesCoarser,
  kEdgesFiner,
  kFilterSuggest,
  kFilterNext,
  kFilterPreview,
  kFilterAdd,
  kFilterDrop,
  kWindowLarger,
  kWindowSmaller,
  kMorePasses,
  kFewerPasses,
  kFilterScope,
  kFilterMaxChange,
  kFilterApply,
  kSplitPreview,
  kSplitLeft,
  kSplitRight,
  kPlanePoints,
  kPlanePoint,
  kFormPreview,
  kFormOut,
  kFormBack,
  kFormHeights,
  kRemoveOpen,
  kRemovePreview,
  kRemoveSamples,
  kFillPreview,
  kFillHoles,
  kLevelPreview,
  kLevelLines,
  kFitShapes,
  kExportFits,
  kFindFeatures,
  kExportFeatures,
  kSectionFrom,
  kSectionTo,
  kSectionNew,
  kSectionNext,
  kCompare,
  kCompareAgain,
  kShowBefore,
  kDeviation,
  kContours,
  kNextMap,
  kStereo,
  kTheme,
  kPanelsTheme,
  kDecorations,
  kAxes,
  kLightLeft,
  kLightRight,
  kLightHigher,
  kLightLower,
  kMouseHabits,
  kViewAll,
  kViewLastStroke,
  kViewFront,
  kViewBack,
  kViewRight,
  kViewLeft,
  kViewTop,
  kBookmark1,
  kBookmark2,
  kBookmark3,
  kBookmark4,
  kSetBookmark1,
  kSetBookmark2,
  kSetBookmark3,
  kSetBookmark4,
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
  kSidePanel,
  kFullScreen,
  kEnterPanels,
  kUnderstood,
  kArm,
  kDisarm,
  kCalibrate,
  kSetUpDevice,
  kShortcuts,
  kCount
};

/// Switches the tool on.
[[nodiscard]] constexpr Action actionOf(haptic::Tool tool) noexcept {
  return static_cast<Action>(static_cast<int>(Action::kFirstTool) + static_cast<int>(tool));
}

/// Position of an action in the menus: items of a menu are ordered by group, then by the table.
struct MenuPlace {
  int group = 0;               ///< 1, 2, ...; 0: in no menu
  std::string_view menu = "";  ///< empty: that of its section
};

/// What must exist before an action can be executed.
enum class Needs : std::uint8_t {
  kNothing,
  kPicture,  ///< a document, or a coarse picture of one
  kField,    ///< a document
};

struct ActionRow {
  Action action;
  std::string_view section;  ///< "File", "Edit", "Tool", "Marks", "Filter", "View", "Device", "Help"
  std::string_view name;     ///< what it does, for menus and the list of keys (F1)
  render::Key key;
  render::Modifiers modifiers;
  render::Key other_key;  ///< for keyboards that lack the first, or for other habits
  MenuPlace menu;
  Needs needs;
  void (*carry_out)(Parts& parts);
  bool (*ticked)(const Parts& parts) = nullptr;   ///< shown in the menu; null: never
  bool (*enabled)(const Parts& parts) = nullptr;  ///< in the menu; null: when what it needs exists
  /// Those of the other key; nothing: as for the first.
  std::optional<render::Modifiers> other_modifiers = std::nullopt;

  [[nodiscard]] render::Modifiers modifiersOfOther() const noexcept {
    return other_modifiers.value_or(modifiers);
  }
  [[nodiscard]] std::string_view menuTitle() const noexcept {
    return menu.menu.empty() ? section : menu.menu;
  }
};

/// In the order of the list of keys.
[[nodiscard]] std::span<const ActionRow> actions();
[[nodiscard]] const ActionRow& rowOf(Action action);
/// Whether what it needs exists.
[[nodiscard]] bool ready(const ActionRow& row, const Parts& parts);
/// Executes it, if possible.
void carryOut(Action action, Parts& parts);

/// The action of a key; nothing for keys without one.
[[nodiscard]] std::optional<Action> actionOf(render::Key key, render::Modifiers modifiers);
/// Whether a key disarms, which no dialog and no tool may prevent: that of Action::kDisarm, unless it is a
/// letter being typed into a field, and Pause always.
enum class Typing : std::uint8_t { kNo, kYes };
[[nodiscard]] bool disarms(render::Key key, render::Modifiers modifiers, Typing typing);
[[nodiscard]] constexpr render::Key keypadKey(int digit) noexcept {
  return static_cast<render::Key>(static_cast<int>(render::Key::kKeypad0) + digit);
}
[[nodiscard]] constexpr render::Key functionKey(int n) noexcept {
  return static_cast<render::Key>(static_cast<int>(render::Key::kF1) + n - 1);
}
/// "Ctrl+Shift+S", "F1", "keypad 7".
[[nodiscard]] std::string keyText(render::Key key, render::Modifiers modifiers);

}  // namespace fettle::app
