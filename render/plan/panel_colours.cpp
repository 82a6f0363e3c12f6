// The contrast of each pair is held by tests; what is told apart by colour alone is told apart by colour-blind eyes, too.
#include "render/plan/panel_colours.h"

#include "engine/base/rows.h"

namespace fettle::render {
// With a name: the words of the enumeration stand alone in it.
namespace panel_table {

using enum PanelColour;

struct Row {
  PanelColour colour;
  std::uint32_t dark, light;  // 0xRRGGBBAA
};

// Texts stand on the grab of a slider and on the bar of a work, and these on their fields: their lightness is between.
constexpr Row kRows[] = {
    {kBehind, 0x17171AFF, 0xDADAD8FF},       {kPanel, 0x101113FF, 0xE8E8E6FF},
    {kPopup, 0x141517FF, 0xF4F4F2FF},        {kBar, 0x242528FF, 0xDCDDDFFF},
    {kTitle, 0x294A7AFF, 0xB9CEEDFF},        {kField, 0x17263CFF, 0xFFFFFFFF},
    {kFieldPointed, 0x0F2648FF, 0xEEF3FBFF}, {kFieldHeld, 0x0F2648FF, 0xEEF3FBFF},
    {kButton, 0x24456DFF, 0xC4D8F2FF},       {kButtonPointed, 0x2F6DB5FF, 0xA9C7EEFF},
    {kButtonHeld, 0x2563AFFF, 0x9BBCEBFF},   {kRow, 0x1E3654FF, 0xC9D9EEFF},
    {kRowPointed, 0x24456DFF, 0xBCD2F0FF},   {kRowHeld, 0x2A4A75FF, 0xB4CDEFFF},
    {kOtherRow, 0x1C1D20FF, 0xDFDFDDFF},     {kTableHead, 0x303236FF, 0xD2D6DCFF},
    {kSelection, 0x2F5C96FF, 0xA9C7EEFF},    {kShade, 0x00000073, 0x00000059},
    {kChart, 0xFFFFFFFF, 0xFFFFFFFF},        {kPlate, 0x202329EB, 0xF4F4F2EB},
    {kRing, 0x14161AD2, 0xF4F4F2D2},

    {kText, 0xF5F6F8FF, 0x1B1E23FF},         {kMuted, 0xB4B8BEFF, 0x4C5158FF},
    {kWarning, 0xFFC861FF, 0x7A4A00FF},      {kProblem, 0xFF8F66FF, 0xAD1F14FF},
    {kGood, 0x5FD0C4FF, 0x00605CFF},

    {kTick, 0x5AA6FFFF, 0x1F5FBFFF},         {kGrab, 0x3072C0FF, 0x688CCCFF},
    {kGrabHeld, 0x3072C0FF, 0x688CCCFF},     {kProgress, 0x3072C0FF, 0x688CCCFF},
    {kCurve, 0x9CC3F0FF, 0x2C4F80FF},        {kBorder, 0x6E7076FF, 0x7C7F85FF},
    {kScrollTrack, 0x0B0C0DFF, 0xDADAD8FF},  {kScrollGrab, 0x6E7076FF, 0x74777DFF},
    {kHandle, 0xF5F6F8FF, 0x1B1E23FF},       {kHandleRim, 0x000000FF, 0xFFFFFFFF},
    {kOutline, 0xB4B8BEFF, 0x4C5158FF},      {kLower, 0x699BE1FF, 0x3B6FB6FF},
    {kHigher, 0xE17364FF, 0xC0483CFF},       {kProfile, 0x0072B2FF, 0x0072B2FF},
    {kProfileNow, 0xD55E00FF, 0xD55E00FF},   {kProfileBefore, 0x6598C2FF, 0x6598C2FF},
    {kCursors, 0x3C3C3CC8, 0x3C3C3CC8},      {kOtherCursors, 0x803C96E6, 0x803C96E6},
    {kStretch, 0x3C3C3C1E, 0x3C3C3C1E},

    {kAxisX, 0xE2505CFF, 0xE2505CFF},        {kAxisY, 0x74B22AFF, 0x74B22AFF},
    {kAxisZ, 0x428AEEFF, 0x428AEEFF},        {kAxisLetter, 0x0C0E12FF, 0x0C0E12FF},
    {kAxisPointed, 0xFFFFFFFF, 0xFFFFFFFF},  {kAxisHollow, 0x14161BFF, 0x14161BFF},
    {kLasso, 0xFFAA28FF, 0xFFAA28FF},        {kLassoRim, 0x000000A0, 0x000000A0},
    {kSplitHandle, 0xFFFFFFDC, 0xFFFFFFDC},
};
static_assert(engine::inOrder(kRows, &Row::colour, kCount));

constexpr PanelPair kPairs[] = {
    {kText, kBehind, kTextContrast},
    {kText, kPanel, kTextContrast},
    {kText, kPopup, kTextContrast},
    {kText, kBar, kTextContrast},
    {kText, kTitle, kTextContrast},
    {kText, kField, kTextContrast},
    {kText, kFieldPointed, kTextContrast},
    {kText, kFieldHeld, kTextContrast},
    {kText, kButton, kTextContrast},
    {kText, kButtonPointed, kTextContrast},
    {kText, kButtonHeld, kTextContrast},
    {kText, kRow, kTextContrast},
    {kText, kRowPointed, kTextContrast},
    {kText, kRowHeld, kTextContrast},
    {kText, kOtherRow, kTextContrast},
    {kText, kTableHead, kTextContrast},
    {kText, kSelection, kTextContrast},
    {kText, kPlate, kTextContrast},
    {kText, kGrab, kTextContrast},
    {kText, kGrabHeld, kTextContrast},
    {kText, kProgress, kTextContrast},
    {kMuted, kPanel, kTextContrast},
    {kMuted, kPopup, kTextContrast},
    {kMuted, kField, kTextContrast},
    {kMuted, kFieldPointed, kTextContrast},
    {kMuted, kFieldHeld, kTextContrast},
    {kMuted, kRow, kTextContrast},
    {kMuted, kRowPointed, kTextContrast},
    {kMuted, kRowHeld, kTextContrast},
    {kMuted, kOtherRow, kTextContrast},
    {kWarning, kPanel, kTextContrast},
    {kWarning, kPopup, kTextContrast},
    {kProblem, kPanel, kTextContrast},
    {kProblem, kPopup, kTextContrast},
    {kGood, kPopup, kTextContrast},
    {kAxisLetter, kAxisX, kTextContrast},
    {kAxisLetter, kAxisY, kTextContrast},
    {kAxisLetter, kAxisZ, kTextContrast},
    {kAxisX, kAxisHollow, kTextContrast},
    {kAxisY, kAxisHollow, kTextContrast},
    {kAxisZ, kAxisHollow, kTextContrast},

    {kTick, kPanel, kLineContrast},
    {kTick, kPopup, kLineContrast},
    {kTick, kField, kLineContrast},
    {kTick, kFieldPointed, kLineContrast},
    {kTick, kFieldHeld, kLineContrast},
    {kTick, kPlate, kLineContrast},
    {kTick, kRing, kLineContrast},
    {kGrab, kField, kLineContrast},
    {kGrab, kFieldPointed, kLineContrast},
    {kGrabHeld, kFieldHeld, kLineContrast},
    {kProgress, kField, kLineContrast},
    {kProgress, kFieldPointed, kLineContrast},
    {kCurve, kField, kLineContrast},
    {kBorder, kPanel, kLineContrast},
    {kBorder, kPopup, kLineContrast},
    {kBorder, kField, kLineContrast},
    {kScrollGrab, kScrollTrack, kLineContrast},
    {kHandle, kHandleRim, kLineContrast},
    {kHandle, kField, kLineContrast},
    {kOutline, kField, kLineContrast},
    {kLower, kField, kLineContrast},
    {kHigher, kField, kLineContrast},
    {kProfile, kChart, kLineContrast},
    {kProfileNow, kChart, kLineContrast},
    {kProfileBefore, kChart, kLineContrast},
    {kCursors, kChart, kLineContrast},
    {kOtherCursors, kChart, kLineContrast},
};

}  // namespace panel_table

std::uint32_t panelColour(PanelColour colour, Theme theme) noexcept {
  const panel_table::Row& row = panel_table::kRows[static_cast<std::size_t>(colour)];
  const std::uint32_t c = theme == Theme::kLight ? row.light : row.dark;
  return c >> 24U | (c >> 8U & 0xFF00U) | (c << 8U & 0xFF0000U) | c << 24U;
}

std::span<const PanelPair> panelPairs() noexcept {
  return panel_table::kPairs;
}

}  // namespace fettle::render
