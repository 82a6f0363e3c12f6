#include "app/window/device_buttons.h"

#include <string>

#include "app/texts/texts.h"
#include "app/window/actions.h"
#include "app/window/scene_edits.h"
#include "app/work/tips.h"
#include "haptic/base/tools.h"

namespace fettle::app {

namespace {

// The tools around the tip: `asked` times since the last frame.
void followTools(Parts& parts, std::uint64_t asked) {
  RadialMenu& menu = parts.radial;
  if (asked == 0 && !menu.ofDevice()) return;
  LoopClient& client = *parts.document.client();
  const haptic::LoopState state = client.state();
  const auto tip = parts.picture.placeOf(state.contact ? state.proxy_mm : state.endpoint_mm);
  const auto pointed = menu.pointed();
  RadialMenu::Outcome outcome;
  if (menu.ofDevice()) {
    if (tip) menu.follow(*tip);
    if (asked > 0) outcome = menu.pressAgain();
  } else if (tip && !menu.active()) {
    menu.open(*tip, parts.window.pictureArea(), parts.window.scale(), RadialMenu::By::kDevice);
  }
  const bool held = (state.buttons & client.deviceSetup().menu_buttons) != 0;
  if (menu.ofDevice() && !held) outcome = menu.letGo();
  if (asked > 0 || outcome.used || menu.pointed() != pointed) parts.picture.requestRedraw();
  if (outcome.chosen) carryOut(*outcome.chosen, parts);
}

}  // namespace

void followButtons(Parts& parts) {
  LoopClient& client = *parts.document.client();
  const DeviceChoices chosen = client.takeDeviceChoices();
  if (parts.feedback.questions.pending()) return;
  followTools(parts, chosen.menus);
  for (std::uint64_t i = 0; i < chosen.tools; ++i) {
    carryOut(actionOf(static_cast<haptic::Tool>((static_cast<int>(client.tool()) + 1) % haptic::kTools)),
             parts);
    parts.feedback.status = trFormat("tool: {}", tr(haptic::rowOf(client.tool()).title));
  }
  for (std::uint64_t i = 0; i < chosen.tips; ++i) {
    const ChosenTip next = nextTip(client.scene(), client.field().grid());
    applyScene(client, next.scene, parts.feedback.notices);
    if (client.scene() == next.scene) parts.feedback.status = trFormat("tip: {}", next.name);
    parts.picture.requestRedraw();
  }
}

}  // namespace fettle::app
