#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/work/read_units.h"

namespace fettle::app {
namespace {

// Lines of the outcome from when features are found, and before.
constexpr int kFoundLines = 16, kUnfoundLines = 3;

void featureFields(FeatureTool::Options& options) {
  beginFields();
  (void)field("what", "Hills rise to a peak, dales fall to a pit: heights and volumes of these are depths.",
              [&] {
                int kind = options.what.dales ? 1 : 0;
                const bool changed = chooseWord("##feature kind", kind, {"hills", "dales"});
                options.what.dales = kind == 1;
                return changed;
              });
  (void)field(
      "at least", "Lower ones become part of their neighbour; of the whole height of the surface.", [&] {
        constexpr float kPercentStep = 1.0F;
        auto percent = static_cast<float>(options.what.prune);
        const bool changed = ImGui::InputFloat("##feature prune", &percent, kPercentStep, 0.0F, "%.4g %%");
        if (changed) options.what.prune = std::clamp(static_cast<double>(percent), 0.0, 100.0);
        return changed;
      });
  (void)field("of", "Which samples count; the others are as holes.", [&] {
    constexpr engine::Region kOf[] = {engine::Region::kAll, engine::Region::kMarked,
                                      engine::Region::kUnmarked};
    int of = static_cast<int>(std::ranges::find(kOf, options.what.region) - std::begin(kOf));
    const bool changed = chooseRegion("##features of", of);
    if (changed) options.what.region = kOf[of];
    return changed;
  });
  (void)field("without", "The form that is taken out first, in the figures alone.", [&] {
    return chooseWord("##feature form", options.degree,
                      {"height", "plane", "degree 2", "degree 3", "degree 4", "degree 5"});
  });
  endFields();
}

struct ShownFeatures {
  ReadAs height, length;
  double area;
  std::string volume;
};
ShownFeatures shownFeatures(const Report& report, const render::ShownUnit& across) {
  const ReadAs height = onScreen(featureUnits(report).height), length = onScreen(unitRead(across));
  const std::string volume = height.name == length.name
                                 ? length.name + "\u00b3"
                                 : fmt::format("{}\u00b2 {}", length.name, height.name);
  return {height, length, length.size * length.size, volume};
}

// Numbers as short as the panel is narrow: what is exact is in the exported table.
std::string shortNumber(double value) {
  return std::abs(value) >= 1e4 ? fmt::format("{:.2e}", value) : fmt::format("{:.4g}", value);
}

void featureTable(const Report& rows, const ShownFeatures& units) {
  constexpr int kFeatureColumns = 6;
  constexpr ImGuiTableFlags kLook = ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg;
  if (!ImGui::BeginTable("features", kFeatureColumns, kLook)) return;
  for (const char* title : {"", "x", "y", tr("height"), tr("area"), tr("volume")})
    ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  // Of hundreds of thousands those rows alone are laid out that are visible.
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const Report& row = rows[static_cast<std::size_t>(i)];
      ImGui::TableNextRow();
      for (const std::string& text :
           {fmt::format("{}{}", row["number"].get<int>(), row["open"].get<bool>() ? "*" : ""),
            shortNumber(row["x"].get<double>() / units.length.size),
            shortNumber(row["y"].get<double>() / units.length.size),
            shortNumber(row["height"].get<double>() / units.height.size),
            shortNumber(row["area"].get<double>() / units.area),
            shortNumber(row["volume"].get<double>() / units.height.size / units.area)}) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(text.c_str());
      }
    }
  ImGui::EndTable();
}

void outcome(const PanelContext& context, const FeatureTool& features) {
  const Report& report = *features.found();
  const ShownFeatures units = shownFeatures(report, context.units.length);
  if (features.outdated()) writeWrapped("the field has changed since: Find");
  writeWrapped(trFormat("{} {} at least {:.4g} {} high", report["count"].get<std::size_t>(),
                        tr(std::string_view(report["kind"].get_ref<const std::string&>())),
                        report["least_height"].get<double>() / units.height.size, units.height.name));
  if (!report["mean_volume"].is_null())
    writeWrapped(trFormat("closed ones in the mean: height {:.4g} {}, volume {:.4g} {}",
                          report["mean_height"].get<double>() / units.height.size, units.height.name,
                          report["mean_volume"].get<double>() / units.height.size / units.area,
                          units.volume));
  if (!report["mean_area"].is_null())
    writeWrapped(trFormat("those that nothing cuts in the mean: area {:.4g} {}",
                          report["mean_area"].get<double>() / units.area, units.length.name + "\u00b2"));
  featureTable(report["features"], units);
  writeIn(render::PanelColour::kMuted,
          trFormat("places in {}, areas in {}; * open: above its saddle it reaches the border or a hole",
                   units.length.name, units.length.name + "\u00b2"));
}

}  // namespace

void featurePanel(const PanelContext& context, FeatureTool& features, WindowPicture& picture) {
  ImGui::BeginDisabled(features.busy());
  featureFields(features.options);
  actionButton("Find##features", Action::kFindFeatures, context.act);
  ImGui::BeginDisabled(features.found() == nullptr);
  sameLineIfFits("Copy");
  if (pressButton("Copy##features", "The table as text, a row for each, with units in its first row."))
    ImGui::SetClipboardText(featureCsv(*features.found()).c_str());
  sameLineIfFits("Export ...");
  actionButton("Export ...##features", Action::kExportFeatures, context.act);
  sameLineIfFits("Remove");
  if (pressButton("Remove##features", "Forgets the features and their colours.")) {
    features.clear();
    picture.refreshRanges();
    picture.requestRedraw();
  }
  if (tickBox("colours show heights above saddles", features.shown,
              "Each feature has the colour of its height over its saddle; the rest has none. Marks are "
              "outlines meanwhile, unless a tool sets them.")) {
    picture.refreshRanges();
    picture.requestRedraw();
  }
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  beginPlace("##features", features.busy() || features.found() != nullptr ? kFoundLines : kUnfoundLines);
  if (features.busy()) {
    if (cancelledBar(features.progress(), "finding", "Cancel##features")) features.cancel();
  } else if (features.found() != nullptr) {
    outcome(context, features);
  } else {
    writeIn(render::PanelColour::kMuted,
            "Hills or dales by watersheds, as ISO 25178-2 counts them: where each is, how high, how large.");
  }
  endPlace();
}

}  // namespace fettle::app
