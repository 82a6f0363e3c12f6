#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

constexpr int kOutcomeOfForm = 6;  // lines

std::string shortTitle(const engine::FormInfo& form) {
  return form.degree >= 2 ? fmt::format("polynomial {}", form.degree) : std::string(form.title);
}

void formKindField(engine::FormChoice& options) {
  (void)field("form", [&] {
    if (!ImGui::BeginCombo("##form", shortTitle(engine::infoOf(options.kind)).c_str())) return false;
    for (const engine::FormInfo& form : engine::formInfos())
      if (ImGui::Selectable(shortTitle(form).c_str(), form.kind == options.kind)) options.kind = form.kind;
    ImGui::EndCombo();
    return true;
  });
}

void regionField(engine::FormChoice& options) {
  constexpr const char* kSamples[] = {"all samples", "marked samples", "samples not marked"};
  constexpr engine::Region kRegions[] = {engine::Region::kAll, engine::Region::kMarked,
                                         engine::Region::kUnmarked};
  int chosen = 0;
  for (int i = 0; i < 3; ++i)
    if (options.region == kRegions[i]) chosen = i;
  if (field("fitted to", [&] { return ImGui::Combo("##region", &chosen, kSamples, std::size(kSamples)); }))
    options.region = kRegions[chosen];
}

std::string fitText(const FormTool::Fit& fit, const render::FieldUnits& units) {
  std::string text = fmt::format("{} of {} samples\n", formName(*fit.form), fit.samples);
  if (const std::string figures = formFigures(*fit.form); !figures.empty()) text += figures + "\n";
  text += fmt::format("rms of what is left {}", lengthText(fit.rms, units.height, 3));
  if (fit.beyond > 0)
    text += fmt::format("\n{} samples lie beyond its outline: there it is continued by a plane", fit.beyond);
  return text;
}

}  // namespace

void formPanel(const PanelContext& context, FormTool& form) {
  const engine::FieldForm& over = context.client.newest().formOver();
  writeWrapped(over != nullptr ? "taken out: " + formName(*over) : std::string("nothing is taken out"));
  beginFields();
  formKindField(form.options);
  regionField(form.options);
  endFields();
  ImGui::Checkbox("without steps and spikes", &form.options.robust);
  form.followOptions(context.client);
  const bool previewed = form.previewed().has_value();
  ImGui::BeginDisabled(form.busy());
  if (ImGui::Button("Fit")) form.measure(context.client);
  // As wide with either word, so that the buttons beside it stay where they are.
  const float wide = ImGui::CalcTextSize("Drop preview").x + 2.0F * ImGui::GetStyle().FramePadding.x;
  sameLineIfFits("Drop preview");
  actionButton(previewed ? "Drop preview" : "Preview", Action::kFormPreview, context.act, wide);
  sameLineIfFits("Take out");
  actionButton("Take out", Action::kFormOut, context.act);
  ImGui::BeginDisabled(over == nullptr);
  sameLineIfFits("Put back");
  actionButton("Put back", Action::kFormBack, context.act);
  sameLineIfFits("Make it heights");
  actionButton("Make it heights", Action::kFormHeights, context.act);
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  beginPlace("##form outcome", kOutcomeOfForm);
  if (form.busy()) {
    if (cancelledBar(form.progress(), "fitting", "Cancel##form")) form.cancel();
    if (const auto& preview = form.previewed(); preview && preview->coarse)
      writeWrapped(fmt::format("preview, from means of {} x {} samples: {}", preview->coarse->step,
                               preview->coarse->step, coarseFormState(*preview->coarse)));
  } else {
    if (over != nullptr && over->shape() != nullptr) writeWrapped("taken out: " + formFigures(*over));
    if (previewed) writeWrapped("preview: colours are heights without the form, touch is with it");
    if (const auto& fit = form.fit()) writeWrapped(fitText(*fit, context.units));
  }
  endPlace();
}

}  // namespace fettle::app
