#include "render/vulkan/pieces.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace fettle::render {
namespace {

vk::Rect2D rows(vk::Extent2D extent, std::uint32_t from, std::uint32_t to) {
  return {{0, static_cast<std::int32_t>(from)}, {extent.width, to - from}};
}

}  // namespace

std::uint32_t PieceSizes::instances(std::uint32_t count) const noexcept {
  if (std::isinf(wanted_ms_)) return count;
  return std::min(instances_, (count + kPieceSteps - 1) / kPieceSteps);
}

std::uint32_t PieceSizes::bands(std::uint32_t count) const noexcept {
  if (std::isinf(wanted_ms_)) return 1;
  return std::max(bands_, (kPieceSteps + count - 1) / count);
}

void PieceSizes::learn(double took_ms, std::uint32_t taken) {
  if (took_ms > wanted_ms_) {
    // Back to half the time at once: what made one piece slow is likely to make the next one so too.
    const double share = std::max(1.0 / 64.0, 0.5 * wanted_ms_ / took_ms);
    if (taken > 1)
      instances_ = std::max(1U, static_cast<std::uint32_t>(taken * share));
    else
      bands_ = std::min(kPieceSteps, 2 * bands_);
  } else if (took_ms < 0.5 * wanted_ms_) {
    if (bands_ > 1)
      bands_ /= 2;
    else if (taken >= instances_)
      instances_ = std::min(1U << 20U, 2 * instances_);
  }
}

bool PieceRunner::instances(std::size_t count, vk::Extent2D extent,
                            const std::function<void(const vk::raii::CommandBuffer&, const Piece&)>& draw) {
  const auto end = static_cast<std::uint32_t>(count);
  for (std::uint32_t first = 0; first < end;) {
    const std::uint32_t taken = std::min(sizes_.instances(end), end - first);
    // A band has a row at least. All bands of an instance before the next one, or it would be drawn twice.
    const std::uint32_t bands = std::min(sizes_.bands(end), std::max(1U, extent.height));
    std::uint64_t told = 0;
    double slowest = 0.0;
    for (std::uint32_t band = 0; band < bands; ++band) {
      if (job_.cancelled()) return false;
      const auto row = [&](std::uint32_t k) {
        return static_cast<std::uint32_t>(std::uint64_t{extent.height} * k / bands);
      };
      const Piece piece{first, taken, rows(extent, row(band), row(band + 1))};
      const auto start = std::chrono::steady_clock::now();
      context_.run([&](const vk::raii::CommandBuffer& commands) { draw(commands, piece); });
      slowest = std::max(
          slowest,
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
      const std::uint64_t done = std::uint64_t{taken} * kPieceSteps * (band + 1) / bands;
      job_.advance(done - told);
      told = done;
    }
    sizes_.learn(slowest, taken);
    first += taken;
  }
  return true;
}

bool PieceRunner::one(const std::function<void(const vk::raii::CommandBuffer&)>& draw) {
  if (job_.cancelled()) return false;
  context_.run(draw);
  job_.advance();
  return true;
}

std::vector<vk::Rect2D> picturePieces(vk::Extent2D extent, int samples_per_side) {
  constexpr std::uint64_t kRays = 1U << 22U;
  const std::uint64_t rays_a_row =
      std::uint64_t{extent.width} * static_cast<std::uint64_t>(samples_per_side * samples_per_side);
  const auto height =
      static_cast<std::uint32_t>(std::max<std::uint64_t>(1, kRays / std::max<std::uint64_t>(1, rays_a_row)));
  std::vector<vk::Rect2D> pieces;
  for (std::uint32_t from = 0; from < extent.height; from += height)
    pieces.push_back(rows(extent, from, std::min(extent.height, from + height)));
  return pieces;
}

}  // namespace fettle::render
