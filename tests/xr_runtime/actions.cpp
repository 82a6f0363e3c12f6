#include <cstdio>

#include "tests/xr_runtime/runtime.h"

namespace fettle::tests::xr {

namespace {

// The hand of a path: "left" of "/user/hand/left/input/trigger/value", and also of "/user/hand/left".
std::string handOf(const std::string& path) {
  for (const char* hand : {"left", "right"})
    if (path.find(std::string("/user/hand/") + hand) == 0) return hand;
  return {};
}

// What the script calls an input: "trigger" of ".../input/trigger/value", "scroll" of
// a thumbstick's y, "button" of any other that clicks.
std::string componentOf(const std::string& path) {
  for (const char* part : {"trigger", "squeeze", "select"})
    if (path.find(std::string("/input/") + part + "/") != std::string::npos)
      return std::string(part) == "select" ? "trigger" : part;
  if (path.find("/input/thumbstick/y") != std::string::npos) return "scroll";
  return path.find("/click") != std::string::npos ? "button" : std::string();
}

XRAPI_ATTR XrResult XRAPI_CALL createActionSet(XrInstance, const XrActionSetCreateInfo* info,
                                               XrActionSet* set) {
  runtime().say(std::string("actions ") + info->actionSetName);
  *set = reinterpret_cast<XrActionSet>(0x3);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroyActionSet(XrActionSet) {
  return XR_SUCCESS;
}

Action* of(XrAction handle) {
  return reinterpret_cast<Action*>(handle);
}

XRAPI_ATTR XrResult XRAPI_CALL createAction(XrActionSet, const XrActionCreateInfo* info, XrAction* action) {
  Runtime& r = runtime();
  if (r.attached)
    return r.wrong("an action is made after they were attached", XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
  *action = reinterpret_cast<XrAction>(new Action{info->actionType, info->actionName, {}});
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroyAction(XrAction action) {
  delete of(action);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL suggestBindings(XrInstance,
                                               const XrInteractionProfileSuggestedBinding* suggested) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.attached)
    return r.wrong("bindings are suggested after actions were attached",
                   XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
  r.suggested[suggested->interactionProfile].assign(
      suggested->suggestedBindings, suggested->suggestedBindings + suggested->countSuggestedBindings);
  r.say("bindings for " + r.pathOf(suggested->interactionProfile));
  return XR_SUCCESS;
}

constexpr const char* kTouch = "/interaction_profiles/oculus/touch_controller";

XRAPI_ATTR XrResult XRAPI_CALL attachActionSets(XrSession, const XrSessionActionSetsAttachInfo*) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.attached) return r.wrong("actions are attached twice", XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
  r.attached = true;
  // The scripted hands hold Touch controllers, or the simple ones where a program knows no other.
  for (const auto& [profile, bindings] : r.suggested) {
    if (r.pathOf(profile) != kTouch && r.suggested.size() > 1) continue;
    for (const XrActionSuggestedBinding& binding : bindings) {
      const std::string path = r.pathOf(binding.binding);
      of(binding.action)->bound[handOf(path)] = componentOf(path);
    }
  }
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL currentProfile(XrSession, XrPath, XrInteractionProfileState* state) {
  state->interactionProfile = XR_NULL_PATH;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL syncActions(XrSession, const XrActionsSyncInfo*) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (!r.attached) return r.wrong("actions are read that were not attached", XR_ERROR_ACTIONSET_NOT_ATTACHED);
  r.synced = r.frame;
  return r.state == XR_SESSION_STATE_FOCUSED ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

// The value of an action for a hand; false where it is not active.
bool read(const XrActionStateGetInfo& info, double& value) {
  const Runtime& r = runtime();
  const std::string hand = handOf(r.pathOf(info.subactionPath));
  const Action& action = *of(info.action);
  Place at;
  if (r.state != XR_SESSION_STATE_FOCUSED || action.bound.count(hand) == 0 ||
      !r.script.place(hand, r.frame, at))
    return false;
  value = r.script.value(hand + " " + action.bound.at(hand), r.synced);
  return true;
}

XRAPI_ATTR XrResult XRAPI_CALL stateBoolean(XrSession, const XrActionStateGetInfo* info,
                                            XrActionStateBoolean* state) {
  const std::lock_guard lock(runtime().mutex);
  double value = 0.0;
  state->isActive = read(*info, value);
  state->currentState = value > 0.5;
  state->changedSinceLastSync = XR_FALSE;
  state->lastChangeTime = 0;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL stateFloat(XrSession, const XrActionStateGetInfo* info,
                                          XrActionStateFloat* state) {
  const std::lock_guard lock(runtime().mutex);
  double value = 0.0;
  state->isActive = read(*info, value);
  state->currentState = static_cast<float>(value);
  state->changedSinceLastSync = XR_FALSE;
  state->lastChangeTime = 0;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL statePose(XrSession, const XrActionStateGetInfo* info,
                                         XrActionStatePose* state) {
  const std::lock_guard lock(runtime().mutex);
  double value = 0.0;
  state->isActive = read(*info, value);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL applyHaptics(XrSession, const XrHapticActionInfo* info,
                                            const XrHapticBaseHeader* feedback) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  const auto* vibration = reinterpret_cast<const XrHapticVibration*>(feedback);
  if (vibration->type != XR_TYPE_HAPTIC_VIBRATION ||
      !(vibration->amplitude >= 0.0F && vibration->amplitude <= 1.0F))
    return r.wrong("a vibration out of range", XR_ERROR_VALIDATION_FAILURE);
  char line[80];
  std::snprintf(line, sizeof(line), "haptics %s %.3f in frame %ld",
                handOf(r.pathOf(info->subactionPath)).c_str(), static_cast<double>(vibration->amplitude),
                r.frame);
  r.say(line);
  return r.state == XR_SESSION_STATE_FOCUSED ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

XRAPI_ATTR XrResult XRAPI_CALL stopHaptics(XrSession, const XrHapticActionInfo* info) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  r.say("haptics " + handOf(r.pathOf(info->subactionPath)) + " stopped in frame " + std::to_string(r.frame));
  return XR_SUCCESS;
}

}  // namespace

void addActionCalls(Calls& calls) {
  calls["xrCreateActionSet"] = asVoid(&createActionSet);
  calls["xrDestroyActionSet"] = asVoid(&destroyActionSet);
  calls["xrCreateAction"] = asVoid(&createAction);
  calls["xrDestroyAction"] = asVoid(&destroyAction);
  calls["xrSuggestInteractionProfileBindings"] = asVoid(&suggestBindings);
  calls["xrAttachSessionActionSets"] = asVoid(&attachActionSets);
  calls["xrGetCurrentInteractionProfile"] = asVoid(&currentProfile);
  calls["xrSyncActions"] = asVoid(&syncActions);
  calls["xrGetActionStateBoolean"] = asVoid(&stateBoolean);
  calls["xrGetActionStateFloat"] = asVoid(&stateFloat);
  calls["xrGetActionStatePose"] = asVoid(&statePose);
  calls["xrApplyHapticFeedback"] = asVoid(&applyHaptics);
  calls["xrStopHapticFeedback"] = asVoid(&stopHaptics);
}

}  // namespace fettle::tests::xr
