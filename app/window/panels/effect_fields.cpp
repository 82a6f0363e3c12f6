// Effects of the scene, and all that a scene says of those it lists: laid out by its tables.
#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/scene_edits.h"

namespace fettle::app {
namespace {

// The title of an effect whose word has an underscore: the list of texts has words alone.
[[maybe_unused]] constexpr const char* kEdgeSnap = textOf("edge snap");

std::string titleOfEffect(std::string_view word) {
  std::string title(word);
  std::ranges::replace(title, '_', ' ');
  return std::string(tr(std::string_view(title)));
}

std::string numberTip(const LoopClient& client, const haptic::SceneNumber& number) {
  std::string tip = trFormat("{} {}; {:.4g} unless a scene says otherwise.", tr(number.says),
                             rangeInWords(number), unlessSaid(client, number));
  if (const auto held = largestHeld(client, number))
    tip += trFormat(" The {} holds {:.4g} {} at most with the rest of the scene.",
                    client.device().profile().name, *held, number.unit);
  return tip;
}

void wordField(const PanelContext& context, const haptic::SceneWord& word) {
  haptic::Scene scene = context.client.scene();
  const std::size_t now = word.of(scene);
  fieldName(word.name.data(), word.says);
  if (beginList(fmt::format("##{} {}", word.table, word.key).c_str(), tr(word.words[now].data()))) {
    for (std::size_t i = 0; i < word.words.size(); ++i)
      if (ImGui::Selectable(labelOf(word.words[i].data()), i == now) && i != now) {
        word.set(scene, i);
        applyScene(context.client, scene, context.notices);
      }
    ImGui::EndCombo();
  } else {
    explain(word.says);
  }
}

// The words and numbers of a table of the scene file.
void tableFields(const PanelContext& context, std::string_view table, const std::string& title) {
  const auto isOf = [&](const auto& row) { return row.table == table; };
  if (std::ranges::none_of(haptic::kSceneNumbers, isOf) && std::ranges::none_of(haptic::kSceneWords, isOf))
    return;
  ImGui::TextUnformatted((title + ":").c_str());
  beginFields();
  for (const haptic::SceneWord& word : haptic::kSceneWords)
    if (isOf(word)) wordField(context, word);
  for (const haptic::SceneNumber& number : haptic::kSceneNumbers)
    if (isOf(number)) sceneNumberField(context, number);
  endFields();
}

}  // namespace

void sceneNumberField(const PanelContext& context, const haptic::SceneNumber& number) {
  LoopClient& client = context.client;
  const std::string id = fmt::format("##{} {}", number.table, number.key);
  const std::string format = number.unit.empty() ? "%.4g" : fmt::format("%.4g {}", number.unit);
  fieldName(number.name.data(), number.says);
  const NumberInField typed = typingNumber(id.c_str(), number.of(client.scene()), format);
  if (const std::string problem = typed.so_far ? numberProblem(client, number, *typed.so_far) : "";
      !problem.empty())
    problemBeside(problem);
  else if (ImGui::IsItemHovered())
    explain(numberTip(client, number));
  if (typed.done) setNumber(client, number, *typed.done, context.notices);
}

void effectTicks(const PanelContext& context) {
  ImGui::TextDisabled("%s", tr("effects"));
  for (int i = 0; i < haptic::kEffectKinds; ++i) {
    const auto kind = static_cast<haptic::EffectKind>(i);
    bool on = context.client.scene().lists(kind);
    // In two columns, or in one where the panels are narrow.
    const float half = 0.5F * ImGui::GetWindowWidth();
    if (i % 2 != 0 && half > 8.0F * ImGui::GetFontSize()) ImGui::SameLine(half);
    const std::string label =
        fmt::format("{}###effect {}", titleOfEffect(haptic::effectName(kind)), haptic::effectName(kind));
    if (ImGui::Checkbox(label.c_str(), &on)) listEffect(context.client, kind, on, context.notices);
    explain(haptic::rowOf(kind).says);
  }
}

void effectFields(const PanelContext& context) {
  using haptic::EffectKind;
  // A field may change the scene: the list of before is laid out to its end.
  const std::vector<EffectKind> listed = context.client.scene().effects;
  for (const EffectKind kind : listed)
    tableFields(context, haptic::effectName(kind), titleOfEffect(haptic::effectName(kind)));
  const auto lists = [&](EffectKind kind) { return std::ranges::find(listed, kind) != listed.end(); };
  if (lists(EffectKind::kViscosity) || lists(EffectKind::kCoupling))
    tableFields(context, "velocity", tr("speed of viscosity and coupling"));
}

}  // namespace fettle::app
