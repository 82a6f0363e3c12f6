#include "app/window/device_buttons.h"

#include <string>

#include "app/window/actions.h"
#include "app/window/scene_edits.h"
#include "app/work/tips.h"
#include "haptic/base/tools.h"

namespace fettle::app {

void followButtons(Parts& parts) {
  LoopClient& client = *parts.document.client();
  const DeviceChoices chosen = client.takeDeviceChoices();
  if (parts.feedback.questions.pending()) return;
  for (std::uint64_t i = 0; i < chosen.tools; ++i) {
    carryOut(actionOf(static_cast<haptic::Tool>((static_cast<int>(client.tool()) + 1) % haptic::kTools)),
             parts);
    parts.feedback.status = "tool: " + std::string(haptic::rowOf(client.tool()).title);
  }
  for (std::uint64_t i = 0; i < chosen.tips; ++i) {
    const ChosenTip next = nextTip(client.scene(), client.field().grid());
    applyScene(client, next.scene, parts.feedback.notices);
    if (client.scene() == next.scene) parts.feedback.status = "tip: " + next.name;
    parts.picture.requestRedraw();
  }
}

}  // namespace fettle::app
