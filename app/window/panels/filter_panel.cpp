#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/screen_text.h"
#include "app/work/filter_list.h"

namespace fettle::app {
namespace {

constexpr int kPreviewLines = 5;

// What no filter does and people look for here: entries that show its preview, in its panel.
void otherEntries(const HeightTool& heights, const Act& act) {
  struct Entry {
    const char* name;
    Action preview;
    const char* says;
    bool shown;
  };
  for (const Entry& entry :
       {Entry{textOf("Level lines (rows or columns) ..."), Action::kLevelPreview,
              textOf("Rows of a line scanner that are off against each other: in the panel Holes and lines."),
              heights.previews(heights.lines)},
        Entry{textOf("Fill holes ..."), Action::kFillPreview,
              textOf("Samples without a height: in the panel Holes and lines."),
              heights.previews(heights.fill)}}) {
    // The action would drop a preview that is shown.
    if (ImGui::Selectable(labelOf(entry.name)) && !entry.shown) act(entry.preview);
    explain(entry.says);
  }
}

void kindField(const PanelContext& context, FilterPreview& filters, const HeightTool& heights) {
  const engine::FilterSpec& spec = filters.spec;
  fieldName("filter", engine::filterOf(spec.kind).says);
  const bool open =
      beginList("##filter", tr(engine::filterOf(spec.kind).title), ImGuiComboFlags_HeightLargest);
  if (!open) {
    explain(engine::filterOf(spec.kind).says);
    return;
  }
  bool first = true;
  for (const FilterGroup& group : filterGroups()) {
    if (!first) ImGui::Separator();
    ImGui::TextDisabled("%s", tr(group.heading));
    for (const engine::FilterKind kind : group.filters) {
      const engine::Filter& each = engine::filterOf(kind);
      const bool chosen = ImGui::Selectable(labelOf(each.title), kind == spec.kind);
      explain(each.says);
      if (chosen) filters.chooseKind(kind, context.client.field().grid());
    }
    if (std::exchange(first, false)) otherEntries(heights, context.act);
  }
  ImGui::EndCombo();
}

void sizeFields(engine::FilterSpec& spec, const engine::Grid& grid, const render::FieldUnits& units) {
  const bool window = engine::filterOf(spec.kind).window.exists();
  if (window &&
      field("window",
            "Side of the square of samples around each sample that its new height comes from: a larger "
            "one takes more away.",
            [&] { return typeCount("##window", spec.window, 1, engine::FilterSpec::kMaxWindow, 2); }))
    spec.window |= 1;
  // As a length across the columns; the nearest odd number of samples is taken.
  double window_mm = spec.window * grid.spacingXMm();
  if (window && field("", "The same as a length; the nearest odd number of samples is taken.", [&] {
        return typeLength("##window_mm", window_mm, grid.spacingXMm(),
                          engine::FilterSpec::kMaxWindow * grid.spacingXMm(),
                          ofMillimetres(units.length, grid.lateral_unit.mm));
      }))
    spec.window =
        std::clamp(2 * static_cast<int>(std::lround(0.5 * (window_mm / grid.spacingXMm() - 1.0))) + 1, 1,
                   engine::FilterSpec::kMaxWindow);
  // Where samples lie closer along one axis, the same number of them is another length there.
  if (window && grid.spacingXMm() != grid.spacingYMm()) {
    fieldName("", {});
    const render::ShownUnit length = ofMillimetres(units.length, grid.lateral_unit.mm);
    ImGui::TextDisabled(
        "%s", trFormat("x {} along columns", lengthText(spec.window * grid.spacingYMm(), length)).c_str());
  }
  if (engine::filterOf(spec.kind).has_element) {
    constexpr const char* kSays =
        textOf("What is moved over the surface: a ball rolls over it, a disk and a square stay level.");
    fieldName("element", kSays);
    if (!beginList("##element", tr(engine::kElementWords[static_cast<std::size_t>(spec.element)].data()))) {
      explain(kSays);
    } else {
      for (std::size_t i = 0; i < engine::kElementWords.size(); ++i)
        if (const auto each = static_cast<engine::Element>(i);
            ImGui::Selectable(labelOf(engine::kElementWords[i].data()), each == spec.element))
          spec.element = each;
      ImGui::EndCombo();
    }
  }
  if (const engine::Filter& filter = engine::filterOf(spec.kind); filter.nesting.exists())
    (void)field(filter.nesting_word.data(),
                "Where the filter separates: what is narrower than this goes, what is wider stays.", [&] {
                  const double least = filter.least_nesting * std::max(grid.spacingXMm(), grid.spacingYMm());
                  return typeLength("##nesting", spec.nesting_mm, least, filter.nesting.most,
                                    ofMillimetres(units.length, grid.lateral_unit.mm));
                });
  (void)field("passes", "How often the filter runs, each time over what the last one left.",
              [&] { return typeCount("##passes", spec.passes, 1, engine::FilterSpec::kMaxPasses, 1); });
}

void sigmaFields(engine::FilterSpec& spec, const render::FieldUnits& units,
                 const std::optional<double>& range_of_noise) {
  const engine::Filter& filter = engine::filterOf(spec.kind);
  if (filter.sigma.exists())
    (void)field("sigma", "Standard deviation of the weights in the window.", [&] {
      return typeNumber("##sigma", spec.sigma, 0.0, 1000.0,
                        spec.sigma > 0.0 ? trPrintf("%.2f samples")
                                         : "0: " + std::string(tr(std::string_view(filter.sigma.when_zero))));
    });
  // With its number as soon as that is known.
  const std::string by_noise = range_of_noise
                                   ? trFormat("{} by the noise", lengthText(*range_of_noise, units.change, 3))
                                   : std::string(tr(std::string_view(filter.range_sigma.when_zero)));
  if (filter.range_sigma.exists())
    (void)field(
        "range sigma",
        fmt::format(
            "{} {}",
            spec.kind == engine::FilterKind::kOutliers
                ? tr("A sample that is farther than this from most others in its window stands apart, "
                     "and goes.")
                : tr("Heights that differ by no more than about this differ by noise, which goes; what "
                     "differs by more stays."),
            trFormat("0: {}, that of the scan as it was opened, also after other filters.",
                     tr(std::string_view(filter.range_sigma.when_zero)))),
        [&] {
          return typeLength("##range", spec.range_sigma, 0.0, filter.range_sigma.most, units.change,
                            by_noise);
        });
}

bool isRunning(const FilterPreview& filters) {
  return filters.applying() || (filters.computing() && !filters.followsSoon());
}

void runButtons(const PanelContext& context, FilterPreview& filters) {
  const bool runs = isRunning(filters);
  ImGui::BeginDisabled(runs);
  previewButton(
      !runs && filters.isBehind() && !filters.awaitsRest() ? PreviewWord::kBehind : PreviewWord::kNone, "",
      Action::kFilterPreview, context.act);
  sameLineIfFits("Add preview");
  actionButton("Add preview", Action::kFilterAdd, context.act);
  sameLineIfFits("Apply");
  if (ImGui::Button(labelOf("Apply"))) filters.apply(context.client);
  tip(Action::kFilterApply);
  ImGui::EndDisabled();
  sameLineIfFits("Suggest");
  actionButton("Suggest", Action::kFilterSuggest, context.act);
  if (workRow(runs ? std::optional(filters.progress()) : std::nullopt,
              filters.applying() ? tr("applying") : tr("filtering"), "Cancel"))
    filters.cancel(context.client);
}

void previewSoFar(const FilterPreview& filters) {
  const engine::FilterView::Picture& so_far = filters.soFar();
  if ((filters.computing() || filters.applying()) && so_far.step > 0)
    writeWrapped(trFormat("{}; from means of {} x {} samples", previewState(so_far, so_far.field.grid()),
                          so_far.step, so_far.step));
}

void previewList(bool anything_marked, const engine::LengthUnit& height, const render::ShownUnit& change,
                 FilterPreview& filters) {
  std::optional<std::size_t> dropped;
  for (std::size_t i = 0; i < filters.variants().size(); ++i) {
    const FilterPreview::Variant& v = filters.variants()[i];
    if (ImGui::SmallButton(fmt::format("x##{}", i).c_str())) dropped = i;
    explain("Drops this preview.");
    ImGui::SameLine();
    ImGui::PushTextWrapPos(0.0F);
    // Broken here, or a narrow panel would break a number at its point.
    const double most = v.result.report.max_change;
    const bool nothing_marked =
        v.spec.scope == engine::FilterScope::kOnlyMarks && v.result.report.changed == 0 && !anything_marked;
    const std::string came =
        nothing_marked ? tr("nothing is marked: with \"only marks\" nothing changes")
                       : trFormat("{} change, by up to {}", v.result.report.changed,
                                  lengthText(most, render::deviationUnit(height, change, most), 3)) +
                             (v.spec.max_change && v.result.report.max_change > *v.spec.max_change
                                  ? ";\n" + std::string(tr("the limit counts from the scan as it was opened"))
                                  : std::string());
    const std::string warning =
        v.unjudged > 0 ? trFormat("{} have too few others around them to be judged, and stay", v.unjudged)
                       : engine::warningOf(v.result.report);
    ImGui::TextUnformatted(
        screenText(fmt::format("{}\n{}{}{}", filterName(v.spec), came, warning.empty() ? "" : ";\n", warning))
            .c_str());
    ImGui::PopTextWrapPos();
  }
  if (dropped) filters.drop(*dropped);
}

}  // namespace

void filterPanel(const PanelContext& context, FilterPreview& filters, const HeightTool& heights,
                 Display& display) {
  engine::FilterSpec& spec = filters.spec;
  const engine::Grid& grid = context.client.field().grid();
  beginFields();
  kindField(context, filters, heights);
  endFields();
  // Above the fields, whose number is that of the filter: a button stays under the pointer whatever is chosen.
  runButtons(context, filters);
  beginFields();
  sizeFields(spec, grid, context.units);
  sigmaFields(spec, context.units, filters.rangeOfNoise(context.client));
  (void)limitField(context, spec.max_change, Action::kFilterMaxChange);
  endFields();
  int scope = static_cast<int>(spec.scope);
  ImGui::RadioButton(labelOf("keep marks"), &scope, 0);
  tip(Action::kFilterScope);
  sameLineIfFits("only marks", ItemKind::kTick);
  ImGui::RadioButton(labelOf("only marks"), &scope, 1);
  tip(Action::kFilterScope);
  spec.scope = static_cast<engine::FilterScope>(scope);
  ImGui::BeginDisabled(filters.variants().size() != 1);
  tickBox(
      "split line", display.split,
      "Scan and preview in one picture, with a line between them that can be dragged; else side by side.");
  ImGui::EndDisabled();
  beginPlace("##previews", kPreviewLines);
  previewSoFar(filters);
  if (filters.variants().empty() && !isRunning(filters))
    writeIn(render::PanelColour::kMuted, "A preview says here what it changes.");
  previewList(context.client.field().reader().root().marked_children != 0, grid.height_unit,
              context.units.change, filters);
  endPlace();
}

}  // namespace fettle::app
