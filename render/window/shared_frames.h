#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <xcb/shm.h>
#include <xcb/xcb.h>

#include "render/vulkan/memory.h"
#include "render/window/presenter.h"

namespace fettle::render {

/// Memory of a frame that this program and the X server see. Move-only.
class SharedSegment {
 public:
  SharedSegment() = default;
  /// Nothing is shared where the system or the server refuses it: see works().
  SharedSegment(xcb_connection_t* connection, std::size_t bytes);
  SharedSegment(SharedSegment&& other) noexcept { *this = std::move(other); }
  SharedSegment& operator=(SharedSegment&& other) noexcept;
  ~SharedSegment();
  [[nodiscard]] bool works() const noexcept { return data_ != nullptr; }
  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  [[nodiscard]] xcb_shm_seg_t id() const noexcept { return id_; }

 private:
  xcb_connection_t* connection_ = nullptr;
  std::size_t bytes_ = 0;
  std::byte* data_ = nullptr;
  xcb_shm_seg_t id_ = 0;
};

/// Frames of a processor that draws, by MIT-SHM: their image lies in memory that the X server reads, and it is told where that
/// changed. Mesa does so where the server has DRI3; where it has not (Xvfb, servers of remote desktops) it
/// sends each whole frame through the server's socket, some 200 KB at a time, and waits for the server as often: 5 to 10 ms,
/// and 20 beside processes that spin.
///
/// show() returns when the server has copied the frame. No tearing is prevented: such servers have no screen of their own.
/// Frames come 125 a second at most.
class SharedFrames : public Presenter {
 public:
  /// Over a connection of its own to the server that the environment names. Null where frames are better shown through
  /// Vulkan: a device that is no processor or draws into its own memory only, a server with DRI3, without MIT-SHM 1.2 or on another machine, a window whose
  /// pixels are not 8 bits of blue, green, red and nothing.
  [[nodiscard]] static std::unique_ptr<SharedFrames> open(const Context& context, xcb_window_t window);
  ~SharedFrames() override;

  [[nodiscard]] bool fit(vk::Extent2D wanted) override;
  [[nodiscard]] vk::Extent2D extent() const noexcept override { return extent_; }
  [[nodiscard]] GpuImage makeImage(vk::Format format, vk::ImageUsageFlags usage) override;
  void keepPace(const std::function<void()>& while_waiting) override;
  [[nodiscard]] bool show(const FrameToShow& frame) override;
  [[nodiscard]] double waitedMs() const noexcept override { return 0.0; }  // there is one image
  void forget() noexcept override { all_ = true; }
  [[nodiscard]] const char* name() const noexcept override { return "shared memory"; }

 private:
  struct Close {
    void operator()(xcb_connection_t* connection) const { xcb_disconnect(connection); }
  };
  using Connection = std::unique_ptr<xcb_connection_t, Close>;
  SharedFrames(const Context& context, Connection connection, xcb_window_t window);
  void draw(const FrameToShow& frame, std::vector<Rectangle>& places);
  void send(const std::vector<Rectangle>& places);
  void waitForServer(const std::function<void()>& while_waiting);

  const Context& context_;
  Connection connection_;
  const xcb_window_t window_;
  xcb_gcontext_t pen_ = 0;
  vk::Extent2D extent_;
  SharedSegment segment_;
  std::size_t row_bytes_ = 0;
  bool all_ = true;
  std::chrono::steady_clock::time_point shown_;
  vk::raii::CommandPool pool_ = nullptr;
  vk::raii::CommandBuffer commands_ = nullptr;
  vk::raii::Fence done_ = nullptr;
};

}  // namespace fettle::render
