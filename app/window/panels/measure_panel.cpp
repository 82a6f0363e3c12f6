#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/curve_plot.h"
#include "app/window/panels/panels.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

// What the functional and the feature parameters are of.
void ratioFields(MeasureTool::Options& options) {
  constexpr const char* kPercent = "%.6g %%";
  beginFields();
  (void)field("peaks end at", "Material ratio where peaks end and the core begins: of Vmp, Vmc and Vvc.",
              [&] { return typeNumber("##peaks", options.peaks, 0.0, 100.0, kPercent); });
  (void)field("dales begin at", "Material ratio where the core ends and dales begin: of Vmc, Vvc and Vvv.",
              [&] { return typeNumber("##dales", options.dales, 0.0, 100.0, kPercent); });
  (void)field("features from",
              "Hills and dales that are lower than this share of Sz over their saddle are no features.",
              [&] { return typeNumber("##prune", options.prune, 0.0, 100.0, kPercent); });
  endFields();
  tickBox("height between two ratios", options.between,
          "Also Sdc, the difference of the heights at two material ratios.");
  ImGui::BeginDisabled(!options.between);
  beginFields();
  (void)field("from", "The smaller material ratio of Sdc, whose height is the larger one.",
              [&] { return typeNumber("##from ratio", options.from, 0.0, 100.0, kPercent); });
  (void)field("to", "The larger material ratio of Sdc.",
              [&] { return typeNumber("##to ratio", options.to, 0.0, 100.0, kPercent); });
  endFields();
  ImGui::EndDisabled();
}

// `unit`: of a lateral length in millimetres.
void scaleFields(MeasureTool::Options& options, const render::ShownUnit& unit) {
  constexpr double kLongest = 1e9;  // mm
  beginFields();
  (void)field("S-filter", "Waves shorter than this are taken out first, by an areal Gaussian (ISO 16610-61).",
              [&] { return typeLength("##s-filter", options.s_mm, 0.0, kLongest, unit, "none"); });
  (void)field("L-filter", "Waves longer than this are taken out after the form, by the same.",
              [&] { return typeLength("##l-filter", options.l_mm, 0.0, kLongest, unit, "none"); });
  endFields();
}

void measureFields(MeasureTool::Options& options) {
  using Where = MeasureTool::Where;
  beginFields();
  int where = static_cast<int>(options.where);
  if (field("of", "Which samples the parameters are of.", [&] {
        return chooseWord("##measured", where,
                          {"all samples", "what is visible", "marked samples", "samples not marked"});
      }))
    options.where = static_cast<Where>(where);
  (void)field("about a", "Heights are measured from this form, which is fitted to the samples first.", [&] {
    return chooseWord(
        "##measured form", options.degree,
        {"mean height", "plane", "polynomial 2", "polynomial 3", "polynomial 4", "polynomial 5"});
  });
  endFields();
  tickBox("its form without steps and spikes", options.robust,
          "Samples far from the form do not pull it; they count in the figures all the same.");
  tickBox("without noise, with errors", options.noise,
          "Below each figure a paler one: without the noise of the scan, +- its standard error.");
  tickBox("S- and L-filter", options.scales,
          "Parameters of the S-F or the S-L surface (ISO 25178-3): without noise and small detail, without "
          "waviness.");
}

// "; S-L surface", unless it is the surface about the form alone.
std::string surfaceText(const MeasureTool::Options& options) {
  if (!options.scales || (options.s_mm == 0.0 && options.l_mm == 0.0)) return {};
  return std::string("; ") + (options.l_mm == 0.0   ? tr("S-F surface")
                              : options.s_mm == 0.0 ? tr("after the L-filter")
                                                    : tr("S-L surface"));
}

void cell(const std::string& text) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(screenText(text).c_str());
}

constexpr int kCaptionLines = 2;

// "52.7 +- 0.3" in a narrow column; whole as its tip.
void withoutNoise(const std::string& text) {
  constexpr std::string_view kWithin = " +- ";
  const std::size_t at = text.find(kWithin);
  if (at == std::string::npos)
    ImGui::TextDisabled("%s", text.c_str());
  else
    ImGui::TextDisabled("%s\u00b1%s", text.substr(0, at).c_str(), text.substr(at + kWithin.size()).c_str());
  if (!text.empty() && ImGui::IsItemHovered()) valueTip(trFormat("without noise {}", text));
}

// A column for each value; with `noise` a second row for each parameter, with its figures without noise. The table has its
// rows from when it is asked for: what is below moves by that click, and not when the figures come.
void arealTable(const MeasureTool& measure, bool noise, WithSdc sdc) {
  const auto* figures = measure.figures();
  const bool before = figures && figures->before;
  if (!ImGui::BeginTable("parameters", before ? 4 : 3,
                         ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg))
    return;
  // Names and units have what they need, the figures all that is left.
  const auto narrow = [](const char* id) { ImGui::TableSetupColumn(id, ImGuiTableColumnFlags_WidthFixed); };
  narrow("##names");
  if (before) ImGui::TableSetupColumn("##before", ImGuiTableColumnFlags_WidthStretch, 1.0F);
  ImGui::TableSetupColumn("##now", ImGuiTableColumnFlags_WidthStretch, 1.0F);
  narrow("##units");
  cell("");
  if (before) cell(tr("scan"));
  cell(before ? tr("now") : tr("value"));
  cell("");
  // Figures of before are pale while others are worked out, and when the field has changed.
  const bool past = figures && (measure.busy() || measure.outdated());
  const ImGuiStyle& style = ImGui::GetStyle();
  for (const ArealLine& line : figures ? figures->lines : arealNames(sdc)) {
    ImGui::TableNextRow();
    cell(line.name);
    if (ImGui::IsItemHovered()) valueTip(tr(std::string_view(line.text)));
    if (!figures) cell(measure.busy() ? "..." : "-");
    for (std::size_t i = 0; i < line.values.size(); ++i) {
      // A reason is longer than a figure: it is the tip of a dash.
      const bool stated = line.values[i].find(' ') == std::string::npos;
      ImGui::PushStyleColor(ImGuiCol_Text, style.Colors[past ? ImGuiCol_TextDisabled : ImGuiCol_Text]);
      cell(stated ? line.values[i] : "-");
      ImGui::PopStyleColor();
      if (ImGui::IsItemHovered()) {
        if (!stated)
          valueTip(line.values[i]);
        else if (!line.without[i].empty())
          valueTip(trFormat("without noise {}", line.without[i]));
      }
    }
    cell(line.unit == "degrees" ? "\u00b0" : line.unit);
    if (!noise) continue;
    ImGui::TableNextRow();
    cell("");
    for (const std::string& without : line.without) {
      ImGui::TableNextColumn();
      withoutNoise(without);
    }
  }
  ImGui::EndTable();
}

// How far the work is, or what the table below has.
void caption(MeasureTool& measure) {
  beginPlace("##measured", kCaptionLines);
  if (measure.busy()) {
    if (cancelledBar(measure.progress(), "measuring", "Cancel##measure")) measure.cancel();
  } else if (const auto* figures = measure.figures()) {
    writeWrapped(trFormat(
        "ISO 25178-2, {} samples{}", figures->samples,
        surfaceText(figures->options) + (measure.outdated() ? tr("; the field has changed since") : "")));
    // Both kinds of figures are of one noise model, and a filtered field has next to no finest detail.
    if (figures->options.noise && figures->before && !measure.outdated())
      writeIn(render::PanelColour::kMuted, "errors know no noise that filters spread");
  } else {
    writeIn(render::PanelColour::kMuted, "surface texture by ISO 25178-2");
  }
  endPlace();
}

using render::PanelColour;

// How a curve is drawn of the scan, beneath, and of the field; the second one of a state in another colour.
void addCurve(CurvePlot& plot, std::size_t state, std::size_t states, std::size_t curve, std::string name,
              std::vector<glm::dvec2> points) {
  const bool beneath = state + 1 < states;
  const PanelColour first = states > 1 ? PanelColour::kProfileNow : PanelColour::kProfile;
  if (states > 1) name = beneath ? trFormat("scan, {}", name) : trFormat("now, {}", name);
  plot.curves.push_back({std::move(points),
                         beneath      ? PanelColour::kProfileBefore
                         : curve == 0 ? first
                                      : PanelColour::kOtherCursors,
                         beneath ? 0.25F : 0.1F, std::move(name)});
}

CurvePlot abbottCurves(const std::vector<SurfaceCurves>& states, const render::ShownUnit& height) {
  CurvePlot plot{.x_name = tr("material ratio [%]"), .y_name = trFormat("height [{}]", height.name)};
  const std::vector<double> ratios = curveRatios();
  bool any = false;
  for (std::size_t s = 0; s < states.size(); ++s) {
    const std::vector<double>& heights = states[s].heights;
    std::vector<glm::dvec2> points;
    for (std::size_t i = 0; i < std::min(ratios.size(), heights.size()); ++i)
      points.emplace_back(100.0 * ratios[i], heights[i] * height.per_unit);
    // Single spikes would leave of everything else a level line.
    if (points.size() > 2) {
      const double high = points[1].y, low = points[points.size() - 2].y;
      plot.low = any ? std::min(plot.low, low) : low;
      plot.high = any ? std::max(plot.high, high) : high;
      any = true;
    }
    addCurve(plot, s, states.size(), 0, tr("height"), std::move(points));
  }
  const double room = 0.2 * (plot.high - plot.low);
  plot.low -= room;
  plot.high += room;
  return plot;
}

CurvePlot decays(const std::vector<SurfaceCurves>& states, const render::ShownUnit& length) {
  CurvePlot plot{.x_name = trFormat("distance [{}]", length.name), .y_name = tr("autocorrelation")};
  for (std::size_t s = 0; s < states.size(); ++s)
    for (std::size_t c = 0; c < states[s].decay.size(); ++c) {
      const DecayCurve& curve = states[s].decay[c];
      std::vector<glm::dvec2> points;
      for (std::size_t i = 0; i < curve.values.size(); ++i)
        points.emplace_back(static_cast<double>(i) * states[s].decay_step_mm * length.per_unit,
                            curve.values[i]);
      addCurve(plot, s, states.size(), c,
               trFormat("{}, {} from x", tr(std::string_view(curve.name)),
                        fmt::format("{:.0f}\u00b0", curve.degrees)),
               std::move(points));
    }
  return plot;
}

// `per_mm`: of the unit of heights.
CurvePlot spectra(const std::vector<SurfaceCurves>& states, const std::string& unit, double per_mm) {
  CurvePlot plot{.scale = CurvePlot::Scale::kLogarithmic,
                 .x_name = tr("frequency [1/mm]"),
                 .y_name = trFormat("power density [{} mm]", unit + "\u00b2")};
  for (std::size_t s = 0; s < states.size(); ++s)
    for (const auto& [spectrum, c] : {std::pair(&states[s].along_x, 0), {&states[s].along_y, 1}}) {
      std::vector<glm::dvec2> points;
      for (std::size_t i = 1; i < spectrum->density.size(); ++i)
        points.emplace_back(spectrum->frequency(i), spectrum->density[i] * per_mm * per_mm);
      addCurve(plot, s, states.size(), static_cast<std::size_t>(c), c == 0 ? tr("along x") : tr("along y"),
               std::move(points));
    }
  return plot;
}

// One of the curves, in a place of its own from when figures were asked for.
void surfaceCurves(const PanelContext& context, MeasureTool& measure) {
  using Curve = MeasureTool::Curve;
  constexpr int kLines = 14;  // with four curves
  int curve = static_cast<int>(measure.curve);
  beginFields();
  if (field("curve", "Over each other of the scan, wide and pale, and of the field.", [&] {
        return chooseWord("##surface curve", curve,
                          {"material ratio (Abbott)", "autocorrelation", "power spectrum"});
      }))
    measure.curve = static_cast<Curve>(curve);
  endFields();
  beginPlace("##surface curves", kLines);
  const auto* figures = measure.figures();
  if (!figures) {
    writeIn(PanelColour::kMuted, measure.busy() ? tr("measuring") : tr("no figures yet"));
  } else if (measure.curve != Curve::kAbbott && !figures->curves.back().no_decay.empty()) {
    writeIn(PanelColour::kMuted,
            trFormat("no autocorrelation and no spectrum: {}", figures->curves.back().no_decay));
  } else {
    const engine::Grid& grid = context.client.field().grid();
    const render::ShownUnit& height = context.units.height;
    curvePlot("##curve",
              measure.curve == Curve::kAbbott ? abbottCurves(figures->curves, height)
              : measure.curve == Curve::kDecay
                  ? decays(figures->curves, render::ofMillimetres(context.units.length, grid.lateral_unit.mm))
                  : spectra(figures->curves, height.name, height.per_unit / grid.height_unit.mm));
  }
  endPlace();
}

}  // namespace

void measurePanel(const PanelContext& context, MeasureTool& measure, const WindowPicture& picture) {
  measureFields(measure.options);
  ImGui::BeginDisabled(measure.busy());
  if (pressButton("Measure now", "Surface texture of the field as it is now, and of the scan beside it."))
    measure.measure(context.client, picture.seenRect(context.client.field().grid()),
                    unitRead(context.units.length), unitRead(context.units.height));
  ImGui::EndDisabled();
  sameLineIfFits("own ratios", ItemKind::kTick);
  tickBox(
      "own ratios", measure.options.own,
      "Other material ratios than 10 and 80 %, Sdc between two of them, other features than of 5 % of Sz.");
  if (measure.options.scales)
    scaleFields(measure.options,
                render::ofMillimetres(context.units.length, context.client.field().grid().lateral_unit.mm));
  if (measure.options.own) ratioFields(measure.options);
  caption(measure);
  if (measure.asked() == nullptr) return;
  const auto* figures = measure.figures();
  arealTable(measure, measure.busy() || !figures ? measure.asked()->noise : figures->options.noise,
             measure.asked()->own && measure.asked()->between ? WithSdc::kYes : WithSdc::kNo);
  surfaceCurves(context, measure);
}

}  // namespace fettle::app
