#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/action_tips.h"
#include "app/window/panels/panels.h"
#include "app/work/form_figures.h"

namespace fettle::app {
namespace {

constexpr int kOutcomeOfForm = 6;  // lines

std::string shortTitle(const engine::FormInfo& form) {
  return form.degree >= 2 ? trFormat("polynomial {}", form.degree)
                          : std::string(tr(std::string_view(form.title)));
}

constexpr const char* kByPoints = textOf("plane by three points");

void formKindField(const PanelContext& context, FormTool& form, PlanePicking& points) {
  engine::FormChoice& options = form.options;
  const bool by_points = options.through.has_value();
  const std::string now = by_points ? tr(kByPoints) : shortTitle(engine::infoOf(options.kind));
  (void)field("form", "The shape of the part that is taken out, so that colours show what deviates from it.",
              [&] {
                if (!beginList("##form", now.c_str())) return false;
                for (const engine::FormInfo& info : engine::formInfos()) {
                  if (ImGui::Selectable(shortTitle(info).c_str(), !by_points && info.kind == options.kind)) {
                    options.kind = info.kind;
                    options.through.reset();
                    points.stop();
                  }
                  if (info.kind != engine::FormKind::kPlane) continue;
                  if (ImGui::Selectable(labelOf(kByPoints), by_points) && !by_points)
                    choosePlaneByPoints(options, context.client.field().grid());
                  explain(tipOf(Action::kPlanePoints));
                }
                ImGui::EndCombo();
                return true;
              });
}

// The points of the plane as numbers, and the button to set them on the surface.
void pointFields(const PanelContext& context, FormTool& form, const PlanePicking& points) {
  constexpr double kFar = 1e12;
  engine::ThreePoints& through = *form.options.through;
  const render::ShownUnit length =
      ofMillimetres(context.units.length, context.client.field().grid().lateral_unit.mm);
  beginFields();
  for (std::size_t i = 0; i < through.at_mm.size(); ++i)
    for (const auto& [axis, value] :
         {std::pair('x', &through.at_mm[i].x), std::pair('y', &through.at_mm[i].y)}) {
      const std::string name = trFormat("{} of point {}", axis, i + 1),
                        id = fmt::format("##plane {} {}", axis, i);
      (void)field(name.c_str(), "Where this point lies on the scan.",
                  [&, value = value] { return typeLength(id.c_str(), *value, -kFar, kFar, length); });
    }
  (void)field("around each", "Heights of the samples this near to a point are averaged.", [&] {
    return typeLength("##plane radius", through.radius_mm, 0.0, kFar, length, textOf("5 samples"));
  });
  endFields();
  ImGui::BeginDisabled(form.busy());
  actionButton(points.next() ? textOf("Set them again###plane points")
                             : textOf("Set them on the surface###plane points"),
               Action::kPlanePoints, context.act);
  ImGui::EndDisabled();
}

void regionField(engine::FormChoice& options) {
  constexpr engine::Region kRegions[] = {engine::Region::kAll, engine::Region::kMarked,
                                         engine::Region::kUnmarked};
  int chosen = 0;
  for (int i = 0; i < 3; ++i)
    if (options.region == kRegions[i]) chosen = i;
  if (field("fitted to", "Which samples the form is fitted to; it is taken out of all of them.",
            [&] { return chooseRegion("##region", chosen); }))
    options.region = kRegions[chosen];
}

std::string tiltText(const engine::Tilt& tilt) {
  const auto one = [](double degrees, double error) {
    return std::isnan(error) ? fmt::format("{:.4g}", degrees)
                             : fmt::format("{:.4g} +- {:.2g}", degrees, error);
  };
  return trFormat("tilted {} degrees along x, {} degrees along y\n", one(tilt.x_deg, tilt.x_error_deg),
                  one(tilt.y_deg, tilt.y_error_deg));
}

std::string fitText(const FormTool::Fit& fit, const render::FieldUnits& units) {
  std::string text = trFormat("{} of {} samples\n", formName(*fit.form), fit.samples);
  text += fit.options.through && fit.tilt ? tiltText(*fit.tilt) : fit.figures + "\n";
  text += trFormat("rms of what is left {}", lengthText(fit.rms, units.height, 3));
  if (fit.beyond > 0)
    text += trFormat("\n{} samples lie beyond its outline: there it is continued by a plane", fit.beyond);
  return text;
}

}  // namespace

void formPanel(const PanelContext& context, FormTool& form, PlanePicking& points) {
  const engine::FieldForm& over = context.client.newest().formOver();
  writeWrapped(over != nullptr ? trFormat("taken out: {}", formName(*over))
                               : std::string(tr("nothing is taken out")));
  beginFields();
  formKindField(context, form, points);
  regionField(form.options);
  endFields();
  ImGui::BeginDisabled(form.options.through.has_value());
  tickBox("without steps and spikes", form.options.robust,
          "Samples far from the form do not pull it: for parts with steps, holes and spikes.");
  ImGui::EndDisabled();
  if (!points.next()) form.followOptions(context.client);
  const bool previewed = form.previewed().has_value();
  ImGui::BeginDisabled(form.busy());
  if (pressButton("Fit", "Fits the form and says how much is left without it; nothing changes."))
    form.measure(context.client);
  // As wide with either word, so that the buttons beside it stay where they are.
  const float wide = ImGui::CalcTextSize(tr("Drop preview")).x + 2.0F * ImGui::GetStyle().FramePadding.x;
  sameLineIfFits("Drop preview");
  actionButton(previewed ? textOf("Drop preview") : textOf("Preview"), Action::kFormPreview, context.act,
               wide);
  sameLineIfFits("Take out");
  actionButton("Take out", Action::kFormOut, context.act);
  ImGui::BeginDisabled(over == nullptr);
  sameLineIfFits("Put back");
  actionButton("Put back", Action::kFormBack, context.act);
  sameLineIfFits("Make it heights");
  actionButton("Make it heights", Action::kFormHeights, context.act);
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  // Below the buttons: they come and go with the form that is chosen.
  if (form.options.through) pointFields(context, form, points);
  beginPlace("##form outcome", kOutcomeOfForm);
  if (form.busy()) {
    if (cancelledBar(form.progress(), "fitting", "Cancel##form")) form.cancel();
    if (const auto& preview = form.previewed(); preview && preview->coarse)
      writeWrapped(trFormat("preview, from means of {} x {} samples: {}", preview->coarse->step,
                            preview->coarse->step, coarseFormState(*preview->coarse)));
  } else {
    if (over != nullptr)
      writeWrapped(trFormat("taken out: {}", formFigures(*over, context.client.field().grid())));
    if (previewed) writeWrapped("preview: colours are heights without the form, touch is with it");
    if (const auto& fit = form.fit()) writeWrapped(fitText(*fit, context.units));
  }
  endPlace();
}

}  // namespace fettle::app
