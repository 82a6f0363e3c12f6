#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <variant>

#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

// A limit in millimetres that may be infinite: ticked where it counts.
void extentField(engine::FillOptions& fill, const render::ShownUnit& length, double first_mm) {
  bool limited = std::isfinite(fill.most_extent_mm);
  if (tickBox("only holes up to", limited, "Holes whose longest side is longer stay holes."))
    fill.most_extent_mm = limited ? first_mm : std::numeric_limits<double>::infinity();
  restOfLine();
  if (limited)
    (void)typeLength("##most extent", fill.most_extent_mm, 1e-12, 1e12, length);
  else
    noField("any size");
}

constexpr int kMethodLines = 3;

void linesFields(engine::LineOptions& lines) {
  struct Row {
    const char* name;
    engine::LineMethod method;
    int degree;
    const char* says;
  };
  // What it does to the lines, and for which it is.
  constexpr Row kRows[] = {
      {textOf("median"), engine::LineMethod::kMedian, 0,
       textOf("For lines that are off by a height each: all get the same median. Features may take less than "
              "half of a line.")},
      {textOf("mean"), engine::LineMethod::kPolynomial, 0,
       textOf("For lines that are off by a height each, of a surface without steps: all get the same mean.")},
      {textOf("straight line"), engine::LineMethod::kPolynomial, 1,
       textOf("For lines that are tilted against each other: all get the same mean height and slope.")},
      {textOf("polynomial 2"), engine::LineMethod::kPolynomial, 2,
       textOf("For lines that are tilted and bent: all get the same mean height, slope and bend.")},
      {textOf("polynomial 3"), engine::LineMethod::kPolynomial, 3,
       textOf("For lines that are bent like an S: as polynomial 2, with one bend more.")},
      {textOf("difference"), engine::LineMethod::kDifference, 0,
       textOf(
           "For lines that are off by a height each, where features fill whole lines: from line to line by "
           "the middle of their differences.")},
      {textOf("matching"), engine::LineMethod::kMatching, 0,
       textOf("For lines that are off by a height each, with features and noise, as most scans: from line to "
              "line by what is alike in both.")}};
  int chosen = 0;
  for (int i = 0; i < static_cast<int>(std::size(kRows)); ++i)
    if (lines.method == kRows[i].method && lines.degree == kRows[i].degree) chosen = i;
  beginFields();
  (void)field("lines by", kRows[chosen].says, [&] {
    if (!beginList("##lines by", tr(kRows[chosen].name))) return false;
    for (const Row& row : kRows) {
      if (ImGui::Selectable(labelOf(row.name), &row == &kRows[chosen])) {
        lines.method = row.method;
        lines.degree = row.degree;
      }
      explain(row.says);
    }
    ImGui::EndCombo();
    return true;
  });
  beginPlace("##for which lines", kMethodLines);
  writeIn(render::PanelColour::kMuted, kRows[chosen].says);
  endPlace();
  (void)field("lines are", "Which way the scanner moved: along the rows, or along the columns.", [&] {
    int axis = lines.axis == engine::ScanAxis::kX ? 0 : 1;
    const bool changed = chooseWord("##scan axis", axis, {"rows", "columns"});
    if (changed) lines.axis = axis == 0 ? engine::ScanAxis::kX : engine::ScanAxis::kY;
    return changed;
  });
  constexpr const char* kForm = textOf(
      "What changes slowly from line to line, as tilt and bends up to a wave as long as the field: form of "
      "the part, and slow drift of the scanner. Drift can be taken out with the panel Form. With \"goes, "
      "too\" all lines end at the same height.");
  (void)field("slow form", kForm, [&] {
    int goes = lines.form_degree ? 0 : 1;
    const bool changed = chooseWord("##lines form", goes, {"stays", "goes, too"});
    if (changed)
      lines.form_degree = goes == 0 ? std::optional(engine::LineOptions::kUsualFormDegree) : std::nullopt;
    return changed;
  });
  (void)field("found in", "Which samples say how high a line lies; all of the line is moved.", [&] {
    constexpr engine::Region kOf[] = {engine::Region::kAll, engine::Region::kMarked,
                                      engine::Region::kUnmarked};
    int of = 0;
    for (int i = 0; i < 3; ++i)
      if (lines.region == kOf[i]) of = i;
    const bool changed = chooseRegion("##lines of", of);
    if (changed) lines.region = kOf[of];
    return changed;
  });
  endFields();
}

constexpr int kSuggestedLines = 6;

// What was measured, as a place of its own: what is below stays where it is.
void lineSuggestion(HeightTool& heights, LineSuggester& suggester) {
  beginPlace("##lines suggested", kSuggestedLines);
  if (suggester.busy()) {
    if (cancelledBar(suggester.progress(), "trying ways to level", "Cancel##lines")) suggester.cancel();
  } else if (!suggester.says().empty()) {
    if (suggester.outdated())
      writeIn(render::PanelColour::kWarning, "the scan has changed since: Suggest again");
    if (const auto& way = suggester.suggested();
        way && (way->method != heights.lines.method || way->degree != heights.lines.degree)) {
      if (pressButton("Take it##lines",
                      "Levels by the way that is suggested; the rest of the fields stays.")) {
        heights.lines.method = way->method;
        heights.lines.degree = way->degree;
      }
    }
    writeWrapped(suggester.says());
  } else {
    writeIn(render::PanelColour::kMuted,
            "Suggest tries all ways on samples of each line, and says how far lines lie apart by each.");
  }
  endPlace();
}

constexpr HeightButtons kFillButtons{Action::kFillPreview, Action::kFillHoles, textOf("Fill holes")};
constexpr HeightButtons kLevelButtons{Action::kLevelPreview, Action::kLevelLines, textOf("Level lines")};

}  // namespace

void heightButtons(const PanelContext& context, HeightTool& heights, const haptic::HeightsMaker& maker,
                   const HeightButtons& buttons) {
  const haptic::HeightsMaker* const previewed = heights.previewed();
  const bool behind = previewed != nullptr && previewed->index() == maker.index() && !(*previewed == maker) &&
                      !heights.followsSoon();
  ImGui::BeginDisabled(heights.busy() && !heights.followsSoon());
  previewButton(heights.previews(maker) ? PreviewWord::kShown
                : behind                ? PreviewWord::kBehind
                                        : PreviewWord::kNone,
                buttons.name, buttons.preview, context.act);
  sameLineIfFits(buttons.name);
  actionButton(buttons.name, buttons.make, context.act);
  ImGui::EndDisabled();
}

void heightOutcome(HeightTool& heights, bool here) {
  constexpr int kLines = 4;
  beginPlace("##heights outcome", kLines);
  if (here && heights.busy() && !heights.followsSoon()) {
    if (cancelledBar(heights.progress(), "computing heights", "Cancel##heights")) heights.cancel();
    if (const std::string so_far = heights.soFar(); !so_far.empty())
      writeWrapped(trFormat("preview: {}", so_far));
  } else if (here && !heights.found().empty()) {
    writeWrapped(heights.found());
  }
  endPlace();
}

void heightsPanel(const PanelContext& context, HeightTool& heights, LineSuggester& suggester) {
  const engine::Grid& grid = context.client.field().grid();
  const render::ShownUnit length = ofMillimetres(context.units.length, grid.lateral_unit.mm);
  int method = heights.fill.method == engine::FillMethod::kCurvature ? 0 : 1;
  beginFields();
  if (field("holes by",
            "Least curvature goes on as the rim bends; a membrane is stretched over it, flatter and faster.",
            [&] {
              return chooseWord("##fill", method, {"least curvature", "membrane"});
            }))
    heights.fill.method = method == 0 ? engine::FillMethod::kCurvature : engine::FillMethod::kMembrane;
  endFields();
  extentField(heights.fill, length, HeightTool::usualExtentMm(grid));
  tickBox("at the border too", heights.fill.at_border,
          "Holes that reach the edge of the field have no rim there: what fills them is less sure.");
  heightButtons(context, heights, heights.fill, kFillButtons);
  ImGui::Separator();
  linesFields(heights.lines);
  heightButtons(context, heights, heights.lines, kLevelButtons);
  sameLineIfFits("Suggest");
  ImGui::BeginDisabled(suggester.busy());
  if (pressButton("Suggest##lines", "Measures which way leaves neighbouring lines closest together."))
    suggester.search(context.client, heights.lines);
  ImGui::EndDisabled();
  lineSuggestion(heights, suggester);
  heightOutcome(heights, heights.wasLast(heights.fill) || heights.wasLast(heights.lines));
}

}  // namespace fettle::app
