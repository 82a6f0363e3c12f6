#include <cmath>
#include <limits>
#include <numbers>

#include "tests/xr_runtime/runtime.h"

namespace fettle::tests::xr {

namespace {

// Between the eyes, and the half angles of their pictures: wider to the outside, as in headsets.
constexpr double kBetweenEyes_m = 0.064;
constexpr float kOut = 0.80F, kIn = 0.65F, kUp = 0.75F, kDown = 0.85F;

XrQuaternionf product(const XrQuaternionf& a, const XrQuaternionf& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Space* of(XrSpace handle) {
  return reinterpret_cast<Space*>(handle);
}

// A space in the room; false where it is not tracked.
bool inRoom(const Space& space, XrPosef& pose) {
  Runtime& r = runtime();
  pose = {{0, 0, 0, 1}, {0, 0, 0}};
  if (space.is_action || space.reference == XR_REFERENCE_SPACE_TYPE_VIEW) {
    Place at;
    if (!r.script.place(space.is_action ? space.hand : "head", r.frame, at)) return false;
    pose = poseOf(at);
  }
  pose = times(pose, space.offset);
  return true;
}

XRAPI_ATTR XrResult XRAPI_CALL referenceSpaces(XrSession, std::uint32_t capacity, std::uint32_t* count,
                                               XrReferenceSpaceType* to) {
  return giveList<XrReferenceSpaceType>(
      {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL, XR_REFERENCE_SPACE_TYPE_STAGE}, capacity,
      count, to);
}

XRAPI_ATTR XrResult XRAPI_CALL createReferenceSpace(XrSession, const XrReferenceSpaceCreateInfo* info,
                                                    XrSpace* space) {
  *space = reinterpret_cast<XrSpace>(
      new Space{false, info->referenceSpaceType, info->poseInReferenceSpace, std::string()});
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL stageBounds(XrSession, XrReferenceSpaceType, XrExtent2Df* bounds) {
  *bounds = {0, 0};
  return XR_SPACE_BOUNDS_UNAVAILABLE;
}

XRAPI_ATTR XrResult XRAPI_CALL createActionSpace(XrSession, const XrActionSpaceCreateInfo* info,
                                                 XrSpace* space) {
  const std::string path = runtime().pathOf(info->subactionPath);
  *space = reinterpret_cast<XrSpace>(new Space{true, XR_REFERENCE_SPACE_TYPE_LOCAL, info->poseInActionSpace,
                                               path.substr(path.rfind('/') + 1)});
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL destroySpace(XrSpace space) {
  delete of(space);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL locateSpace(XrSpace space, XrSpace base, XrTime time,
                                           XrSpaceLocation* location) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (time <= 0) return r.wrong("a space is located at no time", XR_ERROR_TIME_INVALID);
  XrPosef a, b;
  location->locationFlags = 0;
  location->pose = {{0, 0, 0, 1}, {0, 0, 0}};
  if (!inRoom(*of(space), a) || !inRoom(*of(base), b)) return XR_SUCCESS;
  location->pose = times(inverse(b), a);
  location->locationFlags = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT |
                            XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
  const std::string& hand = of(space)->hand;
  if (hand.empty() || r.script.value(hand + " infer", r.frame) <= 0.5)
    location->locationFlags |= XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
  if (!hand.empty() && r.script.value(hand + " broken", r.frame) > 0.5)
    location->pose.position.y = std::numeric_limits<float>::quiet_NaN();
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL locateViews(XrSession, const XrViewLocateInfo* info, XrViewState* state,
                                           std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  *count = 2;
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < 2) return XR_ERROR_SIZE_INSUFFICIENT;
  XrPosef base;
  Place head;
  state->viewStateFlags = 0;
  const bool tracked = inRoom(*of(info->space), base) && r.script.place("head", r.frame, head);
  if (tracked)
    state->viewStateFlags = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT |
                            XR_VIEW_STATE_ORIENTATION_TRACKED_BIT | XR_VIEW_STATE_POSITION_TRACKED_BIT;
  else
    base = {{0, 0, 0, 1}, {0, 0, 0}};
  for (int eye = 0; eye < 2; ++eye) {
    const float aside = static_cast<float>((eye == 0 ? -0.5 : 0.5) * kBetweenEyes_m);
    const XrPosef in_head{{0, 0, 0, 1}, {aside, 0, 0}};
    views[eye].pose = times(inverse(base), times(poseOf(head), in_head));
    views[eye].fov = eye == 0 ? XrFovf{-kOut, kIn, kUp, -kDown} : XrFovf{-kIn, kOut, kUp, -kDown};
  }
  return XR_SUCCESS;
}

}  // namespace

XrVector3f turned(const XrQuaternionf& q, const XrVector3f& v) {
  const XrQuaternionf r = product(product(q, {v.x, v.y, v.z, 0.0F}), {-q.x, -q.y, -q.z, q.w});
  return {r.x, r.y, r.z};
}

bool placeOf(XrSpace space, XrPosef& pose) {
  return inRoom(*of(space), pose);
}

XrPosef times(const XrPosef& a, const XrPosef& b) {
  const XrVector3f moved = turned(a.orientation, b.position);
  return {product(a.orientation, b.orientation),
          {a.position.x + moved.x, a.position.y + moved.y, a.position.z + moved.z}};
}

XrPosef inverse(const XrPosef& a) {
  const XrQuaternionf back{-a.orientation.x, -a.orientation.y, -a.orientation.z, a.orientation.w};
  const XrVector3f at = turned(back, a.position);
  return {back, {-at.x, -at.y, -at.z}};
}

XrPosef poseOf(const Place& place) {
  const double yaw = 0.5 * place.yaw_deg * std::numbers::pi / 180.0;
  const double pitch = 0.5 * place.pitch_deg * std::numbers::pi / 180.0;
  const XrQuaternionf about_y{0, static_cast<float>(std::sin(yaw)), 0, static_cast<float>(std::cos(yaw))};
  const XrQuaternionf about_x{static_cast<float>(std::sin(pitch)), 0, 0, static_cast<float>(std::cos(pitch))};
  return {product(about_y, about_x),
          {static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)}};
}

void addSpaceCalls(Calls& calls) {
  calls["xrEnumerateReferenceSpaces"] = asVoid(&referenceSpaces);
  calls["xrCreateReferenceSpace"] = asVoid(&createReferenceSpace);
  calls["xrGetReferenceSpaceBoundsRect"] = asVoid(&stageBounds);
  calls["xrCreateActionSpace"] = asVoid(&createActionSpace);
  calls["xrDestroySpace"] = asVoid(&destroySpace);
  calls["xrLocateSpace"] = asVoid(&locateSpace);
  calls["xrLocateViews"] = asVoid(&locateViews);
}

}  // namespace fettle::tests::xr
