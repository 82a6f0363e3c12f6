#include "app/window/action_tips.h"

#include <algorithm>
#include <iterator>

namespace fettle::app {
namespace {

struct Tip {
  Action action;
  std::string_view says;
};

constexpr Tip kTips[] = {
    {Action::kNavigate, "The left button moves the view again."},
    {actionOf(haptic::Tool::kFeel), "The stylus feels the surface and changes nothing."},
    {actionOf(haptic::Tool::kSmooth),
     "Takes noise off under the brush while the button is down. A single spike becomes a hill: take the "
     "median, only on marks, for spikes."},
    {actionOf(haptic::Tool::kMark),
     "What is marked no filter and no stroke changes; or filters change it alone, with \"only marks\"."},
    {actionOf(haptic::Tool::kUnmark), "Takes marks away under the brush."},
    {Action::kLasso, "Draw around one place after the other; Esc or another tool ends it."},
    {Action::kBox,
     "Drag over one place after the other, for spikes or a bad strip; Esc or another tool ends it. Then a "
     "filter with \"only marks\"."},
    {Action::kClearMarks, "Heights stay; undo brings them back."},
    {Action::kDrawLines,
     "A stroke along an edge is moved onto it, and filters work up to it from both sides and not across."},
    {Action::kEdges, "Shows where the scan has edges; Enter takes them as marks or edge lines."},
    {Action::kJoin, "They overlap: they are laid onto each other and become one scan."},
    {Action::kOpenScene, "Tip, force, brushes and effects with their numbers, felt at once."},
    {Action::kSaveScene, "For other scans, and for --scene of the command line."},
    {Action::kFilterSuggest,
     "Tries filters on surfaces as this scan has, with noise like its own, and lists the best with what they "
     "leave of the error, why, and their time. Takes some ten seconds and changes nothing."},
    {Action::kExport, "As GeoTIFF, STL mesh and more, by the ending of the name."},
    {Action::kExportSections,
     "All of them, or the chosen one: as a table, a drawing, a picture or polylines, by the ending of the "
     "name."},
    {Action::kExportReport,
     "One page with pictures, surface texture, sections and steps, before and after, for a browser or as "
     "PDF."},
    {Action::kNextMap, "Of heights: what has a sign, as a change, has blue below zero and red above."},
    {Action::kFilterPreview, "Shows the filter beside the scan and changes nothing."},
    {Action::kFilterAdd,
     "Keeps what is shown and puts another beside it, which follows the fields from then on."},
    {Action::kFilterApply,
     "Makes the filter that the panel says a step, which undo takes back. Where the picture shows a preview "
     "of "
     "another filter, it shows this one first."},
    {Action::kFilterScope,
     "\"keep marks\": marked samples keep their heights. \"only marks\": nothing else changes."},
    {Action::kFilterMaxChange,
     "No sample is farther than this from the scan as it was opened, however many steps lie between. What "
     "earlier steps moved farther comes back to this limit."},
    {Action::kRemoveOpen,
     "Samples below, above, between or outside heights, or marked ones, become holes: no-data plateaus, the "
     "table "
     "around a part, dust."},
    {Action::kRemovePreview, "Shows it beside the scan and changes nothing."},
    {Action::kRemoveSamples,
     "Holes in place of these samples, as a step: undo brings them back with their marks. Marked samples "
     "stay "
     "unless they are named."},
    {Action::kRemoveMarked, "What is marked becomes holes, and its marks go; undo brings both back."},
    {Action::kFitShapes,
     "To all samples that count, or to each region between edge lines: sizes and places with standard "
     "errors."},
    {Action::kFindFeatures,
     "By watersheds, as ISO 25178-2 segments a surface: place, height over the saddle, area and volume of "
     "each."},
    {Action::kExportFeatures, "As a table with a row for each."},
    {Action::kExportFits, "As a table, as the report of fettle fit, or as STEP for a CAD program."},
    {Action::kPlanePoints,
     "For a part whose drawing names three level places: click them one after the other. The heights around "
     "each are averaged. Esc leaves it as it was."},
    {Action::kFillPreview, "Shows it beside the scan and changes nothing."},
    {Action::kLevelPreview, "Shows it beside the scan and changes nothing."},
    {Action::kFillHoles, "From the heights at their rim; what is filled is known as filled everywhere."},
    {Action::kLevelLines,
     "For scanners whose rows lie at different heights: stripes go. Whether slow form from line to line goes "
     "as well is a field of the panel."},
    {Action::kShowMarks, "They count whether they are shown or not."},
    {Action::kKeepWithin,
     "Strokes move no sample farther than this from the scan as it was opened, over all strokes together."},
};

}  // namespace

std::string_view tipOf(Action action) noexcept {
  const auto* const row = std::ranges::find(kTips, action, &Tip::action);
  return row == std::end(kTips) ? std::string_view{} : row->says;
}

}  // namespace fettle::app
