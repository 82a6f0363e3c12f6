#include "app/window/shortcuts.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace fettle::app {
namespace {

using render::Key;
using render::letter;
using render::Modifiers;

constexpr Modifiers kPlain{};
constexpr Modifiers kControl{true, false, false};
constexpr Modifiers kShift{false, true, false};
constexpr Modifiers kAlt{false, false, true};
constexpr Modifiers kControlShift{true, true, false};

constexpr Key keypad(int digit) {
  return static_cast<Key>(static_cast<int>(Key::kKeypad0) + digit);
}
constexpr Key function(int n) {
  return static_cast<Key>(static_cast<int>(Key::kF1) + n - 1);
}

constexpr std::array kShortcuts{
    Shortcut{Action::kOpen, "File", "Open a scan", letter('O'), kControl},
    Shortcut{Action::kSave, "File", "Save", letter('S'), kControl},
    Shortcut{Action::kSaveAs, "File", "Save as", letter('S'), kControlShift},
    Shortcut{Action::kExport, "File", "Export", letter('E'), kControl},
    Shortcut{Action::kQuit, "File", "Quit", letter('Q'), kControl},
    Shortcut{Action::kUndo, "Edit", "Undo", letter('Z'), kControl},
    Shortcut{Action::kRedo, "Edit", "Redo", letter('Z'), kControlShift},
    Shortcut{Action::kNavigate, "Tool", "End the tool: the mouse moves the view", Key::kEscape, kPlain},
    Shortcut{Action::kFeel, "Tool", "Feel", letter('T'), kPlain},
    Shortcut{Action::kSmooth, "Tool", "Smooth", letter('S'), kPlain},
    Shortcut{Action::kMark, "Tool", "Mark: keep from filters", letter('M'), kPlain},
    Shortcut{Action::kUnmark, "Tool", "Unmark", letter('U'), kPlain},
    Shortcut{Action::kBrushRadius, "Tool", "Brush radius, then move or type", letter('F'), kPlain},
    Shortcut{Action::kBrushStrength, "Tool", "Press depth, then move or type", letter('F'), kShift},
    Shortcut{Action::kBrushSmaller, "Tool", "Smaller brush", Key::kLeftBracket, kPlain, Key::kComma},
    Shortcut{Action::kBrushLarger, "Tool", "Larger brush", Key::kRightBracket, kPlain, Key::kPeriod},
    Shortcut{Action::kInvert, "Tool", "Turn the field upside down", letter('I'), kPlain},
    Shortcut{Action::kKeepWithin, "Tool", "Keep strokes within a largest change", letter('X'), kShift},
    Shortcut{Action::kShowMarks, "Tool", "Show or hide marks", letter('H'), kPlain},
    Shortcut{Action::kClearMarks, "Marks", "Clear all marks", letter('M'), kAlt},
    Shortcut{Action::kInvertMarks, "Marks", "Invert marks", letter('I'), kControl},
    Shortcut{Action::kLasso, "Marks", "Mark inside a line (Ctrl: unmark)", letter('L'), kPlain},
    Shortcut{Action::kBox, "Marks", "Mark inside a box (Ctrl: unmark)", letter('B'), kPlain},
    Shortcut{Action::kEdges, "Marks", "Suggest edges", letter('E'), kPlain},
    Shortcut{Action::kEdgesMore, "Marks", "Suggest more edges", Key::kRightBracket, kControl, Key::kPeriod},
    Shortcut{Action::kEdgesFewer, "Marks", "Suggest fewer edges", Key::kLeftBracket, kControl, Key::kComma},
    Shortcut{Action::kEdgesThicker, "Marks", "Thicker edges", Key::kRightBracket, kAlt, Key::kPeriod},
    Shortcut{Action::kEdgesThinner, "Marks", "Thinner edges", Key::kLeftBracket, kAlt, Key::kComma},
    Shortcut{Action::kEdgesCoarser, "Marks", "Look for edges at a larger scale", Key::kRightBracket,
             kControlShift, Key::kPeriod},
    Shortcut{Action::kEdgesFiner, "Marks", "Look for edges at a smaller scale", Key::kLeftBracket,
             kControlShift, Key::kComma},
    Shortcut{Action::kFilterNext, "Filter", "Next filter", letter('N'), kPlain},
    Shortcut{Action::kFilterPreview, "Filter", "Preview", letter('P'), kPlain},
    Shortcut{Action::kFilterBeside, "Filter", "Preview beside the others", letter('V'), kPlain},
    Shortcut{Action::kFilterDrop, "Filter", "Drop the newest preview", letter('V'), kShift, Key::kDelete},
    Shortcut{Action::kWindowLarger, "Filter", "Larger window", letter('W'), kPlain},
    Shortcut{Action::kWindowSmaller, "Filter", "Smaller window", letter('W'), kShift},
    Shortcut{Action::kMorePasses, "Filter", "One more pass", letter('R'), kPlain},
    Shortcut{Action::kFewerPasses, "Filter", "One pass less", letter('R'), kShift},
    Shortcut{Action::kFilterScope, "Filter", "Around the marks, or only them", letter('O'), kPlain},
    Shortcut{Action::kFilterMaxChange, "Filter", "Within a largest change, or without", letter('X'), kPlain},
    Shortcut{Action::kFilterApply, "Filter", "Apply; take suggested edges", Key::kEnter, kPlain,
             Key::kKeypadEnter},
    Shortcut{Action::kSplitPreview, "Filter", "Split line or side by side", letter('P'), kShift},
    Shortcut{Action::kSplitLeft, "Filter", "Split line to the left", Key::kLeft, kControl},
    Shortcut{Action::kSplitRight, "Filter", "Split line to the right", Key::kRight, kControl},
    Shortcut{Action::kDeviation, "View", "Colours show the change since the scan", letter('D'), kPlain},
    Shortcut{Action::kContours, "View", "Contour lines", letter('C'), kPlain},
    Shortcut{Action::kNextMap, "View", "Next colour map", letter('K'), kPlain},
    Shortcut{Action::kStereo, "View", "One eye, two side by side, red-cyan glasses", letter('G'), kShift},
    Shortcut{Action::kTheme, "View", "Light or dark background", letter('G'), kPlain},
    Shortcut{Action::kFurniture, "View", "Scale bar and colour bar", letter('J'), kPlain},
    Shortcut{Action::kLightLeft, "View", "Light from further left", Key::kLeft, kAlt},
    Shortcut{Action::kLightRight, "View", "Light from further right", Key::kRight, kAlt},
    Shortcut{Action::kLightHigher, "View", "Light from higher up", Key::kUp, kAlt},
    Shortcut{Action::kLightLower, "View", "Light from lower down", Key::kDown, kAlt},
    Shortcut{Action::kMouseHabits, "View", "Mouse as in Blender, CloudCompare, MeshLab", letter('M'), kShift},
    Shortcut{Action::kViewAll, "View", "Whole field", Key::kHome, kPlain},
    Shortcut{Action::kViewLastStroke, "View", "Centre on the last stroke", Key::kKeypadPeriod, kPlain,
             letter('0')},
    Shortcut{Action::kViewFront, "View", "From the front", keypad(1), kPlain, letter('1')},
    Shortcut{Action::kViewBack, "View", "From the back", keypad(1), kControl},
    Shortcut{Action::kViewRight, "View", "From the right", keypad(3), kPlain, letter('3')},
    Shortcut{Action::kViewLeft, "View", "From the left", keypad(3), kControl},
    Shortcut{Action::kViewTop, "View", "From above, like a map", keypad(7), kPlain, letter('7')},
    Shortcut{Action::kProjection, "View", "Perspective or parallel", keypad(5), kPlain, letter('5')},
    Shortcut{Action::kTurnLeft, "View", "Turn left", Key::kLeft, kPlain},
    Shortcut{Action::kTurnRight, "View", "Turn right", Key::kRight, kPlain},
    Shortcut{Action::kTiltUp, "View", "Tilt up", Key::kUp, kPlain},
    Shortcut{Action::kTiltDown, "View", "Tilt down", Key::kDown, kPlain},
    Shortcut{Action::kPanLeft, "View", "Move left", Key::kLeft, kShift},
    Shortcut{Action::kPanRight, "View", "Move right", Key::kRight, kShift},
    Shortcut{Action::kPanUp, "View", "Move up", Key::kUp, kShift},
    Shortcut{Action::kPanDown, "View", "Move down", Key::kDown, kShift},
    Shortcut{Action::kZoomIn, "View", "Nearer", Key::kPageUp, kPlain, Key::kKeypadPlus},
    Shortcut{Action::kZoomOut, "View", "Farther", Key::kPageDown, kPlain, Key::kKeypadMinus},
    Shortcut{Action::kSidePanel, "View", "Show or hide the panels", Key::kTab, kPlain},
    Shortcut{Action::kEnterPanels, "View", "Into the panels by keyboard (Esc leaves)", function(6), kPlain},
    Shortcut{Action::kArm, "Device", "Arm: allow force", letter('A'), kPlain},
    Shortcut{Action::kDisarm, "Device", "Disarm (Pause too, even while typing)", letter('A'), kShift},
    Shortcut{Action::kCalibrate, "Device", "Calibrate in the home pose", letter('A'), kControlShift},
    Shortcut{Action::kShortcuts, "Help", "This list", function(1), kPlain},
};

}  // namespace

std::span<const Shortcut> shortcuts() {
  return kShortcuts;
}

const Shortcut& shortcutOf(Action action) {
  return *std::find_if(kShortcuts.begin(), kShortcuts.end(),
                       [&](const Shortcut& s) { return s.action == action; });
}

std::optional<Action> actionOf(Key key, Modifiers modifiers) {
  if (key == Key::kNone) return std::nullopt;
  for (const Shortcut& s : kShortcuts)
    if ((s.key == key || s.other_key == key) && s.modifiers == modifiers) return s.action;
  return std::nullopt;
}

bool disarms(Key key, Modifiers modifiers, Typing typing) {
  if (key == Key::kPause) return true;
  return typing == Typing::kNo && actionOf(key, modifiers) == Action::kDisarm;
}

std::string keyText(Key key, Modifiers modifiers) {
  std::string text;
  if (modifiers.control) text += "Ctrl+";
  if (modifiers.shift) text += "Shift+";
  if (modifiers.alt) text += "Alt+";
  const int code = static_cast<int>(key);
  if (code > 32 && code < 127) return text + static_cast<char>(code);
  if (key >= keypad(0) && key <= keypad(9))
    return text + fmt::format("keypad {}", code - static_cast<int>(keypad(0)));
  if (key >= function(1) && key <= function(12))
    return text + fmt::format("F{}", code - static_cast<int>(function(1)) + 1);
  switch (key) {
    case Key::kSpace:
      return text + "Space";
    case Key::kEscape:
      return text + "Esc";
    case Key::kEnter:
      return text + "Enter";
    case Key::kTab:
      return text + "Tab";
    case Key::kBackspace:
      return text + "Backspace";
    case Key::kDelete:
      return text + "Delete";
    case Key::kInsert:
      return text + "Insert";
    case Key::kLeft:
      return text + "Left";
    case Key::kRight:
      return text + "Right";
    case Key::kUp:
      return text + "Up";
    case Key::kDown:
      return text + "Down";
    case Key::kHome:
      return text + "Home";
    case Key::kEnd:
      return text + "End";
    case Key::kPageUp:
      return text + "Page up";
    case Key::kPageDown:
      return text + "Page down";
    case Key::kKeypadPeriod:
      return text + "keypad .";
    case Key::kKeypadPlus:
      return text + "keypad +";
    case Key::kKeypadMinus:
      return text + "keypad -";
    case Key::kKeypadEnter:
      return text + "keypad Enter";
    case Key::kPause:
      return text + "Pause";
    default:
      return text;
  }
}

}  // namespace fettle::app
