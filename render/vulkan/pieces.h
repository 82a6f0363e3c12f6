#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/base/job.h"
#include "render/vulkan/context.h"

namespace fettle::render {

/// Bands an image is cut into at most; an instance counts as so many steps of progress.
inline constexpr std::uint32_t kPieceSteps = 16;

/// What one submission draws: some instances, within some rows of the image.
struct Piece {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  vk::Rect2D scissor;
};

/// Chooses the next piece so that each takes about a given time whatever the device: many instances when
/// they are quick, bands of a single one when it fills the picture slowly. Instances stay in order in every
/// pixel, so the choice, which follows the clock, never shows in the picture.
class PieceSizes {
 public:
  /// `wanted_ms` > 0; infinity never cuts.
  explicit PieceSizes(double wanted_ms) : wanted_ms_(wanted_ms) {}
  /// Instances and bands of the next piece when `count` are to be drawn altogether: at least kPieceSteps
  /// pieces, because the time of quick instances tells little of one that fills the picture.
  [[nodiscard]] std::uint32_t instances(std::uint32_t count) const noexcept;
  [[nodiscard]] std::uint32_t bands(std::uint32_t count) const noexcept;
  /// How long the last piece took [ms], and how many instances it had.
  void learn(double took_ms, std::uint32_t taken);

 private:
  double wanted_ms_;
  std::uint32_t instances_ = 1;
  std::uint32_t bands_ = 8;
};

/// Runs pieces one after the other, each submitted and waited for, until the job is cancelled.
///
/// Threading: as Context. Throws vk::SystemError.
class PieceRunner {
 public:
  PieceRunner(Context& context, double wanted_ms, engine::JobControl& job)
      : context_(context), sizes_(wanted_ms), job_(job) {}

  /// Draws `count` instances over an image; the job advances by kPieceSteps an instance. False: cancelled,
  /// with some of them not drawn.
  [[nodiscard]] bool instances(std::size_t count, vk::Extent2D extent,
                               const std::function<void(const vk::raii::CommandBuffer&, const Piece&)>& draw);
  /// Draws one thing; the job advances by 1. False: cancelled before it.
  [[nodiscard]] bool one(const std::function<void(const vk::raii::CommandBuffer&)>& draw);

 private:
  Context& context_;
  PieceSizes sizes_;
  engine::JobControl& job_;
};

/// Bands of whole rows that together make up the picture, top to bottom, each reading at most about 4 million
/// rays (`samples_per_side` squared a pixel), at least one row high.
[[nodiscard]] std::vector<vk::Rect2D> picturePieces(vk::Extent2D extent, int samples_per_side);

}  // namespace fettle::render
