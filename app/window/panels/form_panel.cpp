#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

void writeWrapped(const std::string& text) {
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
}

void degreeField(engine::FormOptions& options) {
  constexpr const char* kForms[] = {"mean height",  "plane",        "polynomial 2",
                                    "polynomial 3", "polynomial 4", "polynomial 5"};
  static_assert(std::size(kForms) == engine::PolynomialForm::kMostDegree + 1);
  (void)field("form", [&] { return ImGui::Combo("##form", &options.degree, kForms, std::size(kForms)); });
}

void regionField(engine::FormOptions& options) {
  constexpr const char* kSamples[] = {"all samples", "marked samples", "samples not marked"};
  constexpr engine::Region kRegions[] = {engine::Region::kAll, engine::Region::kMarked,
                                         engine::Region::kUnmarked};
  int chosen = 0;
  for (int i = 0; i < 3; ++i)
    if (options.region == kRegions[i]) chosen = i;
  if (field("fitted to", [&] { return ImGui::Combo("##region", &chosen, kSamples, std::size(kSamples)); }))
    options.region = kRegions[chosen];
}

}  // namespace

void formPanel(const PanelContext& context, FormTool& form) {
  const engine::FieldForm& over = context.client.newest().formOver();
  writeWrapped(over != nullptr ? "taken out: " + formName(*over) : std::string("nothing is taken out"));
  beginFields();
  degreeField(form.options);
  regionField(form.options);
  endFields();
  ImGui::Checkbox("without steps and spikes", &form.options.robust);
  if (form.busy()) {
    workBar(form.progress(), -ImGui::GetFontSize() * 5.0F, "fitting");
    ImGui::SameLine();
    if (ImGui::Button("Cancel##form")) form.cancel();
    return;
  }
  if (ImGui::Button("Fit")) form.measure(context.client);
  sameLineIfFits("Take out");
  actionButton("Take out", Action::kFormOut, context.act);
  if (over != nullptr) {
    sameLineIfFits("Put back");
    actionButton("Put back", Action::kFormBack, context.act);
    sameLineIfFits("Make it heights");
    actionButton("Make it heights", Action::kFormHeights, context.act);
  }
  if (const auto& fit = form.fit())
    writeWrapped(fmt::format("{} of {} samples\nrms of what is left {}", formName(*fit->form), fit->samples,
                             lengthText(fit->rms, context.units.height, 3)));
}

}  // namespace fettle::app
