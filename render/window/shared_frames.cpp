#include "render/window/shared_frames.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <thread>
#include <utility>

#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xcb/xcbext.h>

#include "render/vulkan/barrier.h"

namespace fettle::render {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kForever_ns = UINT64_MAX;
constexpr std::uint64_t kLookAgain_ns = 1'000'000;
constexpr int kLookAgain_ms = 1;
constexpr auto kShortestFrame = 8ms;
constexpr std::size_t kPixel = 4;  // bytes
constexpr std::uint8_t kDepth24 = 24;

struct FreeReply {
  void operator()(void* reply) const { std::free(reply); }
};
template <class T>
using ReplyOf = std::unique_ptr<T, FreeReply>;

bool has(xcb_connection_t* connection, std::string_view extension) {
  const ReplyOf<xcb_query_extension_reply_t> reply{xcb_query_extension_reply(
      connection,
      xcb_query_extension(connection, static_cast<std::uint16_t>(extension.size()), extension.data()),
      nullptr)};
  return reply && reply->present != 0;
}

bool sharesMemory(xcb_connection_t* connection) {
  if (!has(connection, "MIT-SHM")) return false;
  const ReplyOf<xcb_shm_query_version_reply_t> version{
      xcb_shm_query_version_reply(connection, xcb_shm_query_version(connection), nullptr)};
  return version &&
         (version->major_version > 1 || (version->major_version == 1 && version->minor_version >= 2));
}

const xcb_visualtype_t* visualOf(const xcb_setup_t* setup, xcb_visualid_t id, std::uint8_t depth) {
  for (auto screen = xcb_setup_roots_iterator(setup); screen.rem > 0; xcb_screen_next(&screen))
    for (auto depths = xcb_screen_allowed_depths_iterator(screen.data); depths.rem > 0;
         xcb_depth_next(&depths))
      if (depths.data->depth == depth)
        for (auto visual = xcb_depth_visuals_iterator(depths.data); visual.rem > 0;
             xcb_visualtype_next(&visual))
          if (visual.data->visual_id == id) return visual.data;
  return nullptr;
}

// Whether the window's pixels are those of a frame: 32 bits each, of which the lowest 8 are blue.
bool takesFrames(xcb_connection_t* connection, xcb_window_t window) {
  const ReplyOf<xcb_get_window_attributes_reply_t> attributes{
      xcb_get_window_attributes_reply(connection, xcb_get_window_attributes(connection, window), nullptr)};
  if (!attributes) return false;
  const xcb_setup_t* const setup = xcb_get_setup(connection);
  if (setup->image_byte_order != XCB_IMAGE_ORDER_LSB_FIRST) return false;
  bool wide = false;
  for (auto format = xcb_setup_pixmap_formats_iterator(setup); format.rem > 0; xcb_format_next(&format))
    wide = wide || (format.data->depth == kDepth24 && format.data->bits_per_pixel == 8 * kPixel);
  const xcb_visualtype_t* const visual = visualOf(setup, attributes->visual, kDepth24);
  return wide && visual != nullptr && visual->red_mask == 0xFF0000U && visual->green_mask == 0x00FF00U &&
         visual->blue_mask == 0x0000FFU;
}

}  // namespace

SharedSegment::SharedSegment(xcb_connection_t* connection, std::size_t bytes)
    : connection_(connection), bytes_(bytes) {
  const int file = memfd_create("fettle frame", MFD_CLOEXEC);
  if (file < 0) return;
  void* const seen = ftruncate(file, static_cast<off_t>(bytes)) == 0
                         ? mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                         : MAP_FAILED;
  if (seen == MAP_FAILED) {
    close(file);
    return;
  }
  id_ = xcb_generate_id(connection);
  // The connection closes the file.
  const ReplyOf<xcb_generic_error_t> refused{
      xcb_request_check(connection, xcb_shm_attach_fd_checked(connection, id_, file, 1))};
  if (refused || xcb_connection_has_error(connection) != 0)
    munmap(seen, bytes);
  else
    data_ = static_cast<std::byte*>(seen);
}

SharedSegment& SharedSegment::operator=(SharedSegment&& other) noexcept {
  std::swap(connection_, other.connection_);
  std::swap(bytes_, other.bytes_);
  std::swap(data_, other.data_);
  std::swap(id_, other.id_);
  return *this;
}

SharedSegment::~SharedSegment() {
  if (data_ == nullptr) return;
  xcb_shm_detach(connection_, id_);
  munmap(data_, bytes_);
}

std::unique_ptr<SharedFrames> SharedFrames::open(const Context& context, xcb_window_t window) {
  if (context.hostImageAlignment() == 0) return nullptr;
  Connection connection(xcb_connect(nullptr, nullptr));
  xcb_connection_t* const c = connection.get();
  if (xcb_connection_has_error(c) != 0 || has(c, "DRI3") || !sharesMemory(c) || !takesFrames(c, window))
    return nullptr;
  // A server on another machine takes no files.
  if (!SharedSegment(c, kPixel).works()) return nullptr;
  return std::unique_ptr<SharedFrames>(new SharedFrames(context, std::move(connection), window));
}

SharedFrames::SharedFrames(const Context& context, Connection connection, xcb_window_t window)
    : context_(context), connection_(std::move(connection)), window_(window) {
  pen_ = xcb_generate_id(connection_.get());
  xcb_create_gc(connection_.get(), pen_, window_, 0, nullptr);
  const vk::raii::Device& device = context_.device();
  pool_ = vk::raii::CommandPool(device,
                                {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, context_.queueFamily()});
  commands_ =
      std::move(vk::raii::CommandBuffers(device, {*pool_, vk::CommandBufferLevel::ePrimary, 1}).front());
  done_ = vk::raii::Fence(device, vk::FenceCreateInfo{});
}

SharedFrames::~SharedFrames() = default;

bool SharedFrames::fit(vk::Extent2D wanted) {
  if (wanted.width == 0 || wanted.height == 0) return false;
  if (wanted == extent_) return true;
  extent_ = wanted;
  all_ = true;
  return true;
}

GpuImage SharedFrames::makeImage(vk::Format format, vk::ImageUsageFlags usage) {
  GpuImage image(context_, format, extent_, usage, [this](std::size_t bytes) {
    segment_ = SharedSegment(connection_.get(), bytes);
    if (!segment_.works()) throw vk::OutOfHostMemoryError("no memory is shared with the display");
    return segment_.data();
  });
  row_bytes_ = image.rowBytes();
  return image;
}

bool SharedFrames::show(const FrameToShow& frame) {
  shown_ = std::chrono::steady_clock::now();
  std::vector<Rectangle> places;
  draw(frame, places);
  if (places.empty()) return true;
  if (frame.before_showing) frame.before_showing();
  send(places);
  waitForServer(frame.while_waiting);
  return true;
}

// A display without a screen takes frames as fast as they come; more than these nobody sees.
void SharedFrames::keepPace(const std::function<void()>& while_waiting) {
  const auto next = shown_ + kShortestFrame;
  for (auto now = std::chrono::steady_clock::now(); now < next; now = std::chrono::steady_clock::now()) {
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(next - now, 1ms));
    if (while_waiting) while_waiting();
  }
}

// `places`: of the frame that the server has to be told of.
void SharedFrames::draw(const FrameToShow& frame, std::vector<Rectangle>& places) {
  commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  places = frame.record(commands_);
  if (std::exchange(all_, false))
    places = {{0, 0, static_cast<int>(extent_.width), static_cast<int>(extent_.height)}};
  vk::MemoryBarrier2 read;
  read.setSrcStageMask(Stage::eAllCommands)
      .setSrcAccessMask(Access::eMemoryWrite)
      .setDstStageMask(Stage::eHost)
      .setDstAccessMask(Access::eHostRead);
  vk::DependencyInfo info;
  commands_.pipelineBarrier2(info.setMemoryBarriers(read));
  commands_.end();
  if (places.empty()) return;
  const vk::CommandBufferSubmitInfo buffer(*commands_);
  vk::SubmitInfo2 submit;
  context_.queue().submit2(submit.setCommandBufferInfos(buffer), *done_);
  while (context_.device().waitForFences(
             *done_, VK_TRUE, frame.while_waiting ? kLookAgain_ns : kForever_ns) == vk::Result::eTimeout)
    frame.while_waiting();
  context_.device().resetFences(*done_);
}

void SharedFrames::send(const std::vector<Rectangle>& places) {
  for (const Rectangle& place : places) {
    const auto x = static_cast<std::uint16_t>(place.x), y = static_cast<std::uint16_t>(place.y);
    xcb_shm_put_image(connection_.get(), window_, pen_, static_cast<std::uint16_t>(row_bytes_ / kPixel),
                      static_cast<std::uint16_t>(extent_.height), x, y,
                      static_cast<std::uint16_t>(place.width), static_cast<std::uint16_t>(place.height),
                      static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), kDepth24,
                      XCB_IMAGE_FORMAT_Z_PIXMAP, 0, segment_.id(), 0);
  }
}

// Until the server has copied all that was sent: the next frame is written to the same memory.
void SharedFrames::waitForServer(const std::function<void()>& while_waiting) {
  xcb_connection_t* const c = connection_.get();
  const xcb_get_input_focus_cookie_t asked = xcb_get_input_focus(c);
  xcb_flush(c);
  void* reply = nullptr;
  xcb_generic_error_t* error = nullptr;
  while (xcb_poll_for_reply(c, asked.sequence, &reply, &error) == 0) {
    pollfd server{xcb_get_file_descriptor(c), POLLIN, 0};
    if (poll(&server, 1, kLookAgain_ms) == 0 && while_waiting) while_waiting();
  }
  std::free(reply);
  std::free(error);
  // Nobody reads errors of single requests: a window that is gone takes the connection's end with it.
  while (const ReplyOf<xcb_generic_event_t> event{xcb_poll_for_queued_event(c)}) {
  }
  if (xcb_connection_has_error(c) != 0) throw vk::SurfaceLostKHRError("display");
}

}  // namespace fettle::render
