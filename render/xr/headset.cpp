#include "render/xr/headset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "render/vulkan/barrier.h"
#include "render/vulkan/live_target.h"
#include "render/vulkan/memory.h"
#include "render/xr/hands.h"
#include "render/xr/xr_calls.h"
#include "render/xr/xr_images.h"
#include "render/xr/xr_picture.h"
#include "render/xr/xr_runtime.h"

namespace fettle::render {
namespace {

constexpr const char* kStart = "start the headset's runtime and connect the headset, or leave out --xr";
// Between two looks for events while the runtime wants no frames: its calls offer nothing to wait on.
constexpr auto kBetweenEvents = std::chrono::milliseconds(10);

engine::Error lost(const char* doing, XrResult result) {
  return engine::failure(fmt::format("{} failed: {}", doing, reasonOf(result)), "headset", kStart).value();
}

engine::Status noHeadset(XrResult result) {
  return engine::failure(fmt::format("no headset can be used: {}", reasonOf(result)), "OpenXR",
                         result == XR_ERROR_RUNTIME_UNAVAILABLE ? runtimeRemedy() : kStart);
}

}  // namespace

struct Headset::Impl {
  XrCalls xr;
  XrInstance instance = XR_NULL_HANDLE;
  XrSystemId system = XR_NULL_SYSTEM_ID;
  std::string name;
  std::unique_ptr<Context> context;
  XrSession session = XR_NULL_HANDLE;
  XrSpace room = XR_NULL_HANDLE;
  bool on_floor = false;
  XrEnvironmentBlendMode blend = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  vk::Format format = kColourFormat;
  XrImages eye_images;
  std::array<XrPicture, kRoomPictures> pictures;
  Hands hands;
  bool running = false, ended = false;
  std::optional<XrTime> room_moves_at;  // the origin of `room` is another from then on
  XrTime shown_at = 0;
  std::array<XrView, 2> views{};
  std::uint64_t drawn = 0;

  engine::Status start(const HeadsetOptions& options);
  engine::Status startInstance();
  engine::Status startContext(const HeadsetOptions& options);
  engine::Status startSession();
  engine::Status takeEvents();
  engine::Status frame(const HeadsetFrame& frame);
  engine::Status drawEyes(const HeadsetFrame& frame, bool& complete);
  XrResult locateEyes();
  ~Impl();
};

Headset::Impl::~Impl() {
  if (context) try {
      context->device().waitIdle();
    } catch (const vk::SystemError&) {
      // A lost device has no work in progress.
    }
  hands.destroy();
  for (XrPicture& picture : pictures) picture.destroy();
  eye_images.destroy();
  if (room != XR_NULL_HANDLE) (void)xr.DestroySpace(room);
  if (session != XR_NULL_HANDLE) (void)xr.DestroySession(session);
  context.reset();
  if (instance != XR_NULL_HANDLE) (void)xr.DestroyInstance(instance);
}

engine::Status Headset::Impl::startInstance() {
  if (auto loaded = xr.load(); !loaded) return loaded;
  std::uint32_t count = 0;
  XrResult result = xr.EnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr);
  std::vector<XrExtensionProperties> offered(count, {XR_TYPE_EXTENSION_PROPERTIES, nullptr, "", 0});
  if (XR_SUCCEEDED(result))
    result = xr.EnumerateInstanceExtensionProperties(nullptr, count, &count, offered.data());
  if (XR_FAILED(result)) return noHeadset(result);
  const char* const extension = XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME;
  if (std::none_of(offered.begin(), offered.end(),
                   [&](const auto& e) { return std::strcmp(e.extensionName, extension) == 0; }))
    return engine::failure("the headset's runtime cannot show pictures by Vulkan", "OpenXR",
                           "use another runtime");
  auto info = typed<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  std::strcpy(info.applicationInfo.applicationName, "Fettle");
  info.applicationInfo.applicationVersion = 1;
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = 1;
  info.enabledExtensionNames = &extension;
  result = xr.CreateInstance(&info, &instance);
  if (XR_FAILED(result)) return noHeadset(result);
  if (auto found = xr.find(instance); !found) return found;
  XrSystemGetInfo wanted{XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
  result = xr.GetSystem(instance, &wanted, &system);
  if (XR_FAILED(result)) return noHeadset(result);
  auto properties = typed<XrSystemProperties>(XR_TYPE_SYSTEM_PROPERTIES);
  if (XR_SUCCEEDED(xr.GetSystemProperties(instance, system, &properties))) name = properties.systemName;
  return {};
}

engine::Status Headset::Impl::startContext(const HeadsetOptions& options) {
  auto needs = typed<XrGraphicsRequirementsVulkan2KHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR);
  if (const XrResult result = xr.GetVulkanGraphicsRequirements2KHR(instance, system, &needs);
      XR_FAILED(result))
    return tl::unexpected(lost("asking what the headset needs", result));
  // maxApiVersionSupported is what the runtime was tested with, not a limit.
  if (needs.minApiVersionSupported > XR_MAKE_VERSION(1, 3, 0xFFFF))
    return engine::failure("the headset's runtime needs a newer Vulkan than 1.3", "OpenXR",
                           "use another runtime");
  const auto good = [](XrResult result, VkResult vulkan, const char* what) {
    if (XR_FAILED(result)) throw vk::InitializationFailedError(std::string(what) + ": " + reasonOf(result));
    if (vulkan != VK_SUCCESS) vk::throwResultException(static_cast<vk::Result>(vulkan), what);
  };
  VulkanMaker maker;
  maker.instance = [&](const VkInstanceCreateInfo& create) {
    auto info = typed<XrVulkanInstanceCreateInfoKHR>(XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR);
    info.systemId = system;
    info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
    info.vulkanCreateInfo = &create;
    VkInstance made = VK_NULL_HANDLE;
    VkResult vulkan = VK_SUCCESS;
    good(xr.CreateVulkanInstanceKHR(instance, &info, &made, &vulkan), vulkan,
         "the headset's Vulkan instance");
    return made;
  };
  maker.physical = [&](VkInstance of) {
    XrVulkanGraphicsDeviceGetInfoKHR info{XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR, nullptr, system, of};
    VkPhysicalDevice device = VK_NULL_HANDLE;
    good(xr.GetVulkanGraphicsDevice2KHR(instance, &info, &device), VK_SUCCESS,
         "the headset's graphics device");
    return device;
  };
  maker.device = [&](VkPhysicalDevice physical, const VkDeviceCreateInfo& create) {
    auto info = typed<XrVulkanDeviceCreateInfoKHR>(XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR);
    info.systemId = system;
    info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
    info.vulkanPhysicalDevice = physical;
    info.vulkanCreateInfo = &create;
    VkDevice made = VK_NULL_HANDLE;
    VkResult vulkan = VK_SUCCESS;
    good(xr.CreateVulkanDeviceKHR(instance, &info, &made, &vulkan), vulkan, "the headset's Vulkan device");
    return made;
  };
  auto made = Context::create({options.validation, ""}, nullptr, &maker);
  if (!made) return tl::unexpected(made.error());
  context = *std::move(made);
  return {};
}

engine::Status Headset::Impl::startSession() {
  auto binding = typed<XrGraphicsBindingVulkan2KHR>(XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR);
  binding.instance = *context->instance();
  binding.physicalDevice = *context->physical();
  binding.device = *context->device();
  binding.queueFamilyIndex = context->queueFamily();
  XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, &binding, 0, system};
  XrResult result = xr.CreateSession(instance, &info, &session);
  if (XR_FAILED(result)) return tl::unexpected(lost("starting the session", result));

  std::uint32_t count = 0;
  result = xr.EnumerateReferenceSpaces(session, 0, &count, nullptr);
  std::vector<XrReferenceSpaceType> spaces(count);
  if (XR_SUCCEEDED(result)) result = xr.EnumerateReferenceSpaces(session, count, &count, spaces.data());
  on_floor = std::find(spaces.begin(), spaces.end(), XR_REFERENCE_SPACE_TYPE_STAGE) != spaces.end();
  XrReferenceSpaceCreateInfo space{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr,
                                   on_floor ? XR_REFERENCE_SPACE_TYPE_STAGE : XR_REFERENCE_SPACE_TYPE_LOCAL,
                                   xrPose({})};
  if (XR_SUCCEEDED(result)) result = xr.CreateReferenceSpace(session, &space, &room);
  if (XR_FAILED(result)) return tl::unexpected(lost("placing the room", result));

  constexpr XrViewConfigurationType kStereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  std::array<XrViewConfigurationView, 2> eyes{};
  for (XrViewConfigurationView& eye : eyes) eye.type = XR_TYPE_VIEW_CONFIGURATION_VIEW;
  result = xr.EnumerateViewConfigurationViews(instance, system, kStereo, 2, &count, eyes.data());
  std::uint32_t modes = 0;
  if (XR_SUCCEEDED(result))
    result = xr.EnumerateEnvironmentBlendModes(instance, system, kStereo, 0, &modes, nullptr);
  std::vector<XrEnvironmentBlendMode> blends(modes);
  if (XR_SUCCEEDED(result))
    result = xr.EnumerateEnvironmentBlendModes(instance, system, kStereo, modes, &modes, blends.data());
  std::uint32_t formats = 0;
  if (XR_SUCCEEDED(result)) result = xr.EnumerateSwapchainFormats(session, 0, &formats, nullptr);
  std::vector<std::int64_t> offered(formats);
  if (XR_SUCCEEDED(result)) result = xr.EnumerateSwapchainFormats(session, formats, &formats, offered.data());
  if (XR_FAILED(result) || blends.empty()) return tl::unexpected(lost("asking about the eyes", result));
  blend = blends.front();  // the runtime's own choice
  const auto known = std::find_if(offered.begin(), offered.end(), [](std::int64_t f) {
    return f == VK_FORMAT_R8G8B8A8_SRGB || f == VK_FORMAT_B8G8R8A8_SRGB;
  });
  if (known == offered.end())
    return engine::failure("the headset's runtime takes no sRGB images of 8 bits", "OpenXR",
                           "use another runtime");
  format = static_cast<vk::Format>(*known);
  const vk::Extent2D extent{eyes[0].recommendedImageRectWidth, eyes[0].recommendedImageRectHeight};
  result = eye_images.make(xr, session, *context, format, extent, 2);
  if (XR_FAILED(result)) return tl::unexpected(lost("making the eyes' images", result));
  result = hands.make(xr, instance, session);
  if (XR_FAILED(result)) return tl::unexpected(lost("asking for the controllers", result));
  return {};
}

engine::Status Headset::Impl::start(const HeadsetOptions& options) {
  if (auto status = startInstance(); !status) return status;
  if (auto status = startContext(options); !status) return status;
  return startSession();
}

engine::Status Headset::Impl::takeEvents() {
  auto event = typed<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
  XrResult result = XR_SUCCESS;
  while ((result = xr.PollEvent(instance, &event)) == XR_SUCCESS) {
    if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING)
      return tl::unexpected(lost("the session", XR_ERROR_INSTANCE_LOST));
    if (event.type == XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING)
      room_moves_at = reinterpret_cast<const XrEventDataReferenceSpaceChangePending*>(&event)->changeTime;
    if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
      const auto& changed = *reinterpret_cast<const XrEventDataSessionStateChanged*>(&event);
      if (changed.state == XR_SESSION_STATE_READY) {
        const XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr,
                                      XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
        const XrResult begun = xr.BeginSession(session, &info);
        if (XR_FAILED(begun)) return tl::unexpected(lost("beginning the session", begun));
        running = true;
      } else if (changed.state == XR_SESSION_STATE_STOPPING) {
        running = false;
        const XrResult done = xr.EndSession(session);
        if (XR_FAILED(done)) return tl::unexpected(lost("ending the session", done));
      } else if (changed.state == XR_SESSION_STATE_LOSS_PENDING) {
        running = false;
        return tl::unexpected(lost("the session", XR_ERROR_SESSION_LOST));
      } else if (changed.state == XR_SESSION_STATE_EXITING) {
        ended = true;
      }
    }
    event = {XR_TYPE_EVENT_DATA_BUFFER, nullptr, {}};
  }
  if (XR_FAILED(result)) return tl::unexpected(lost("the session", result));
  return {};
}

XrResult Headset::Impl::locateEyes() {
  XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO,
                        shown_at, room};
  XrViewState state{XR_TYPE_VIEW_STATE, nullptr, 0};
  std::array<XrView, 2> found{};
  for (XrView& view : found) view.type = XR_TYPE_VIEW;
  std::uint32_t count = 0;
  const XrResult result = xr.LocateViews(session, &info, &state, 2, &count, found.data());
  constexpr XrViewStateFlags kKnown = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  // Not tracked for a moment: where they were.
  if (XR_SUCCEEDED(result) && ((state.viewStateFlags & kKnown) == kKnown || drawn == 0)) views = found;
  return result;
}

engine::Status Headset::Impl::drawEyes(const HeadsetFrame& frame, bool& complete) {
  XrImages::One image;
  XrResult result = eye_images.acquire(image);
  if (result == XR_TIMEOUT_EXPIRED) return {};  // a frame without a picture
  if (XR_SUCCEEDED(result)) result = locateEyes();
  if (XR_FAILED(result)) return tl::unexpected(lost("getting an image for the eyes", result));
  LiveTarget target;
  target.image = image.image;
  target.view = image.view;
  target.extent = eye_images.extent();
  target.leaves_as = ImageLayout::eColorAttachmentOptimal;  // as XR_KHR_vulkan_enable2 asks for
  engine::Status drew = frame.draw(target);
  complete = drew.has_value();
  result = eye_images.release();
  if (drew && XR_FAILED(result)) return tl::unexpected(lost("showing the eyes' picture", result));
  return drew;
}

engine::Status Headset::Impl::frame(const HeadsetFrame& frame) {
  if (auto status = takeEvents(); !status) return status;
  if (!running) {
    // What hands did before ends here.
    if (frame.hands) frame.hands({});
    std::this_thread::sleep_for(kBetweenEvents);
    return {};
  }
  const XrFrameWaitInfo wait{XR_TYPE_FRAME_WAIT_INFO, nullptr};
  XrFrameState state{XR_TYPE_FRAME_STATE, nullptr, 0, 0, XR_FALSE};
  XrResult result = xr.WaitFrame(session, &wait, &state);
  if (XR_FAILED(result)) return tl::unexpected(lost("waiting for a frame", result));
  const XrFrameBeginInfo begin{XR_TYPE_FRAME_BEGIN_INFO, nullptr};
  result = xr.BeginFrame(session, &begin);
  if (XR_FAILED(result)) return tl::unexpected(lost("beginning a frame", result));
  shown_at = state.predictedDisplayTime;
  RoomHands seen;
  result = hands.read(room, shown_at, seen);
  if (XR_FAILED(result)) return tl::unexpected(lost("reading the controllers", result));
  // A hand is not followed from one origin to another.
  if (room_moves_at && shown_at >= *room_moves_at) {
    room_moves_at.reset();
    seen = {};
  }
  if (frame.hands) frame.hands(seen);

  bool complete = false;
  engine::Status drew;
  if (state.shouldRender != XR_FALSE && frame.draw) drew = drawEyes(frame, complete);
  std::array<XrCompositionLayerProjectionView, 2> projected{};
  for (std::size_t eye = 0; eye < 2; ++eye)
    projected[eye] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, views[eye].pose, views[eye].fov,
                      eye_images.part(static_cast<std::uint32_t>(eye))};
  const XrCompositionLayerProjection projection{
      XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, room, 2, projected.data()};
  std::vector<XrCompositionLayerQuad> quads;
  std::vector<const XrCompositionLayerBaseHeader*> layers;
  if (complete) {
    ++drawn;
    layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection));
    if (frame.panels)
      for (const RoomPanel& panel : frame.panels()) {
        const XrPicture& picture = pictures[static_cast<std::size_t>(panel.picture)];
        if (picture.made()) quads.push_back(picture.on(panel, room));
      }
    for (const XrCompositionLayerQuad& quad : quads)
      layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad));
  }
  const XrFrameEndInfo end{
      XR_TYPE_FRAME_END_INFO, nullptr, shown_at, blend, static_cast<std::uint32_t>(layers.size()),
      layers.data()};
  result = xr.EndFrame(session, &end);
  if (!drew) return drew;
  if (XR_FAILED(result)) return tl::unexpected(lost("ending a frame", result));
  return {};
}

Headset::Headset(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Headset::~Headset() = default;

void Headset::silenceLoader() {
  // The loader's own word for no message at all (1.0.20); its errors come back as results.
  (void)setenv("XR_LOADER_DEBUG", "none", 0);
}

engine::Result<std::unique_ptr<Headset>> Headset::create(const HeadsetOptions& options) try {
  auto impl = std::make_unique<Impl>();
  if (auto status = impl->start(options); !status) return tl::unexpected(status.error());
  return std::unique_ptr<Headset>(new Headset(std::move(impl)));
} catch (const std::exception& error) {
  return engine::failure(fmt::format("the headset does not start ({})", error.what()), "headset", kStart);
}

Context& Headset::context() {
  return *impl_->context;
}
std::uint32_t Headset::colourFormat() const {
  return static_cast<std::uint32_t>(impl_->format);
}
int Headset::width() const {
  return static_cast<int>(impl_->eye_images.extent().width);
}
int Headset::height() const {
  return static_cast<int>(impl_->eye_images.extent().height);
}
const std::string& Headset::name() const {
  return impl_->name;
}
bool Headset::floor() const {
  return impl_->on_floor;
}

engine::Status Headset::frame(const HeadsetFrame& frame) try {
  return impl_->frame(frame);
} catch (const std::exception& error) {
  return engine::failure(fmt::format("drawing for the headset failed ({})", error.what()), "headset", kStart);
}

std::array<RoomEye, 2> Headset::eyes() {
  // Asked again: the prediction is better than when the image was acquired. A failure shows at the end of the frame.
  (void)impl_->locateEyes();
  std::array<RoomEye, 2> eyes;
  for (std::size_t i = 0; i < 2; ++i) {
    const XrFovf& fov = impl_->views[i].fov;
    const auto tangent = [](float angle) { return std::tan(static_cast<double>(angle)); };
    eyes[i] = {roomPose(impl_->views[i].pose), tangent(fov.angleLeft), tangent(fov.angleRight),
               tangent(fov.angleDown), tangent(fov.angleUp)};
  }
  return eyes;
}

void Headset::vibrate(std::size_t hand, double amplitude) {
  // A controller that was put away is no failure, and a lost session is reported by the frame.
  (void)impl_->hands.vibrate(hand, amplitude);
}

engine::Status Headset::setPicture(RoomPicture which, const Image& picture) try {
  Impl& h = *impl_;
  const XrResult set =
      h.pictures[static_cast<std::size_t>(which)].set(h.xr, h.session, *h.context, h.format, picture);
  if (XR_FAILED(set)) return tl::unexpected(lost("showing a picture in the room", set));
  return {};
} catch (const std::exception& error) {
  return engine::failure(fmt::format("drawing for the headset failed ({})", error.what()), "headset", kStart);
}

void Headset::requestEnd() {
  if (!impl_->running) {
    impl_->ended = true;
    return;
  }
  (void)impl_->xr.RequestExitSession(impl_->session);
}
bool Headset::ended() const {
  return impl_->ended;
}
std::uint64_t Headset::framesDrawn() const {
  return impl_->drawn;
}
std::vector<std::string> Headset::validationMessages() const {
  return impl_->context->messages().all();
}

}  // namespace fettle::render
