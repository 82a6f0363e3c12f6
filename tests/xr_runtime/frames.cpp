#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "tests/xr_runtime/keeper.h"

namespace fettle::tests::xr {

namespace {

// The states that the frames and the script bring about, one step a frame.
void advance(Runtime& r) {
  r.script.readOn(r.frame);
  for (const std::string& word : r.script.events(r.frame)) {
    if (word == "hide") r.seen = false;
    if (word == "show") r.seen = true;
    if (word == "stop") r.asked_exit = true;
    if (word == "recentre") r.moveRoom();
    if (word == "lose") {
      r.lost = true;
      r.enter(XR_SESSION_STATE_LOSS_PENDING);
    }
  }
  if (r.lost || !r.running) return;
  const bool leaves = r.asked_exit || !r.seen;
  switch (r.state) {
    case XR_SESSION_STATE_READY:
      r.enter(XR_SESSION_STATE_SYNCHRONIZED);
      break;
    case XR_SESSION_STATE_SYNCHRONIZED:
      if (r.asked_exit)
        r.enter(XR_SESSION_STATE_STOPPING);
      else if (r.seen)
        r.enter(XR_SESSION_STATE_VISIBLE);
      break;
    case XR_SESSION_STATE_VISIBLE:
      r.enter(leaves ? XR_SESSION_STATE_SYNCHRONIZED : XR_SESSION_STATE_FOCUSED);
      break;
    case XR_SESSION_STATE_FOCUSED:
      if (leaves) r.enter(XR_SESSION_STATE_VISIBLE);
      break;
    default:
      break;
  }
}

// A runtime that does not answer, as long as the script has it so.
void hang(Runtime& r) {
  const long frame = r.frame + 1;
  for (bool first = true;; first = false) {
    {
      const std::lock_guard lock(r.mutex);
      if (!first) r.script.readOn(r.frame);
      if (!r.script.hangs(frame)) return;
      if (first) r.say("hangs before frame " + std::to_string(frame));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

XRAPI_ATTR XrResult XRAPI_CALL waitFrame(XrSession, const XrFrameWaitInfo*, XrFrameState* state) {
  Runtime& r = runtime();
  XrTime due = 0;
  const auto period = static_cast<XrTime>(1e9 / r.script.rate_hz);
  {
    const std::lock_guard lock(r.mutex);
    if (r.lost) return XR_ERROR_SESSION_LOST;
    if (!r.running)
      return r.wrong("a frame is waited for without a running session", XR_ERROR_SESSION_NOT_RUNNING);
    if (r.waited) return r.wrong("a frame is waited for while one is waited for and not begun");
    due = std::max(nowNs(), r.last_wake + period);
  }
  hang(r);
  due = std::max(due, nowNs());
  // A headset's clock: frames come at its own pace.
  std::this_thread::sleep_for(std::chrono::nanoseconds(due - nowNs()));
  const std::lock_guard lock(r.mutex);
  r.last_wake = due;
  ++r.frame;
  advance(r);
  r.waited = true;
  r.shown = due + period;
  state->predictedDisplayTime = r.shown;
  state->predictedDisplayPeriod = period;
  state->shouldRender = r.state == XR_SESSION_STATE_VISIBLE || r.state == XR_SESSION_STATE_FOCUSED;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL beginFrame(XrSession, const XrFrameBeginInfo*) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (!r.running) return r.wrong("a frame is begun without a running session", XR_ERROR_SESSION_NOT_RUNNING);
  if (!r.waited) return r.wrong("a frame is begun that was not waited for");
  if (r.begun) (void)r.wrong("a frame is begun before the last one was ended");
  r.waited = false;
  r.begun = true;
  return XR_SUCCESS;
}

// Whether a layer's picture may be shown.
bool good(Runtime& r, const XrSwapchainSubImage& part, const char* what) {
  const auto* swapchain = reinterpret_cast<const Swapchain*>(part.swapchain);
  if (r.swapchains.count(const_cast<Swapchain*>(swapchain)) == 0) {
    (void)r.wrong(std::string(what) + " of a swapchain that does not exist");
    return false;
  }
  if (swapchain->released < 0) {
    (void)r.wrong(std::string(what) + " of a swapchain without a released image");
    return false;
  }
  const XrRect2Di& rect = part.imageRect;
  if (rect.offset.x < 0 || rect.offset.y < 0 || rect.extent.width <= 0 || rect.extent.height <= 0 ||
      rect.offset.x + rect.extent.width > static_cast<int>(swapchain->info.width) ||
      rect.offset.y + rect.extent.height > static_cast<int>(swapchain->info.height) ||
      part.imageArrayIndex >= swapchain->info.arraySize) {
    (void)r.wrong(std::string(what) + " outside its image");
    return false;
  }
  return true;
}

// The picture of a layer.
Pixels pictureOf(const XrSwapchainSubImage& part) {
  const auto* swapchain = reinterpret_cast<const Swapchain*>(part.swapchain);
  Pixels pixels;
  if (!readPicture(swapchain->images[static_cast<std::size_t>(swapchain->released)],
                   static_cast<VkFormat>(swapchain->info.format), part.imageRect, part.imageArrayIndex,
                   pixels))
    pixels = {};
  return pixels;
}

// `kept`: null where the frame is not.
void takeProjection(Runtime& r, const XrCompositionLayerProjection& layer, KeptFrame* kept) {
  if (layer.viewCount != 2) {
    (void)r.wrong("a projection without two views", XR_ERROR_VALIDATION_FAILURE);
    return;
  }
  XrPosef base{};
  const bool placed = placeOf(layer.space, base);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const XrCompositionLayerProjectionView& view = layer.views[eye];
    if (good(r, view.subImage, "a projection") && kept != nullptr && placed)
      kept->eyes[eye] = {times(base, view.pose), view.fov, pictureOf(view.subImage)};
  }
}

void takeQuad(Runtime& r, const XrCompositionLayerQuad& quad, KeptFrame* kept) {
  const XrQuaternionf& q = quad.pose.orientation;
  const float length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  // "A unit quaternion", to within a hundredth (specification 2.17, XrQuaternionf).
  if (!(std::abs(length - 1.0F) < 0.01F)) {
    (void)r.wrong("a quad that is not turned but stretched", XR_ERROR_POSE_INVALID);
    return;
  }
  if (!(quad.size.width > 0.0F && quad.size.height > 0.0F)) (void)r.wrong("a quad without an area");
  if (!good(r, quad.subImage, "a quad") || kept == nullptr) return;
  XrPosef base{};
  const bool placed = placeOf(quad.space, base);
  kept->quads.push_back({quad, times(base, quad.pose), placed, pictureOf(quad.subImage)});
}

XRAPI_ATTR XrResult XRAPI_CALL endFrame(XrSession, const XrFrameEndInfo* info) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  if (r.lost) return XR_ERROR_SESSION_LOST;
  if (!r.running) return r.wrong("a frame is ended without a running session", XR_ERROR_SESSION_NOT_RUNNING);
  if (!r.begun) return r.wrong("a frame is ended that was not begun");
  r.begun = false;
  if (r.script.has("end", r.frame))
    for (const XrSessionState next :
         {XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_STOPPING})
      r.enter(next);
  if (info->environmentBlendMode != XR_ENVIRONMENT_BLEND_MODE_OPAQUE)
    return XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED;
  if (info->displayTime != r.shown) (void)r.wrong("a frame is ended for another time than was waited for");
  const bool keeps = !r.keep.empty() && r.script.has("keep", r.frame);
  KeptFrame kept;
  kept.number = r.frame;
  kept.takes_s = r.script.keep_takes_s;
  if (info->layerCount > XR_MIN_COMPOSITION_LAYERS_SUPPORTED)
    return r.wrong("more layers than the system has", XR_ERROR_LAYER_LIMIT_EXCEEDED);
  for (std::uint32_t i = 0; i < info->layerCount; ++i) {
    const XrCompositionLayerBaseHeader* layer = info->layers[i];
    if (layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
      takeProjection(r, *reinterpret_cast<const XrCompositionLayerProjection*>(layer),
                     keeps ? &kept : nullptr);
      kept.layers += " projection";
    } else if (layer->type == XR_TYPE_COMPOSITION_LAYER_QUAD) {
      takeQuad(r, *reinterpret_cast<const XrCompositionLayerQuad*>(layer), keeps ? &kept : nullptr);
      kept.layers += " quad";
    } else {
      return r.wrong("a layer of an unknown kind", XR_ERROR_LAYER_INVALID);
    }
  }
  if (keeps) keeper().keep(std::move(kept));
  return XR_SUCCESS;
}

}  // namespace

XrTime nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void addFrameCalls(Calls& calls) {
  calls["xrWaitFrame"] = asVoid(&waitFrame);
  calls["xrBeginFrame"] = asVoid(&beginFrame);
  calls["xrEndFrame"] = asVoid(&endFrame);
}

}  // namespace fettle::tests::xr
