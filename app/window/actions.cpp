#include "app/window/actions.h"

#include "app/window/action_steps.h"
#include "app/window/view_steps.h"
#include "engine/base/rows.h"

namespace fettle::app {
namespace {

using render::Key;
using render::letter;
using render::Modifiers;
using namespace steps;
using enum Needs;

constexpr Modifiers kPlain{};
constexpr Modifiers kControl{true, false, false};
constexpr Modifiers kShift{false, true, false};
constexpr Modifiers kAlt{false, false, true};
constexpr Modifiers kControlShift{true, true, false};
constexpr Key kNoKey = Key::kNone;
// Groups of the section's own menu, except for one.
constexpr MenuPlace kNoMenu{}, kFirst{1}, kSecond{2}, kThird{3}, kMarksMenu{3, "Marks"},
    kRecalled{1, "Bookmarks"}, kSet{2, "Bookmarks"};

template <Tool tool>
constexpr ActionRow toolRow(Key key) {
  return {actionOf(tool), "Tool",      haptic::rowOf(tool).hint, key, kPlain, kNoKey, kFirst, kField,
          choose<tool>,   chosen<tool>};
}

template <std::size_t number>
constexpr ActionRow bookmarkRow(std::string_view name) {
  return {static_cast<Action>(static_cast<std::size_t>(Action::kBookmark1) + number),
          "View",
          name,
          functionKey(static_cast<int>(number) + 2),
          kPlain,
          kNoKey,
          kRecalled,
          kField,
          recallBookmark<number>,
          nullptr,
          hasBookmark<number>};
}
template <std::size_t number>
constexpr ActionRow setBookmarkRow(std::string_view name) {
  return {static_cast<Action>(static_cast<std::size_t>(Action::kSetBookmark1) + number),
          "View",
          name,
          functionKey(static_cast<int>(number) + 2),
          kShift,
          kNoKey,
          kSet,
          kField,
          setBookmark<number>};
}

constexpr ActionRow kRows[] = {
    ActionRow{Action::kOpen, "File", "Open a scan", letter('O'), kControl, kNoKey, kFirst, kNothing,
              openScan},
    ActionRow{Action::kReadAs, "File", "Read this scan with another unit, spacing or scale", letter('O'),
              kControlShift, kNoKey, kFirst, kField, readAs},
    ActionRow{Action::kJoin, "File", "Join another scan to this one", letter('J'), kAlt, kNoKey, kFirst,
              kField, joinScan},
    ActionRow{Action::kSave, "File", "Save", letter('S'), kControl, kNoKey, kSecond, kField, save},
    ActionRow{Action::kSaveAs, "File", "Save as", letter('S'), kControlShift, kNoKey, kSecond, kField,
              saveAs},
    ActionRow{Action::kExport, "File", "Export", letter('E'), kControl, kNoKey, kSecond, kField, exportField},
    ActionRow{Action::kOpenScene, "File", "Open a scene: what is felt", letter('O'), kAlt, kNoKey, kSecond,
              kField, openScene},
    ActionRow{Action::kSaveScene, "File", "Save the scene", letter('S'), kAlt, kNoKey, kSecond, kField,
              saveScene},
    ActionRow{Action::kExportSections, "File", "Export sections", letter('E'), kControlShift, kNoKey, kSecond,
              kField, askForFile<Question::Kind::kExportSections>, nullptr, hasSection},
    ActionRow{Action::kExportReport, "File", "Export a report", letter('E'), kAlt, kNoKey, kSecond, kField,
              askForFile<Question::Kind::kExportReport>},
    ActionRow{Action::kQuit, "File", "Quit", letter('Q'), kControl, kNoKey, kThird, kNothing, quit},

    ActionRow{Action::kUndo, "Edit", "Undo", letter('Z'), kControl, kNoKey, kFirst, kField, undo, nullptr,
              canUndo},
    ActionRow{Action::kRedo, "Edit", "Redo", letter('Z'), kControlShift, letter('Y'), kFirst, kField, redo,
              nullptr, canRedo, kControl},

    ActionRow{Action::kNavigate, "Tool", "End the tool: the mouse moves the view", Key::kEscape, kPlain,
              kNoKey, kFirst, kField, navigate, navigates},
    toolRow<Tool::kFeel>(letter('T')),
    toolRow<Tool::kSmooth>(letter('S')),
    toolRow<Tool::kMark>(letter('M')),
    toolRow<Tool::kUnmark>(letter('U')),
    ActionRow{Action::kRadialMenu, "Tool", "Tools and tips around the cursor: hold, point, release",
              RadialMenu::kKey, kPlain, kNoKey, kFirst, kField, openRadialMenu},
    ActionRow{Action::kPointTip, "Tool", "Feel with a point", letter('T'), kAlt, kNoKey, kFirst, kField,
              chooseTip<haptic::TipShape::kPoint>, hasTip<haptic::TipShape::kPoint>},
    ActionRow{Action::kBallTip, "Tool", "Feel with a ball", letter('T'), kShift, kNoKey, kFirst, kField,
              chooseTip<haptic::TipShape::kSphere>, hasTip<haptic::TipShape::kSphere>},
    ActionRow{Action::kBrushRadius, "Tool", "Brush radius, then move or type", letter('F'), kPlain, kNoKey,
              kSecond, kField, adjustBrush<BrushAdjustment::Of::kRadius>},
    ActionRow{Action::kBrushStrength, "Tool", "Press depth, then move or type", letter('F'), kShift, kNoKey,
              kSecond, kField, adjustBrush<BrushAdjustment::Of::kDepth>},
    ActionRow{Action::kBrushSmaller, "Tool", "Smaller brush", Key::kLeftBracket, kPlain, Key::kComma, kSecond,
              kField, resizeBrush<-1>},
    ActionRow{Action::kBrushLarger, "Tool", "Larger brush", Key::kRightBracket, kPlain, Key::kPeriod, kSecond,
              kField, resizeBrush<1>},
    ActionRow{Action::kInvert, "Tool", "Turn the field upside down", letter('I'), kPlain, kNoKey, kSecond,
              kField, invert, isInverted},
    ActionRow{Action::kKeepWithin, "Tool", "Keep strokes within a limit of the scan", letter('X'), kShift,
              kNoKey, kSecond, kField, keepWithin, keepsWithin},
    ActionRow{Action::kShowMarks, "Tool", "Show or hide marks", letter('H'), kPlain, kNoKey, kMarksMenu,
              kField, toggle<&Display::marks>, isOn<&Display::marks>},

    ActionRow{Action::kClearMarks, "Marks", "Clear all marks", letter('M'), kAlt, kNoKey, kThird, kField,
              clearMarks},
    ActionRow{Action::kInvertMarks, "Marks", "Invert marks", letter('I'), kControl, kNoKey, kThird, kField,
              invertMarks},
    ActionRow{Action::kRemoveMarked, "Marks", "Remove marked samples", Key::kDelete, kControl, kNoKey, kThird,
              kField, removeMarked},
    ActionRow{Action::kDrawLines, "Marks", "Strokes of the mark tool become edge lines", letter('E'), kShift,
              kNoKey, kSecond, kField, toggleLines, drawsLines},
    ActionRow{Action::kNextLine, "Marks", "Choose the next edge line", letter('Y'), kPlain, kNoKey, kSecond,
              kField, nextLine, nullptr, hasLines},
    ActionRow{Action::kRemoveLine, "Marks", "Remove the chosen edge line", letter('Y'), kShift, kNoKey,
              kSecond, kField, removeLine, nullptr, hasChosenLine},
    ActionRow{Action::kJoinLine, "Marks", "Join the chosen edge line with the nearest end", letter('Y'),
              kControlShift, kNoKey, kSecond, kField, joinLine, nullptr, hasChosenLine},
    ActionRow{Action::kClearLines, "Marks", "Remove all edge lines", letter('Y'), kAlt, kNoKey, kSecond,
              kField, clearLines, nullptr, hasLines},
    ActionRow{Action::kNextPlace, "Marks", "Go to the next place where a line is worth most", letter('Z'),
              kPlain, kNoKey, kSecond, kField, nextPlace},
    ActionRow{Action::kHidePlaces, "Marks", "Hide these places", letter('Z'), kShift, kNoKey, kSecond, kField,
              hidePlaces, nullptr, hasPlaces},
    ActionRow{Action::kLasso, "Marks", "Mark inside a line (Ctrl: unmark)", letter('L'), kPlain, kNoKey,
              kFirst, kField, lasso<Lasso::Shape::kFree>, isLasso<Lasso::Shape::kFree>},
    ActionRow{Action::kBox, "Marks", "Mark inside a box (Ctrl: unmark)", letter('B'), kPlain, kNoKey, kFirst,
              kField, lasso<Lasso::Shape::kBox>, isLasso<Lasso::Shape::kBox>},
    ActionRow{Action::kEdges, "Marks", "Suggest edges", letter('E'), kPlain, kNoKey, kSecond, kField,
              suggestEdges},
    ActionRow{Action::kEdgesMore, "Marks", "Suggest more edges", Key::kRightBracket, kControl, Key::kPeriod,
              kSecond, kField, sensitivity<1>},
    ActionRow{Action::kEdgesFewer, "Marks", "Suggest fewer edges", Key::kLeftBracket, kControl, Key::kComma,
              kSecond, kField, sensitivity<-1>},
    ActionRow{Action::kEdgesThicker, "Marks", "Thicker edges", Key::kRightBracket, kAlt, Key::kPeriod,
              kSecond, kField, thickness<1>},
    ActionRow{Action::kEdgesThinner, "Marks", "Thinner edges", Key::kLeftBracket, kAlt, Key::kComma, kSecond,
              kField, thickness<-1>},
    ActionRow{Action::kEdgesCoarser, "Marks", "Look for edges at a larger scale", Key::kRightBracket,
              kControlShift, Key::kPeriod, kSecond, kField, coarserEdges},
    ActionRow{Action::kEdgesFiner, "Marks", "Look for edges at a smaller scale", Key::kLeftBracket,
              kControlShift, Key::kComma, kSecond, kField, finerEdges},

    ActionRow{Action::kFilterSuggest, "Filter", "Suggest a filter for this scan", letter('F'), kControl,
              kNoKey, kFirst, kField, suggestFilters},
    ActionRow{Action::kFilterNext, "Filter", "Next filter", letter('N'), kPlain, kNoKey, kFirst, kField,
              nextFilter},
    ActionRow{Action::kFilterPreview, "Filter", "Preview", letter('P'), kPlain, kNoKey, kSecond, kField,
              preview<FilterPreview::Keep::kReplace>},
    ActionRow{Action::kFilterAdd, "Filter", "Preview next to the others", letter('V'), kPlain, kNoKey,
              kSecond, kField, preview<FilterPreview::Keep::kAdd>},
    ActionRow{Action::kFilterDrop, "Filter", "Drop the newest preview", letter('V'), kShift, Key::kDelete,
              kSecond, kField, dropPreview, nullptr, hasPreview},
    ActionRow{Action::kWindowLarger, "Filter", "Larger window", letter('W'), kPlain, kNoKey, kFirst, kField,
              window<2>},
    ActionRow{Action::kWindowSmaller, "Filter", "Smaller window", letter('W'), kShift, kNoKey, kFirst, kField,
              window<-2>},
    ActionRow{Action::kMorePasses, "Filter", "One more pass", letter('R'), kPlain, kNoKey, kFirst, kField,
              passes<1>},
    ActionRow{Action::kFewerPasses, "Filter", "One pass less", letter('R'), kShift, kNoKey, kFirst, kField,
              passes<-1>},
    ActionRow{Action::kFilterScope, "Filter", "Around the marks, or only them", letter('O'), kPlain, kNoKey,
              kFirst, kField, changeScope, onlyMarks},
    ActionRow{Action::kFilterMaxChange, "Filter", "Keep the filter within a limit of the scan", letter('X'),
              kPlain, kNoKey, kFirst, kField, limitFilter, filterIsLimited},
    ActionRow{Action::kFilterApply, "Filter", "Apply; take suggested edges", Key::kEnter, kPlain,
              Key::kKeypadEnter, kSecond, kField, apply, nullptr, canApply},
    ActionRow{Action::kSplitPreview, "Filter", "Split line or side by side", letter('P'), kShift, kNoKey,
              kSecond, kField, toggle<&Display::split>, isOn<&Display::split>},
    ActionRow{Action::kSplitLeft, "Filter", "Split line to the left", Key::kLeft, kControl, kNoKey, kNoMenu,
              kField, moveSplit<-1>},
    ActionRow{Action::kSplitRight, "Filter", "Split line to the right", Key::kRight, kControl, kNoKey,
              kNoMenu, kField, moveSplit<1>},
    ActionRow{Action::kPlanePoints, "Filter", "Plane through three points of the surface", letter('D'), kAlt,
              kNoKey, kThird, kField, beginPlanePoints, expectsPlanePoint},
    ActionRow{Action::kPlanePoint, "Filter", "Set the next of these points at the cursor", letter('D'),
              kShift, kNoKey, kNoMenu, kField, setPlanePoint},
    ActionRow{Action::kFormPreview, "Filter", "Colours show what is left without the form", letter('L'),
              kControlShift, kNoKey, kThird, kField, formPreview, formIsPreviewed},
    ActionRow{Action::kFormOut, "Filter", "Take the form out of what is seen", letter('L'), kShift, kNoKey,
              kThird, kField, formOut},
    ActionRow{Action::kFormBack, "Filter", "Put the form back", letter('L'), kControl, kNoKey, kThird, kField,
              formBack, nullptr, hasForm},
    ActionRow{Action::kFormHeights, "Filter", "Make what is seen without the form the heights", letter('L'),
              kAlt, kNoKey, kThird, kField, formHeights, nullptr, hasForm},
    ActionRow{Action::kRemoveOpen,
              "Filter",
              "Remove samples by height or mark ...",
              letter('X'),
              kAlt,
              kNoKey,
              {2, "Edit"},
              kField,
              openRemoval},
    ActionRow{Action::kRemovePreview, "Filter", "Preview samples removed by height or mark", letter('X'),
              kControl, kNoKey, kThird, kField, previewHeights<&HeightTool::remove>,
              heightsArePreviewed<&HeightTool::remove>},
    ActionRow{Action::kRemoveSamples, "Filter", "Remove samples by height or mark", letter('X'),
              kControlShift, kNoKey, kThird, kField, computeHeights<&HeightTool::removeSamples>},
    ActionRow{Action::kFillPreview, "Filter", "Preview filled holes", letter('H'), kControl, kNoKey, kThird,
              kField, previewHeights<&HeightTool::fill>, heightsArePreviewed<&HeightTool::fill>},
    ActionRow{Action::kFillHoles, "Filter", "Fill holes from their rim", letter('H'), kAlt, kNoKey, kThird,
              kField, computeHeights<&HeightTool::fillHoles>},
    ActionRow{Action::kLevelPreview, "Filter", "Preview levelled lines", letter('R'), kControl, kNoKey,
              kThird, kField, previewHeights<&HeightTool::lines>, heightsArePreviewed<&HeightTool::lines>},
    ActionRow{Action::kLevelLines, "Filter", "Level the lines of a line scanner", letter('R'), kAlt, kNoKey,
              kThird, kField, computeHeights<&HeightTool::levelLines>},
    ActionRow{Action::kFitShapes, "Filter", "Fit a plane, sphere, cylinder, cone or torus", letter('F'),
              kControlShift, kNoKey, kThird, kField, fitShapes},
    ActionRow{Action::kExportFits,
              "Filter",
              "Export the fits",
              letter('F'),
              kAlt,
              kNoKey,
              {2, "File"},
              kField,
              askForFile<Question::Kind::kExportFits>,
              nullptr,
              hasFits},
    ActionRow{Action::kFindFeatures, "Filter", "Find hills or dales", letter('H'), kControlShift, kNoKey,
              kThird, kField, findFeatures},
    ActionRow{Action::kExportFeatures,
              "Filter",
              "Export the features",
              letter('W'),
              kAlt,
              kNoKey,
              {2, "File"},
              kField,
              askForFile<Question::Kind::kExportFeatures>,
              nullptr,
              hasFeatures},
    ActionRow{Action::kSectionFrom, "Filter", "Section from the cursor", letter('Q'), kPlain, kNoKey, kThird,
              kField, sectionEnd<&SectionTool::setFrom>},
    ActionRow{Action::kSectionTo, "Filter", "Section to the cursor", letter('Q'), kShift, kNoKey, kThird,
              kField, sectionEnd<&SectionTool::setTo>},
    ActionRow{Action::kSectionNew, "Filter", "Another section: its ends come next", letter('Q'), kAlt, kNoKey,
              kThird, kField, withSection<&SectionTool::beginNew>, nullptr, hasSection},
    ActionRow{Action::kSectionNext, "Filter", "The next section", letter('Q'), kControlShift, kNoKey, kThird,
              kField, withSection<&SectionTool::next>, nullptr, hasSection},

    ActionRow{Action::kCompare, "View", "Compare with another scan, brought onto this one", letter('B'), kAlt,
              kNoKey, kFirst, kField, compareWithScan},
    ActionRow{Action::kCompareAgain, "View", "Compare with the same scan again", letter('B'), kControlShift,
              kNoKey, kFirst, kField, compareAgain, nullptr, hasCompared},
    ActionRow{Action::kShowBefore, "View", "The scan as it was, while the key is held", Key::kBackspace,
              kPlain, kNoKey, kFirst, kField, showBefore, showsBefore},
    ActionRow{Action::kDeviation, "View", "Colours show the change since the scan", letter('D'), kPlain,
              kNoKey, kFirst, kField, deviation, isOn<&Display::deviation>},
    ActionRow{Action::kContours, "View", "Contour lines", letter('C'), kPlain, kNoKey, kFirst, kField,
              toggle<&Display::contours>, isOn<&Display::contours>},
    ActionRow{Action::kNextMap, "View", "Next colour map", letter('K'), kPlain, kNoKey, kFirst, kField,
              nextMap},
    ActionRow{Action::kStereo, "View", "One eye, two side by side, red-cyan glasses", letter('G'), kShift,
              kNoKey, kFirst, kField, stereo, isStereo},
    ActionRow{Action::kTheme, "View", "Light or dark background", letter('G'), kPlain, kNoKey, kFirst,
              kNothing, theme, isLight, hasField},
    ActionRow{Action::kPanelsTheme, "View", "Light or dark panels", letter('G'), kAlt, kNoKey, kFirst,
              kNothing, panelsTheme, panelsAreLight},
    ActionRow{Action::kDecorations, "View", "Scale bar and colour bar", letter('J'), kPlain, kNoKey, kFirst,
              kNothing, toggle<&Display::decorations>, isOn<&Display::decorations>, hasField},
    ActionRow{Action::kAxes, "View", "Axes; a click on an end looks from there", letter('J'), kShift, kNoKey,
              kFirst, kNothing, toggle<&Display::axes>, isOn<&Display::axes>, hasField},
    ActionRow{Action::kLightLeft, "View", "Light from further left", Key::kLeft, kAlt, kNoKey, kNoMenu,
              kField, turnLight<10>},
    ActionRow{Action::kLightRight, "View", "Light from further right", Key::kRight, kAlt, kNoKey, kNoMenu,
              kField, turnLight<350>},
    ActionRow{Action::kLightHigher, "View", "Light from higher up", Key::kUp, kAlt, kNoKey, kNoMenu, kField,
              liftLight<5>},
    ActionRow{Action::kLightLower, "View", "Light from lower down", Key::kDown, kAlt, kNoKey, kNoMenu, kField,
              liftLight<-5>},
    ActionRow{Action::kMouseHabits, "View", "Mouse as in Blender, CloudCompare, MeshLab, MeshLib",
              letter('M'), kShift, kNoKey, kNoMenu, kNothing, mouseHabits},
    ActionRow{Action::kViewAll, "View", "Whole field", Key::kHome, kPlain, kNoKey, kSecond, kPicture,
              viewAll},
    ActionRow{Action::kViewLastStroke, "View", "Centre on the last stroke", Key::kKeypadPeriod, kPlain,
              letter('0'), kSecond, kField, lastStroke},
    ActionRow{Action::kViewFront, "View", "From the front", keypadKey(1), kPlain, letter('1'), kSecond,
              kPicture, look<0, 0>},
    ActionRow{Action::kViewBack, "View", "From the back", keypadKey(1), kControl, kNoKey, kSecond, kPicture,
              look<180, 0>},
    ActionRow{Action::kViewRight, "View", "From the right", keypadKey(3), kPlain, letter('3'), kSecond,
              kPicture, look<90, 0>},
    ActionRow{Action::kViewLeft, "View", "From the left", keypadKey(3), kControl, kNoKey, kSecond, kPicture,
              look<270, 0>},
    ActionRow{Action::kViewTop, "View", "From above, like a map", keypadKey(7), kPlain, letter('7'), kSecond,
              kPicture, look<0, 90>},
    bookmarkRow<0>("Bookmark 1"),
    bookmarkRow<1>("Bookmark 2"),
    bookmarkRow<2>("Bookmark 3"),
    bookmarkRow<3>("Bookmark 4"),
    setBookmarkRow<0>("Set bookmark 1"),
    setBookmarkRow<1>("Set bookmark 2"),
    setBookmarkRow<2>("Set bookmark 3"),
    setBookmarkRow<3>("Set bookmark 4"),
    ActionRow{Action::kProjection, "View", "Perspective or parallel", keypadKey(5), kPlain, letter('5'),
              kSecond, kPicture, projection},
    ActionRow{Action::kTurnLeft, "View", "Turn left", Key::kLeft, kPlain, kNoKey, kNoMenu, kPicture,
              turn<-1, 0>},
    ActionRow{Action::kTurnRight, "View", "Turn right", Key::kRight, kPlain, kNoKey, kNoMenu, kPicture,
              turn<1, 0>},
    ActionRow{Action::kTiltUp, "View", "Tilt up", Key::kUp, kPlain, kNoKey, kNoMenu, kPicture, turn<0, 1>},
    ActionRow{Action::kTiltDown, "View", "Tilt down", Key::kDown, kPlain, kNoKey, kNoMenu, kPicture,
              turn<0, -1>},
    ActionRow{Action::kPanLeft, "View", "Move left", Key::kLeft, kShift, kNoKey, kNoMenu, kPicture,
              pan<1, 0>},
    ActionRow{Action::kPanRight, "View", "Move right", Key::kRight, kShift, kNoKey, kNoMenu, kPicture,
              pan<-1, 0>},
    ActionRow{Action::kPanUp, "View", "Move up", Key::kUp, kShift, kNoKey, kNoMenu, kPicture, pan<0, 1>},
    ActionRow{Action::kPanDown, "View", "Move down", Key::kDown, kShift, kNoKey, kNoMenu, kPicture,
              pan<0, -1>},
    ActionRow{Action::kZoomIn, "View", "Nearer", Key::kPageUp, kPlain, Key::kKeypadPlus, kSecond, kPicture,
              zoom<2>},
    ActionRow{Action::kZoomOut, "View", "Farther", Key::kPageDown, kPlain, Key::kKeypadMinus, kSecond,
              kPicture, zoom<-2>},
    ActionRow{Action::kSidePanel, "View", "Show or hide the panels", Key::kTab, kPlain, kNoKey, kThird,
              kNothing, sidePanel, hasSidePanel},
    ActionRow{Action::kFullScreen, "View", "Full screen, the picture alone", functionKey(11), kPlain, kNoKey,
              kThird, kNothing, fullScreen, isFullScreen},
    ActionRow{Action::kEnterPanels, "View", "Into the panels by keyboard (Esc leaves)", functionKey(6),
              kPlain, kNoKey, kThird, kNothing, enterPanels, nullptr, hasField},
    ActionRow{Action::kUnderstood, "View", "Take the notices away", letter('N'), kAlt, kNoKey, kThird,
              kNothing, takeNoticesAway, nullptr, hasNotices},

    ActionRow{Action::kArm, "Device", "Arm: allow force", letter('A'), kPlain, kNoKey, kFirst, kField, arm},
    ActionRow{Action::kDisarm, "Device", "Disarm (Pause too, even while typing)", letter('A'), kShift, kNoKey,
              kFirst, kField, disarm},
    ActionRow{Action::kCalibrate, "Device", "Calibrate in the home pose", letter('A'), kControlShift, kNoKey,
              kFirst, kField, calibrate},
    ActionRow{Action::kSetUpDevice, "Device", "Set up: reach, rest, directions, motion", letter('D'),
              kControlShift, kNoKey, kSecond, kField, setUpDevice},
    ActionRow{Action::kShortcuts, "Help", "This list", functionKey(1), kPlain, kNoKey, kFirst, kNothing,
              listShortcuts},
};

static_assert(engine::inOrder(kRows, &ActionRow::action, Action::kCount));

}  // namespace

std::span<const ActionRow> actions() {
  return kRows;
}

const ActionRow& rowOf(Action action) {
  return kRows[static_cast<std::size_t>(action)];
}

bool ready(const ActionRow& row, const Parts& parts) {
  switch (row.needs) {
    case kField:
      return parts.document.isOpen();
    case kPicture:
      return parts.seenGrid() != nullptr;
    case kNothing:
      break;
  }
  return true;
}

void carryOut(Action action, Parts& parts) {
  parts.picture.requestRedraw();
  if (const ActionRow& row = rowOf(action); ready(row, parts)) row.carry_out(parts);
}

std::optional<Action> actionOf(Key key, Modifiers modifiers) {
  if (key == Key::kNone) return std::nullopt;
  for (const ActionRow& row : kRows)
    if ((row.key == key && row.modifiers == modifiers) ||
        (row.other_key == key && row.modifiersOfOther() == modifiers))
      return row.action;
  return std::nullopt;
}

bool disarms(Key key, Modifiers modifiers, Typing typing) {
  if (key == Key::kPause) return true;
  return typing == Typing::kNo && actionOf(key, modifiers) == Action::kDisarm;
}

}  // namespace fettle::app
