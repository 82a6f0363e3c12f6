#include "app/window/tool_results.h"

#include <algorithm>
#include <utility>

#include "app/window/overlays.h"
#include "render/plan/number_text.h"
#include "render/plan/value_range.h"

namespace fettle::app {
namespace {

// Units and limits that fit the heights that are seen.
void noteHeights(Parts& p) {
  const engine::Version& original = p.document.client()->original();
  const render::ValueRange heights = render::heightSpan(original).robust;
  // Limits of other heights mean nothing in these.
  p.heights.remove = {.heights = engine::RemoveOptions::Heights::kOutside, .low = heights.low};
  p.colours.clear(p.settings.display);
  const engine::Grid& grid = original.grid();
  p.units = render::fieldUnits(grid, heights.low, heights.high);
  const auto asRead = [](const render::ShownUnit& shown, const engine::LengthUnit& unit) {
    return ReadAs{shown.name, unit.mm / shown.per_unit};
  };
  p.section.writeIn({asRead(p.units.length, grid.lateral_unit), asRead(p.units.height, grid.height_unit)});
  if (heights.low < heights.high) p.last_limit = render::roundDown125(0.01 * (heights.high - heights.low));
}

}  // namespace

void ToolResults::begin(Parts& parts) {
  const LoopClient& client = *parts.document.client();
  form_ = client.field().formOver();
  step_ = client.history().number();
  stepped_ = false;
  extremes_ = client.upright().reader().bounds();
  parts.heights.fill = {.most_extent_mm = HeightTool::usualExtentMm(client.field().grid())};
  noteHeights(parts);
}

// Under another form heights are others: what was found in them is found again.
void ToolResults::followForm(Parts& p) {
  const engine::FieldForm& form = p.document.client()->field().formOver();
  if (form == form_) return;
  form_ = form;
  p.marking.edges.drop();
  p.marking.places.drop();
  p.measure.clear();
  noteHeights(p);
  p.picture.requestRedraw();
}

// Colours whose range the picture finds follow a step that moves the extremes: after outliers are gone they would leave half of
// themselves to nothing. Under a brush and after it they stay, since a hand compares what it sees.
void ToolResults::followExtremes(Parts& p) {
  const LoopClient& client = *p.document.client();
  const engine::History& history = client.history();
  const std::int64_t now = history.number();
  if (now != step_) {
    const auto changesHeights = [&](std::int64_t step) {
      if (step <= history.first() || step > history.last()) return false;
      const engine::StepKind kind = history.info(step).kind;
      return kind == engine::StepKind::kFilter || kind == engine::StepKind::kImport;
    };
    for (std::int64_t step = std::min(now, step_) + 1; step <= std::max(now, step_); ++step)
      stepped_ = stepped_ || changesHeights(step);
    step_ = now;
  }
  if (!stepped_ || client.strokeIsUnderWay() || !(client.upright() == history.current())) return;
  stepped_ = false;
  const engine::HeightBounds extremes = client.upright().reader().bounds();
  if (extremes == std::exchange(extremes_, extremes)) return;
  p.picture.refreshColours();
  p.picture.requestRedraw();
}

std::optional<std::string> ToolResults::take(Parts& p) {
  LoopClient& client = *p.document.client();
  std::vector<Notice>& notices = p.feedback.notices;
  followForm(p);
  followExtremes(p);
  const auto seen = [&] { return p.picture.seenPart(client.field().grid(), p.view); };
  if (p.filters.wantsView()) p.filters.look(seen());
  if (p.heights.wantsView()) p.heights.look(seen());
  bool changed = p.filters.poll(client, notices);
  p.filters.follow(client, seen);
  // An adoption ends first: its result belongs to the form under which it was computed.
  if (!p.filters.applying()) {
    changed |= p.form.poll(client, notices);
    changed |= p.heights.poll(client, notices);
    p.heights.follow(seen);
  }
  changed |= p.suggester.poll(client, notices);
  changed |= p.line_suggester.poll(client, notices);
  changed |= p.removal.poll(client);
  changed |= p.devices.poll();
  changed |= p.measure.poll(client, notices);
  if (p.fit.poll(client, notices)) {
    p.picture.refreshRanges();
    changed = true;
  }
  if (p.features.poll(client, notices)) {
    p.picture.refreshRanges();
    changed = true;
  }
  if (p.compare.poll(client, notices)) {
    p.picture.refreshRanges();
    changed = true;
  }
  std::optional<std::string> written = p.transform.poll(notices);
  if (auto joined = p.join.poll(notices)) written = std::move(joined);
  changed |= p.section.poll(client, notices);
  if (auto kept = p.section.takeKept()) p.document.keepSections(*std::move(kept));
  changed |= p.marking.poll(client, p.settings.draw_lines, notices);
  // Under a hand that presses, and behind a question, the view stays where it is.
  const bool busy_hand = p.held() || p.line_drag.active() || p.section_drag.active() || p.brush.active() ||
                         p.feedback.questions.pending();
  if (const auto place = busy_hand ? std::nullopt : p.marking.places.takeArrival()) {
    if (const auto framing = p.picture.framing())
      p.flyTo(viewOfPlace(p.viewToCome(), *framing, client.field().reader(),
                          p.marking.places.found()->places[*place]));
    changed = true;
  }
  for (Notice& notice : client.takeNotices()) p.feedback.take(std::move(notice));
  while (notices.size() > Feedback::kMostNotices) notices.erase(notices.begin());
  const bool stroke = p.stylus.held() || p.marking.held();
  changed |= p.change.poll(client, stroke);
  const render::Shown& shown = p.picture.shown();
  const bool counted = p.settings.side_panel && p.settings.panels["Colours"];
  changed |= p.colours.poll(shown, counted || ColourRange::needsSample(p.settings.display, shown),
                            stroke || p.filters.computing() || p.filters.applying());
  for (const engine::Error& error : p.costs.poll()) notices.push_back({error.line(), ""});
  if (changed) p.picture.requestRedraw();
  return written;
}

}  // namespace fettle::app
