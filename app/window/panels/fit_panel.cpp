#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

// Lines of the outcome from when shapes are fitted, and before.
constexpr int kFittedLines = 16, kUnfittedLines = 3;

void fitFields(FitTool::Options& options) {
  beginFields();
  (void)field("shape",
              "The simplest: one is taken in place of a simpler one only where it lowers the rms by a tenth.",
              [&] {
                const std::string now =
                    options.shape ? std::string(tr(engine::infoOf(*options.shape).word)) : tr("the simplest");
                if (!beginList("##fitted shape", now.c_str())) return false;
                if (ImGui::Selectable(labelOf("the simplest"), !options.shape)) options.shape.reset();
                for (const engine::ShapeInfo& info : engine::shapeInfos())
                  if (ImGui::Selectable(labelOf(std::string(info.word).c_str()), options.shape == info.kind))
                    options.shape = info.kind;
                ImGui::EndCombo();
                return true;
              });
  (void)field("to", "Which samples the shape is fitted to.", [&] {
    constexpr std::optional<engine::Region> kOf[] = {std::nullopt, engine::Region::kAll,
                                                     engine::Region::kMarked, engine::Region::kUnmarked};
    int of = static_cast<int>(std::ranges::find(kOf, options.region) - std::begin(kOf));
    const bool changed = chooseWord(
        "##fitted to", of, {"marked, else all", "all samples", "marked samples", "samples not marked"});
    if (changed) options.region = kOf[of];
    return changed;
  });
  endFields();
  tickBox("between edge lines, each by itself", options.between_lines,
          "What edge lines enclose is a region of its own, two samples from them. Without lines all is one.");
  tickBox("without samples far from it##fit", options.robust,
          "Half of the samples must be near to the shape.");
  tickBox("distances along z##fit", options.vertical,
          "In which a scanner has its noise; else the shortest to the shape, as the standards of coordinate "
          "metrology have it.");
}

void fitTable(const std::vector<FitLine>& lines, const char* id) {
  if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg)) return;
  for (const FitLine& line : lines) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(std::string(tr(std::string_view(line.name))).c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(screenText(line.text).c_str());
  }
  ImGui::EndTable();
}

// Angle and distance between two of several.
void pairFields(FitTool& fit) {
  if (!fit.pair()) return;
  std::size_t first = fit.pair()->first, second = fit.pair()->second;
  const std::vector<FittedRegion>& fitted = fit.fits()->fitted;
  const auto choose = [&](const char* id, std::size_t& now, std::size_t other) {
    const auto name = [&](std::size_t i) {
      return trFormat("region {}: {}", fitted[i].number,
                      tr(engine::infoOf(fitted[i].chosen.fit.shape.kind).word));
    };
    if (!beginList(id, name(now).c_str())) return false;
    bool changed = false;
    for (std::size_t i = 0; i < fitted.size(); ++i)
      if (i != other && ImGui::Selectable(name(i).c_str(), i == now)) {
        now = i;
        changed = true;
      }
    ImGui::EndCombo();
    return changed;
  };
  beginFields();
  bool changed = field("between", "The first of two fits whose angle and distance stand below.",
                       [&] { return choose("##first fit", first, second); });
  changed =
      field("and", "The second of these fits.", [&] { return choose("##second fit", second, first); }) ||
      changed;
  endFields();
  if (changed) fit.setPair(first, second);
  fitTable(relationLines(fit.fits()->report["between"]), "relation");
}

const char* fittedTo(engine::Region region) {
  switch (region) {
    case engine::Region::kMarked:
      return tr("fitted to the marked samples");
    case engine::Region::kUnmarked:
      return tr("fitted to the samples that are not marked");
    default:
      return tr("fitted to all samples");
  }
}

void outcome(FitTool& fit) {
  const FieldFits& fits = *fit.fits();
  if (fit.outdated()) writeWrapped("the field has changed since: Fit");
  writeIn(render::PanelColour::kMuted, std::string(fittedTo(fit.region())));
  pairFields(fit);
  int number = 0;
  for (const Report& one : fits.report["fits"]) {
    writeWrapped(fitTitle(one));
    if (const auto left = one["left_out"].get<std::int64_t>(); left > 0)
      writeWrapped(trFormat("{} samples lie apart and do not count", left));
    fitTable(fitLines(one), trFormat("fit {}", ++number).c_str());
  }
  if (const std::string noise = errorNoiseText(fits.report); !noise.empty())
    writeIn(render::PanelColour::kMuted, trFormat("errors are by the {}", noise));
  for (const std::string& warning : fits.warnings) writeIn(render::PanelColour::kWarning, warning);
  for (const Report& one : fits.report["not_fitted"])
    writeIn(render::PanelColour::kMuted,
            trFormat("region {}: {}", one["region"].get<int>(), one["reason"].get<std::string>()));
}

// As it stands in the panel, in columns: units and errors as on the screen, those of files are in ASCII.
std::string copiedText(const FieldFits& fits) {
  std::string text;
  const auto add = [&text](const std::vector<FitLine>& lines) {
    for (const FitLine& line : lines) text += fmt::format("{}\t{}\n", line.name, line.text);
  };
  for (const Report& one : fits.report["fits"]) {
    text += fitTitle(one) + "\n";
    add(fitLines(one));
  }
  if (!fits.report.contains("between")) return screenText(text);
  const Report& between = fits.report["between"];
  text += trFormat("between {} and {}\n", between["first"].get<int>(), between["second"].get<int>());
  add(relationLines(between));
  return screenText(text);
}

}  // namespace

void fitPanel(const PanelContext& context, FitTool& fit, WindowPicture& picture) {
  fitFields(fit.options);
  ImGui::BeginDisabled(fit.busy());
  actionButton("Fit##shapes", Action::kFitShapes, context.act);
  ImGui::BeginDisabled(fit.fits() == nullptr);
  sameLineIfFits("Copy");
  if (pressButton("Copy##fits", "The figures as text in columns, for a table or a message."))
    ImGui::SetClipboardText(copiedText(*fit.fits()).c_str());
  sameLineIfFits("Export ...");
  actionButton("Export ...##fits", Action::kExportFits, context.act);
  sameLineIfFits("Remove");
  if (pressButton("Remove##fits", "Forgets the fits and their colours.")) {
    fit.clear();
    picture.refreshRanges();
    picture.requestRedraw();
  }
  if (tickBox("colours show the distances from it", fit.shown,
              "Red where the surface lies above the shape, blue where it lies below. Marks are "
              "outlines meanwhile, unless a tool sets them.")) {
    picture.refreshRanges();
    picture.requestRedraw();
  }
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  beginPlace("##fits", fit.busy() || fit.fits() != nullptr ? kFittedLines : kUnfittedLines);
  if (fit.busy()) {
    if (cancelledBar(fit.progress(), "fitting", "Cancel##fits")) fit.cancel();
  } else if (fit.fits() != nullptr) {
    outcome(fit);
  } else {
    writeIn(
        render::PanelColour::kMuted,
        "Plane, sphere, cylinder, cone or torus nearest to the samples. Here stand their sizes and places "
        "with standard errors.");
  }
  endPlace();
}

}  // namespace fettle::app
