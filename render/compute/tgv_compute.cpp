#include "render/compute/tgv_compute.h"

#include <algorithm>
#include <cassert>
#include <deque>

#include <fmt/format.h>

#include "render/compute/tgv_program.h"
#include "render/config.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

namespace {

// Why a device cannot run the shaders; empty where it can.
std::string shortcoming(const Context& context) {
  const vk::QueueFamilyProperties family =
      context.physical().getQueueFamilyProperties()[context.queueFamily()];
  if (!(family.queueFlags & vk::QueueFlagBits::eCompute)) return "its queue does not compute";
  constexpr std::uint32_t kThreads = gpu::kTgvRegion * gpu::kTgvThreadRows;
  constexpr std::uint32_t kSharedBytes =
      sizeof(float) * gpu::kTgvRegion * (6 * gpu::kTgvRegion + 2 * gpu::kTgvThreadRows);
  const vk::PhysicalDeviceLimits& limits = context.limits();
  if (limits.maxComputeWorkGroupInvocations < kThreads || limits.maxComputeWorkGroupSize[0] < gpu::kTgvRegion)
    return fmt::format("its workgroups have {} threads, {} are needed", limits.maxComputeWorkGroupInvocations,
                       kThreads);
  if (limits.maxComputeSharedMemorySize < kSharedBytes)
    return fmt::format("its workgroups have {} bytes, {} are needed", limits.maxComputeSharedMemorySize,
                       kSharedBytes);
  return {};
}

}  // namespace

class TgvCompute::Impl {
 public:
  explicit Impl(std::unique_ptr<Context> context)
      : context_(std::move(context)), program_(*context_), submissions_(*context_) {
    using Usage = vk::BufferUsageFlagBits;
    for (Transfer& each : transfers_) {
      each.up = Buffer(*context_, TgvProgram::kUploaded * TgvProgram::kArrayBytes, Usage::eTransferSrc);
      each.down = Buffer(*context_, TgvProgram::kArrayBytes, Usage::eTransferDst, Buffer::Access::kRead);
    }
  }

  [[nodiscard]] const Context& context() const noexcept { return *context_; }
  [[nodiscard]] int underWay() const noexcept { return static_cast<int>(batches_.size()); }
  // As many as one dispatch of steps may take: the device is slow until it has shown that it is not.
  [[nodiscard]] std::size_t mostTogether() const noexcept {
    return static_cast<std::size_t>(std::clamp(length_, 1, gpu::kTgvSquares));
  }

  void start(std::span<engine::TgvSquare* const> squares) {
    assert(!squares.empty() && squares.size() <= gpu::kTgvSquares && underWay() < kMostBatches);
    Batch batch;
    batch.squares.assign(squares.begin(), squares.end());
    batch.transfer = started_++ % transfers_.size();
    batch.push = TgvProgram::schedule();
    for (std::size_t i = 0; i < squares.size(); ++i) upload(batch, i);
    batches_.push_back(std::move(batch));
  }

  void proceed(std::vector<engine::TgvSquare*>& finished) {
    const auto next = std::ranges::find_if(
        batches_, [](const Batch& batch) { return batch.recorded < TgvProgram::commands(); });
    if (next != batches_.end())
      submitSome(*next);
    else
      submissions_.waitFor(batches_.front().last);
    const std::uint64_t done = submissions_.done();
    while (!batches_.empty() && batches_.front().recorded == TgvProgram::commands() &&
           batches_.front().last <= done) {
      Batch& batch = batches_.front();
      for (std::size_t i = 0; i < batch.squares.size(); ++i) download(batch, i);
      finished.insert(finished.end(), batch.squares.begin(), batch.squares.end());
      batches_.pop_front();
    }
  }

  void drop() {
    batches_.clear();
    submissions_.finish();
  }

 private:
  struct Batch {
    std::vector<engine::TgvSquare*> squares;
    std::size_t transfer = 0;  // of transfers_
    gpu::TgvPush push{};
    int recorded = 0;        // commands
    std::uint64_t last = 0;  // submission
  };
  struct Transfer {
    Buffer up, down;
  };

  [[nodiscard]] static float* slot(const Buffer& buffer, int array, std::size_t square) {
    constexpr std::size_t kSamples = std::size_t{gpu::kTgvSlot} * gpu::kTgvSlot;
    return reinterpret_cast<float*>(buffer.data()) +
           (static_cast<std::size_t>(array) * gpu::kTgvSquares + square) * kSamples;
  }

  void upload(Batch& batch, std::size_t i) {
    engine::TgvSquare& square = *batch.squares[i];
    assert(square.columns() <= gpu::kTgvSlot && square.rows() <= gpu::kTgvSlot);
    gpu::ivec4& two = batch.push.sizes[i / 2];
    (i % 2 == 0 ? two.x : two.z) = square.columns();
    (i % 2 == 0 ? two.y : two.w) = square.rows();
    const Buffer& up = transfers_[batch.transfer].up;
    for (int r = 0; r < square.rows(); ++r) {
      const engine::tgv::Row row = square.row(r);
      const std::array<const float*, TgvProgram::kUploaded> arrays{row.f, row.wp, row.wq,
                                                                   row.u, row.x,  row.y};
      for (std::size_t a = 0; a < arrays.size(); ++a)
        std::copy_n(arrays[a], square.columns(), slot(up, static_cast<int>(a), i) + r * gpu::kTgvSlot);
    }
  }

  void download(const Batch& batch, std::size_t i) {
    engine::TgvSquare& square = *batch.squares[i];
    const float* u = slot(transfers_[batch.transfer].down, 0, i);
    for (int r = 0; r < square.rows(); ++r)
      std::copy_n(u + r * gpu::kTgvSlot, square.columns(), square.row(r).u);
  }

  void submitSome(Batch& batch) {
    submissions_.begin();
    fitLength();
    const Transfer& transfer = transfers_[batch.transfer];
    const int squares = static_cast<int>(batch.squares.size());
    const int most = std::min(std::max(1, length_ / squares), TgvProgram::commands() - batch.recorded);
    for (int i = 0; i < most; ++i)
      program_.record(submissions_.commands(), batch.recorded++, squares, batch.push, *transfer.up.handle(),
                      *transfer.down.handle());
    batch.last = submissions_.next();
    lengths_[batch.last % lengths_.size()] = most * squares;
    submissions_.submit({});
  }

  // By the time of the last one that is done. It began with the one before it still in progress, so half of that time
  // is its own.
  void fitLength() {
    const std::uint64_t done = submissions_.done();
    if (done == fitted_) return;
    fitted_ = done;
    const double was = lengths_[done % lengths_.size()];
    const double fits = was * 1.5 * kLongestComputeMs / std::max(submissions_.lastMs(), 1e-3);
    length_ = static_cast<int>(std::clamp(fits, 1.0, 2.0 * was));
  }

  std::unique_ptr<Context> context_;
  TgvProgram program_;
  std::array<Transfer, kMostBatches> transfers_;
  std::deque<Batch> batches_;  // oldest first
  std::size_t started_ = 0;
  int length_ = 1;                                     // of the next submission [commands of one square]
  std::array<int, Submissions::kInFlight> lengths_{};  // of the last ones
  std::uint64_t fitted_ = 0;                           // to this submission
  Submissions submissions_;                            // destroyed first: waits for what uses the others
};

TgvCompute::TgvCompute(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TgvCompute::~TgvCompute() = default;

engine::Result<std::unique_ptr<TgvCompute>> TgvCompute::create(const DeviceOptions& options) {
  auto context = Context::create(options);
  if (!context && options.kind == DriverKind::kHardware) return nullptr;
  if (!context) return tl::unexpected(context.error());
  const std::string device = (*context)->name();
  if (const std::string why = shortcoming(**context); !why.empty())
    return engine::failure("the device cannot compute filters: " + why, device, "use --compute cpu");
  try {
    return std::unique_ptr<TgvCompute>(new TgvCompute(std::make_unique<Impl>(*std::move(context))));
  } catch (const vk::SystemError& error) {
    return engine::failure(fmt::format("the device does not compute ({})", error.what()), device,
                           "use --compute cpu");
  }
}

const std::string& TgvCompute::name() const noexcept {
  return impl_->context().name();
}

std::vector<std::string> TgvCompute::messages() const {
  return impl_->context().messages().all();
}

std::size_t TgvCompute::mostTogether() const noexcept {
  return impl_->mostTogether();
}

int TgvCompute::underWay() const noexcept {
  return impl_->underWay();
}

engine::Status TgvCompute::start(std::span<engine::TgvSquare* const> squares) {
  impl_->start(squares);
  return {};
}

engine::Status TgvCompute::proceed(std::vector<engine::TgvSquare*>& finished) try {
  impl_->proceed(finished);
  return {};
} catch (const vk::SystemError& error) {
  return engine::failure(fmt::format("computing failed ({})", error.what()), name(), "use --compute cpu");
}

void TgvCompute::drop() noexcept {
  try {
    impl_->drop();
  } catch (const vk::SystemError&) {
    // A lost device has no work in progress.
  }
}

}  // namespace fettle::render
