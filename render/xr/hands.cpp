#include "render/xr/hands.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

namespace fettle::render {
namespace {

constexpr std::array<const char*, 2> kHands{"/user/hand/left", "/user/hand/right"};
constexpr XrDuration kVibration_ns =
    100'000'000;  // longer than a frame takes; it ends by itself when frames stop

bool finitePose(const XrPosef& p) noexcept {
  const auto& [q, at] = p;
  return std::isfinite(q.x + q.y + q.z + q.w) && std::isfinite(at.x + at.y + at.z);
}

}  // namespace

RoomPose roomPose(const XrPosef& p) noexcept {
  const XrQuaternionf& q = p.orientation;
  return {{p.position.x, p.position.y, p.position.z}, glm::dquat(q.w, q.x, q.y, q.z)};
}

XrPosef xrPose(const RoomPose& p) noexcept {
  const auto f = [](double x) { return static_cast<float>(x); };
  return {{f(p.turn.x), f(p.turn.y), f(p.turn.z), f(p.turn.w)},
          {f(p.position_m.x), f(p.position_m.y), f(p.position_m.z)}};
}

XrPath Hands::path(const std::string& text) const {
  XrPath path = XR_NULL_PATH;
  (void)xr_->StringToPath(instance_, text.c_str(), &path);
  return path;
}

XrResult Hands::suggest(const char* profile, const std::vector<std::pair<XrAction, std::string>>& bindings) {
  std::vector<XrActionSuggestedBinding> suggested;
  suggested.reserve(bindings.size());
  for (const auto& [action, where] : bindings) suggested.push_back({action, path(where)});
  XrInteractionProfileSuggestedBinding info{XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                            path(profile), static_cast<std::uint32_t>(suggested.size()),
                                            suggested.data()};
  return xr_->SuggestInteractionProfileBindings(instance_, &info);
}

XrResult Hands::make(const XrCalls& calls, XrInstance instance, XrSession session) {
  xr_ = &calls;
  instance_ = instance;
  session_ = session;
  XrActionSetCreateInfo set{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "hands", "Hands", 0};
  XrResult result = xr_->CreateActionSet(instance, &set, &set_);
  if (XR_FAILED(result)) return result;
  std::array<XrPath, 2> both{};
  for (std::size_t i = 0; i < both.size(); ++i) both[i] = hands_[i].path = path(kHands[i]);
  const auto action = [&](const char* name, const char* shown, XrActionType type, XrAction& made) {
    if (XR_FAILED(result)) return;
    XrActionCreateInfo info{XR_TYPE_ACTION_CREATE_INFO, nullptr, "", type, 2, both.data(), ""};
    std::strncpy(info.actionName, name, sizeof(info.actionName) - 1);
    std::strncpy(info.localizedActionName, shown, sizeof(info.localizedActionName) - 1);
    result = xr_->CreateAction(set_, &info, &made);
  };
  action("grip", "Hand", XR_ACTION_TYPE_POSE_INPUT, grip_);
  action("aim", "Tip", XR_ACTION_TYPE_POSE_INPUT, aim_);
  action("trigger", "Use the tool", XR_ACTION_TYPE_FLOAT_INPUT, trigger_);
  action("squeeze", "Hold the field", XR_ACTION_TYPE_FLOAT_INPUT, squeeze_);
  action("button", "Change the scale", XR_ACTION_TYPE_BOOLEAN_INPUT, button_);
  action("scroll", "Scroll the panels", XR_ACTION_TYPE_FLOAT_INPUT, scroll_);
  action("vibration", "Contact", XR_ACTION_TYPE_VIBRATION_OUTPUT, vibration_);
  if (XR_FAILED(result)) return result;

  std::vector<std::pair<XrAction, std::string>> simple, touch;
  for (const char* hand : kHands) {
    const std::string at = hand;
    for (auto* list : {&simple, &touch}) {
      list->emplace_back(grip_, at + "/input/grip/pose");
      list->emplace_back(aim_, at + "/input/aim/pose");
      list->emplace_back(vibration_, at + "/output/haptic");
    }
    simple.emplace_back(trigger_, at + "/input/select/click");
    simple.emplace_back(button_, at + "/input/menu/click");
    touch.emplace_back(trigger_, at + "/input/trigger/value");
    touch.emplace_back(squeeze_, at + "/input/squeeze/value");
    touch.emplace_back(scroll_, at + "/input/thumbstick/y");
  }
  touch.emplace_back(button_, "/user/hand/left/input/x/click");
  touch.emplace_back(button_, "/user/hand/right/input/a/click");
  result = suggest("/interaction_profiles/khr/simple_controller", simple);
  if (XR_FAILED(result)) return result;
  result = suggest("/interaction_profiles/oculus/touch_controller", touch);
  if (XR_FAILED(result)) return result;

  const auto space = [&](XrAction of, XrPath hand, XrSpace& made) {
    XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, of, hand, xrPose({})};
    if (XR_SUCCEEDED(result)) result = xr_->CreateActionSpace(session_, &info, &made);
  };
  for (Hand& hand : hands_) {
    space(grip_, hand.path, hand.grip);
    space(aim_, hand.path, hand.aim);
  }
  if (XR_FAILED(result)) return result;
  XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set_};
  return xr_->AttachSessionActionSets(session_, &attach);
}

void Hands::destroy() {
  if (set_ == XR_NULL_HANDLE) return;
  for (const Hand& hand : hands_)
    for (XrSpace space : {hand.grip, hand.aim})
      if (space != XR_NULL_HANDLE) (void)xr_->DestroySpace(space);
  // The actions go with their set.
  (void)xr_->DestroyActionSet(set_);
  set_ = XR_NULL_HANDLE;
}

XrResult Hands::read(XrSpace room, XrTime time, RoomHands& hands) {
  hands = {};
  const XrActiveActionSet active{set_, XR_NULL_PATH};
  const XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
  const XrResult synced = xr_->SyncActions(session_, &sync);
  // Without the focus another program has the hands.
  if (XR_FAILED(synced) || synced == XR_SESSION_NOT_FOCUSED) return synced;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    RoomHand& hand = hands[i];
    const auto locate = [&](XrSpace space, RoomPose& pose) {
      XrSpaceLocation at{XR_TYPE_SPACE_LOCATION, nullptr, 0, {}};
      const XrResult result = xr_->LocateSpace(space, room, time, &at);
      // A place that is valid and not tracked is a guess, by a model of the arm or the last one seen: no tool may follow it.
      constexpr XrSpaceLocationFlags kKnown = XR_SPACE_LOCATION_POSITION_VALID_BIT |
                                              XR_SPACE_LOCATION_ORIENTATION_VALID_BIT |
                                              XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
      if (XR_FAILED(result) || (at.locationFlags & kKnown) != kKnown || !finitePose(at.pose)) return false;
      pose = roomPose(at.pose);
      return true;
    };
    const auto value = [&](XrAction action) {
      XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, hands_[i].path};
      XrActionStateFloat state{XR_TYPE_ACTION_STATE_FLOAT, nullptr, 0.0F, XR_FALSE, 0, XR_FALSE};
      const XrResult result = xr_->GetActionStateFloat(session_, &info, &state);
      return XR_SUCCEEDED(result) && state.isActive != XR_FALSE ? static_cast<double>(state.currentState)
                                                                : 0.0;
    };
    hand.tracked = locate(hands_[i].aim, hand.aim) && locate(hands_[i].grip, hand.grip);
    hand.trigger = std::clamp(value(trigger_), 0.0, 1.0);
    hand.squeeze = std::clamp(value(squeeze_), 0.0, 1.0);
    hand.scroll = std::clamp(value(scroll_), -1.0, 1.0);
    XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, button_, hands_[i].path};
    XrActionStateBoolean state{XR_TYPE_ACTION_STATE_BOOLEAN, nullptr, XR_FALSE, XR_FALSE, 0, XR_FALSE};
    hand.button = XR_SUCCEEDED(xr_->GetActionStateBoolean(session_, &info, &state)) &&
                  state.isActive != XR_FALSE && state.currentState != XR_FALSE;
  }
  return synced;
}

XrResult Hands::vibrate(std::size_t hand, double amplitude) {
  Hand& at = hands_[hand];
  if (amplitude <= 0.0 && at.amplitude <= 0.0) return XR_SUCCESS;
  at.amplitude = std::clamp(amplitude, 0.0, 1.0);
  const XrHapticActionInfo info{XR_TYPE_HAPTIC_ACTION_INFO, nullptr, vibration_, at.path};
  if (at.amplitude <= 0.0) return xr_->StopHapticFeedback(session_, &info);
  const XrHapticVibration vibration{XR_TYPE_HAPTIC_VIBRATION, nullptr, kVibration_ns,
                                    XR_FREQUENCY_UNSPECIFIED, static_cast<float>(at.amplitude)};
  return xr_->ApplyHapticFeedback(session_, &info, reinterpret_cast<const XrHapticBaseHeader*>(&vibration));
}

}  // namespace fettle::render
