#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/slider.h"

namespace fettle::app {

namespace {
constexpr int kOutcomeOfEdges = 2;  // lines
}

void edgePanel(const PanelContext& context, EdgeTool& edges) {
  using engine::EdgeResponse;
  beginFields();
  auto sigma = static_cast<float>(edges.sigma);
  if (field("scale",
            "Over how many samples an edge may rise: larger scales see through noise and lose fine edges.",
            [&] {
              return slider("##scale", sigma, static_cast<float>(EdgeResponse::kSmallestSigma),
                            static_cast<float>(EdgeResponse::kLargestSigma), trPrintf("%.2f samples"),
                            ImGuiSliderFlags_Logarithmic);
            }))
    edges.sigma = static_cast<double>(sigma);
  const bool scale_done = ImGui::IsItemDeactivatedAfterEdit();
  auto sensitivity = static_cast<float>(edges.choice.sensitivity);
  if (field("sensitivity", "How faint an edge may be that is still suggested: 1 suggests most.",
            [&] { return slider("##sensitivity", sensitivity, 0.0F, 1.0F, "%.2f"); })) {
    edges.choice.sensitivity = static_cast<double>(sensitivity);
    edges.redraw(context.client);
  }
  auto thickness = static_cast<float>(edges.choice.thickness);
  if (field("thickness", "How wide the marks along an edge become; within them heights stay as they are.",
            [&] { return slider("##thickness", thickness, 0.0F, 16.0F, trPrintf("%.1f samples")); })) {
    edges.choice.thickness = static_cast<double>(thickness);
    edges.redraw(context.client);
  }
  endFields();
  if (edges.on() && scale_done) edges.search(context.client);
  const engine::EdgeSuggestion* const found = edges.suggestion();
  ImGui::BeginDisabled(edges.on());
  actionButton("Suggest edges", Action::kEdges, context.act);
  ImGui::EndDisabled();
  ImGui::BeginDisabled(found == nullptr);
  sameLineIfFits("Take");
  actionButton("Take", Action::kFilterApply, context.act);
  sameLineIfFits("Drop");
  actionButton("Drop", Action::kNavigate, context.act);
  ImGui::EndDisabled();
  beginPlace("##edges outcome", kOutcomeOfEdges);
  if (found != nullptr)
    writeWrapped(trFormat("{} lines, {} samples, not marked yet: take them, or paint over them", found->lines,
                          found->samples));
  else if (edges.busy() && cancelledBar(edges.progress(), "looking", "Cancel"))
    edges.drop();
  endPlace();
}

}  // namespace fettle::app
