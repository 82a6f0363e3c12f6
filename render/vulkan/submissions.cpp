#include "render/vulkan/submissions.h"

namespace fettle::render {

Submissions::Submissions(Context& context) : context_(context) {
  pool_ = vk::raii::CommandPool(context.device(), {vk::CommandPoolCreateFlagBits::eResetCommandBuffer |
                                                       vk::CommandPoolCreateFlagBits::eTransient,
                                                   context.queueFamily()});
  vk::raii::CommandBuffers buffers(context.device(), {*pool_, vk::CommandBufferLevel::ePrimary,
                                                      static_cast<std::uint32_t>(slots_.size())});
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].commands = std::move(buffers[i]);
    slots_[i].fence = vk::raii::Fence(context.device(), vk::FenceCreateInfo{});
  }
}

Submissions::~Submissions() {
  try {
    finish();
  } catch (const vk::SystemError&) {
    // A lost device has no work in progress.
  }
}

double Submissions::begin() {
  const engine::Stopwatch watch;
  if (next_ > kInFlight) waitFor(next_ - kInFlight);
  const double waited = watch.ms();
  const vk::raii::CommandBuffer& commands = slot(next_).commands;
  commands.reset();
  commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  return waited;
}

void Submissions::submit(const Gate& gate) {
  Slot& s = slot(next_);
  s.commands.end();
  context_.device().resetFences(*s.fence);
  const vk::CommandBufferSubmitInfo buffer(*s.commands);
  vk::SubmitInfo2 info;
  info.setCommandBufferInfos(buffer);
  vk::SemaphoreSubmitInfo wait, signal;
  if (gate.wait) {
    wait.setSemaphore(gate.wait).setStageMask(gate.wait_at);
    info.setWaitSemaphoreInfos(wait);
  }
  if (gate.signal) {
    signal.setSemaphore(gate.signal).setStageMask(vk::PipelineStageFlagBits2::eAllCommands);
    info.setSignalSemaphoreInfos(signal);
  }
  s.since_sent = {};
  context_.queue().submit2(info, *s.fence);
  ++next_;
}

std::uint64_t Submissions::done() {
  while (done_ + 1 < next_ && slot(done_ + 1).fence.getStatus() == vk::Result::eSuccess) {
    ++done_;
    last_ms_ = slot(done_).since_sent.ms();
  }
  return done_;
}

void Submissions::waitFor(std::uint64_t number) {
  if (number <= done()) return;
  (void)context_.device().waitForFences(*slot(number).fence, VK_TRUE, UINT64_MAX);
  (void)done();
}

void Submissions::finish() {
  if (next_ > 1) waitFor(next_ - 1);
}

std::optional<vk::DeviceSize> StagingRing::take(vk::DeviceSize bytes, std::uint64_t number) {
  bytes = (bytes + 15) / 16 * 16;
  const vk::DeviceSize size = buffer_.bytes();
  if (held_.empty()) head_ = tail_ = 0;
  vk::DeviceSize at = head_;
  if (held_.empty() || head_ > tail_) {
    // Free: from head to the end, and from the start to tail. One byte less than tail, otherwise full would
    // equal empty.
    if (at + bytes > size) {
      at = 0;
      if (held_.empty() || bytes >= tail_) return std::nullopt;
    }
  } else if (at + bytes >= tail_) {
    return std::nullopt;
  }
  head_ = at + bytes;
  if (!held_.empty() && held_.back().number == number)
    held_.back().end = head_;
  else
    held_.push_back({number, head_});
  return at;
}

void StagingRing::release(std::uint64_t number) {
  while (!held_.empty() && held_.front().number <= number) {
    tail_ = held_.front().end;
    held_.pop_front();
  }
}

}  // namespace fettle::render
