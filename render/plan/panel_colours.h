#pragma once

#include <cstdint>
#include <span>

#include "render/plan/picture.h"

namespace fettle::render {

/// What a colour of the panels means. Each has one for light and one for dark panels; everything that panels, dialogs and what
/// lies over the picture are drawn with is one of these, or a colour of the field's values.
enum class PanelColour : std::uint8_t {
  // Grounds.
  kBehind,  ///< where there is no panel and no picture yet
  kPanel,
  kPopup,  ///< dialogs, menus, tips
  kBar,    ///< of the menus
  kTitle,  ///< of a dialog
  kField,
  kFieldPointed,
  kFieldHeld,
  kButton,
  kButtonPointed,
  kButtonHeld,  ///< or switched on
  kRow,         ///< a section of the panels, the chosen entry of a list
  kRowPointed,
  kRowHeld,
  kOtherRow,   ///< every second one of a table
  kTableHead,  ///< its first one
  kSelection,  ///< of a text
  kShade,      ///< over everything under a dialog
  kChart,      ///< of a section, as in the plots of fettle section
  kPlate,      ///< of a name around the cursor, over any picture
  kRing,       ///< around the cursor, over any picture
  // Texts.
  kText,
  kMuted,    ///< said by the way, or not yet
  kWarning,  ///< to be known
  kProblem,  ///< something did not work, or is not as expected
  kGood,     ///< is as expected
  // Lines and marks.
  kTick,  ///< what is on, or pointed at
  kGrab,  ///< of a slider
  kGrabHeld,
  kProgress,  ///< how much is done; a curve filled below
  kCurve,
  kBorder,  ///< of fields, buttons and parts
  kScrollTrack,
  kScrollGrab,
  kHandle,  ///< of the ends of the colours, over bars of any colour, with its rim
  kHandleRim,
  kOutline,  ///< of bars that have the colours of the values
  kLower,    ///< bars of changes: blue, as on the surface
  kHigher,   ///< red
  kProfile,  ///< of a section alone
  kProfileNow,
  kProfileBefore,
  kCursors,
  kOtherCursors,  ///< of the second stretch of an angle
  kStretch,       ///< between cursors
  // Over any picture, the same on all panels.
  kAxisX,
  kAxisY,
  kAxisZ,
  kAxisLetter,
  kAxisPointed,
  kAxisHollow,  ///< of the ends below zero, under letters of the axes' colours
  kLasso,
  kLassoRim,
  kSplitHandle,
  kCount,
};

/// sRGB as ImGui packs it: red in the lowest byte, then green, blue, opacity.
[[nodiscard]] std::uint32_t panelColour(PanelColour colour, Theme theme) noexcept;

/// A colour that is read or seen on another one.
struct PanelPair {
  PanelColour ink, ground;
  /// Least contrast as WCAG 2.1 defines it: of texts 4.5 (1.4.3), of lines and marks that mean something 3 (1.4.11).
  double contrast;
};
inline constexpr double kTextContrast = 4.5, kLineContrast = 3.0;
/// Every pair that occurs.
[[nodiscard]] std::span<const PanelPair> panelPairs() noexcept;

}  // namespace fettle::render
