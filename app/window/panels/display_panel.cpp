#include <cmath>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/panels.h"
#include "app/window/panels/slider.h"
#include "render/plan/material.h"

namespace fettle::app {

namespace {

// A share of 0 to 1; 0 reads "off".
void shareSlider(const char* label, const char* id, double& share, const char* tip) {
  auto value = static_cast<float>(share);
  if (field(label, tip, [&] { return slider(id, value, 0.0F, 1.0F, value > 0.0F ? "%.2f" : tr("off")); }))
    share = static_cast<double>(value);
}

void materialFields(render::FormShading& form) {
  const render::MaterialRow& chosen = render::rowOf(form.material);
  if (field(
          "material",
          "What the surface looks like to be made of. A material is lit from beside you, however the view is "
          "turned, and shows form better than colours do.",
          [&] { return beginList("##material", std::string(tr(chosen.word)).c_str()); })) {
    for (const render::MaterialRow& row : render::materials()) {
      const bool is = row.material == form.material;
      if (ImGui::Selectable(fmt::format("{}: {}", tr(row.word), tr(row.shows)).c_str(), is))
        form.material = row.material;
      if (is) ImGui::SetItemDefaultFocus();
    }
    ImGui::EndCombo();
  }
  ImGui::BeginDisabled(form.material == render::Material::kNone);
  shareSlider(
      "colours on it", "##material_colours", form.value_colours,
      "Share of the colours of heights in that of the material. Colours of changes are always there.");
  ImGui::EndDisabled();
}

void stylusTicks(StylusLook& look, bool reduced_motion) {
  tickBox("stylus as a pen", look.pen,
          "A pen whose point is where the tip is. Without it the tip is a disc.");
  sameLineIfFits("its shadow", ItemKind::kTick);
  ImGui::BeginDisabled(!look.pen);
  tickBox("its shadow", look.shadow,
          "On the surface: it meets the pen's point where that touches, and moves away as the pen rises.");
  ImGui::EndDisabled();
  tickBox("force arrow", look.force, "The force that the hand feels; the longest arrow is the force limit.");
  sameLineIfFits("trail", ItemKind::kTick);
  ImGui::BeginDisabled(reduced_motion);
  tickBox("trail", look.trail, "Where the tip was during the last second.");
  ImGui::EndDisabled();
}

std::string scaleText(double scale) {
  return scale > 0.0 ? fmt::format("{:.0f} %", 100.0 * scale) : tr("as the display");
}

// Of text and panels.
void uiScaleField(double& scale) {
  static constexpr double kScales[] = {0.0, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0};
  if (field("text size", "Of all texts, panels and marks of the window; kept for the next start.",
            [&] { return beginList("##ui scale", scaleText(scale).c_str()); })) {
    for (const double each : kScales)
      if (ImGui::Selectable(scaleText(each).c_str(), each == scale)) scale = each;
    ImGui::EndCombo();
  }
}

void penFields(PenUse& pen) {
  constexpr const char* kSays = textOf(
      "A tablet's pen presses as deep as the hand presses it, up to the depth of the brush. Off: always to "
      "that "
      "depth. Its other end has the opposite tool.");
  (void)field("pen", kSays, [&] { return tickBox("presses as the hand does", pen.presses, {}); });
  ImGui::BeginDisabled(!pen.presses);
  auto firmness = static_cast<float>(pen.firmness);
  if (field("", "Above 1 the hand has to press more for the same depth, below 1 less.", [&] {
        return slider("##firmness", firmness, static_cast<float>(PenUse::kSoftest),
                      static_cast<float>(PenUse::kFirmest), trPrintf("firmness %.2f"),
                      ImGuiSliderFlags_Logarithmic);
      }))
    pen.firmness = std::round(100.0 * static_cast<double>(firmness)) / 100.0;
  ImGui::EndDisabled();
}

}  // namespace

void displayPanel(const PanelContext& context, Settings& settings, WindowPicture& picture, render::View& view,
                  ChoiceCosts& costs) {
  Display& display = settings.display;
  actionTick("scale bar and colour bar", display.decorations, Action::kDecorations, context.act);
  actionTick("light background", display.theme == render::Theme::kLight, Action::kTheme, context.act);
  actionTick("light panels", settings.panels_theme == render::Theme::kLight, Action::kPanelsTheme,
             context.act);
  actionTick("axes", display.axes, Action::kAxes, context.act);
  tickBox("reduced motion", display.reduced_motion,
          "Nothing moves by itself: the view is at another place at once, and the stylus has no trail.");
  ImGui::BeginDisabled(display.reduced_motion);
  tickBox(
      "move to views", display.flights,
      "The picture moves to another view, so that the eye can follow. Without it the other view is there at "
      "once.");
  ImGui::EndDisabled();
  tickBox("half resolution while it moves", display.half_in_motion,
          "While the view moves, every second pixel is drawn in each direction, for a higher frame rate.");
  tickBox(
      "smooth edges at rest", display.smooth_at_rest,
      "While nothing changes, the surface is drawn with four rays per pixel, band by band, so that no frame "
      "takes long.");
  tickBox(
      "light at the size of a pixel", display.form.filtered_normals,
      "Where samples are smaller than pixels, the light falls on the surface at the size of a pixel and not "
      "on the noise of single samples.");
  stylusTicks(display.stylus, display.reduced_motion);
  tickBox("ask before quitting", settings.ask_before_quitting,
          "With unsaved work. Without the question it is stored as well, and offered when the scan is opened "
          "again.");
  beginFields();
  uiScaleField(settings.ui_scale);
  penFields(settings.pen);
  detailChooser(context, display, picture, view, costs);
  int mode = static_cast<int>(display.stereo);
  if (field("eyes",
            "A picture for each eye: in two halves of the window, or in one for glasses of two colours.",
            [&] {
              return chooseWord("##eyes", mode, {"one eye", "two, side by side", "two, red-cyan glasses"});
            }))
    display.stereo = static_cast<render::StereoMode>(mode);
  (void)field("marks", "How strongly marked samples are tinted; 0 leaves the colours of the values.", [&] {
    return slider("##opacity", display.marks_opacity, 0.0F, 1.0F, trPrintf("opacity %.2f"));
  });
  (void)field(
      "light from",
      "Where the light comes from, counted from the picture's right over its top. A material has light of "
      "its own.",
      [&] { return slider("##azimuth", display.light_azimuth_deg, 0.0F, 360.0F, trPrintf("%.0f\u00b0")); });
  (void)field(
      "light above",
      "How high the light stands: low light shows faint slopes. A material has light of its own.", [&] {
        return slider("##elevation", display.light_elevation_deg, 5.0F, 90.0F, trPrintf("%.0f\u00b0"));
      });
  shareSlider("hidden light", "##occlusion", display.form.occlusion,
              "How much of the light a place loses at most to what stands around it.");
  shareSlider("hollows", "##cavity", display.form.cavity,
              "How much darker hollows and how much brighter ridges are at most.");
  materialFields(display.form);
  ImGui::BeginDisabled(display.stereo == render::StereoMode::kOff);
  (void)field(
      "depth", "Between the eyes, as a share of their distance from the field: more depth, harder to fuse.",
      [&] {
        return slider("##eye_separation", display.eye_separation, 0.005F, 0.1F, trPrintf("eyes %.3f apart"));
      });
  ImGui::EndDisabled();
  (void)field("heights",
              "Factor on heights in the picture, never on the numbers; 0 chooses one that makes the relief "
              "readable.",
              [&] {
                return typeNumber(
                    "##exaggeration", view.vertical_exaggeration, 0.0, 1e6,
                    view.vertical_exaggeration > 0.0 ? trPrintf("%.3g times") : tr("0: automatic"));
              });
  endFields();
}

}  // namespace fettle::app
