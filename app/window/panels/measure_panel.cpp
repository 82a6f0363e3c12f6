#include <cstddef>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

void measureFields(MeasureTool::Options& options) {
  using Where = MeasureTool::Where;
  constexpr const char* kWhere[] = {"all samples", "what is visible", "marked samples", "samples not marked"};
  constexpr const char* kForms[] = {"mean height",  "plane",        "polynomial 2",
                                    "polynomial 3", "polynomial 4", "polynomial 5"};
  beginFields();
  int where = static_cast<int>(options.where);
  if (field("of", [&] { return ImGui::Combo("##measured", &where, kWhere, std::size(kWhere)); }))
    options.where = static_cast<Where>(where);
  (void)field("about a",
              [&] { return ImGui::Combo("##measured form", &options.degree, kForms, std::size(kForms)); });
  endFields();
  ImGui::Checkbox("its form without steps and spikes", &options.robust);
  ImGui::Checkbox("without noise, with errors", &options.noise);
  explain("Below each figure a paler one: without the noise of the scan, +- its standard error.");
}

void cell(const std::string& text) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(text.c_str());
}

constexpr int kCaptionLines = 2;

// A column for each value; with `noise` a second row for each parameter, with its figures without noise. The table has its
// rows from when it is asked for: what is below moves by that click, and not when the figures come.
void arealTable(const MeasureTool& measure, bool noise) {
  const auto& figures = measure.figures();
  const bool before = figures && figures->before;
  if (!ImGui::BeginTable("parameters", before ? 4 : 3,
                         ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg))
    return;
  cell("");
  if (before) cell("scan");
  cell(before ? "now" : "value");
  cell("");
  for (const ArealLine& line : figures ? figures->lines : arealNames()) {
    ImGui::TableNextRow();
    cell(line.name);
    if (ImGui::IsItemHovered()) valueTip(line.text);
    if (!figures) cell(measure.busy() ? "..." : "-");
    for (std::size_t i = 0; i < line.values.size(); ++i) {
      // A reason is longer than a figure: it is the tip of a dash.
      const bool stated = line.values[i].find(' ') == std::string::npos;
      cell(stated ? line.values[i] : "-");
      if (ImGui::IsItemHovered()) {
        if (!stated)
          valueTip(line.values[i]);
        else if (!line.without[i].empty())
          valueTip("without noise " + line.without[i]);
      }
    }
    cell(line.unit);
    if (!noise) continue;
    ImGui::TableNextRow();
    cell("");
    for (const std::string& without : line.without) {
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", without.c_str());
    }
  }
  ImGui::EndTable();
}

// How far the work is, or what the table below has.
void caption(MeasureTool& measure) {
  beginPlace("##measured", kCaptionLines);
  if (measure.busy()) {
    if (cancelledBar(measure.progress(), "measuring", "Cancel##measure")) measure.cancel();
  } else if (const auto& figures = measure.figures()) {
    writeWrapped(fmt::format("ISO 25178-2, {} samples{}", figures->samples,
                             measure.outdated() ? "; the field has changed since" : ""));
  } else {
    writeIn(render::PanelColour::kMuted, "surface texture by ISO 25178-2");
  }
  endPlace();
}

}  // namespace

void measurePanel(const PanelContext& context, MeasureTool& measure, const WindowPicture& picture) {
  measureFields(measure.options);
  ImGui::BeginDisabled(measure.busy());
  if (ImGui::Button("Measure now"))
    measure.measure(context.client, picture.seenRect(context.client.field().grid()));
  ImGui::EndDisabled();
  caption(measure);
  if (measure.asked() == nullptr) return;
  const auto& figures = measure.figures();
  arealTable(measure, measure.busy() || !figures ? measure.asked()->noise : figures->options.noise);
}

}  // namespace fettle::app
