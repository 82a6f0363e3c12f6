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
}

void cell(const std::string& text) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(text.c_str());
}

// A column for each value, and one for the figure without noise of the last.
void arealTable(const MeasureTool::Figures& figures) {
  const int columns = (figures.before ? 4 : 3);
  if (!ImGui::BeginTable("parameters", columns, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg))
    return;
  cell("");
  if (figures.before) cell("scan");
  cell(figures.before ? "now" : "value");
  cell("");
  for (const ArealLine& line : figures.lines) {
    ImGui::TableNextRow();
    cell(line.name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", line.text.c_str());
    for (std::size_t i = 0; i < line.values.size(); ++i) {
      // A reason is longer than a figure: it is the tip of a dash.
      const bool stated = line.values[i].find(' ') == std::string::npos;
      cell(stated ? line.values[i] : "-");
      if (ImGui::IsItemHovered()) {
        if (!stated)
          ImGui::SetTooltip("%s", line.values[i].c_str());
        else if (!line.without[i].empty())
          ImGui::SetTooltip("without noise %s", line.without[i].c_str());
      }
    }
    cell(line.unit);
    if (!figures.options.noise) continue;
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    for (const std::string& without : line.without) {
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", without.c_str());
    }
  }
  ImGui::EndTable();
}

}  // namespace

void measurePanel(const PanelContext& context, MeasureTool& measure, const WindowPicture& picture) {
  measureFields(measure.options);
  ImGui::BeginDisabled(measure.busy());
  if (ImGui::Button("Measure now"))
    measure.measure(context.client, picture.seenRect(context.client.field().grid()));
  ImGui::EndDisabled();
  if (workRow(measure.busy() ? std::optional(measure.progress()) : std::nullopt, "measuring",
              "Cancel##measure"))
    measure.cancel();
  const auto& figures = measure.figures();
  if (!figures) return;
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(fmt::format("ISO 25178-2, {} samples{}{}", figures->samples,
                                     figures->options.noise ? "; grey: without noise, +- its error" : "",
                                     measure.outdated() ? "; the field has changed since" : "")
                             .c_str());
  ImGui::PopTextWrapPos();
  arealTable(*figures);
}

}  // namespace fettle::app
