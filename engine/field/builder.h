#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Makes the first version of a field: starts with every sample a hole and no mark, accepts blocks of samples
/// in any order, and builds a Version from them.
///
/// Threading: writeHeights and writeMarks may be called from several threads at once as long as no two calls
/// touch the same sample, for marks the same row of a tile. create() and build() use all cores.
class FieldBuilder {
 public:
  /// Content of the samples before they are written.
  enum class Start : std::uint8_t {
    kHoles,
    kUnwritten,  ///< undefined: the caller writes every sample before build(). Saves a pass over the field
  };

  /// Allocates all tiles, in memory or in a store as memoryFor (tile_store.h) decides. Errors: a side outside
  /// 1 .. Grid::kMaxSide, a spacing that is not finite and positive, not enough memory. `what` names the
  /// field in the error, usually the file.
  [[nodiscard]] static Result<FieldBuilder> create(Grid grid, const std::string& what,
                                                   Start start = Start::kHoles);

  /// As create, in the memory of an existing field, so that both share one pool.
  [[nodiscard]] static Result<FieldBuilder> create(Grid grid, std::shared_ptr<FieldMemory> memory,
                                                   const std::string& what, Start start = Start::kHoles);

  FieldBuilder(FieldBuilder&&) = default;
  FieldBuilder& operator=(FieldBuilder&&) = default;

  [[nodiscard]] const Grid& grid() const noexcept { return description_->grid; }

  /// Writes samples (row-major, stride in elements, [height_unit]); the rectangle lies in the field. NaN is a
  /// hole; an infinity becomes one and is counted.
  void writeHeights(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                    const float* heights, std::ptrdiff_t stride) noexcept;

  /// Writes marks: non-zero = marked.
  void writeMarks(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                  const std::uint8_t* marks, std::ptrdiff_t stride) noexcept;

  /// Tile (tc, tr) itself, for readers that store whole tiles: fill `samples` and `marks` as Tile requires
  /// (no infinity; holes and no marks outside the field); build() computes the rest. Threading as
  /// writeHeights.
  [[nodiscard]] Tile& tile(std::int32_t tc, std::int32_t tr) noexcept {
    return *tiles_[static_cast<std::size_t>(tr) * tile_columns_ + tc];
  }

  /// Reports that `samples` of tile (tc, tr) are written now, each sample once and finally, in a builder that
  /// started kUnwritten: the call that completes a tile computes its bounds and counts immediately, while it
  /// is in the processor's cache. build() computes those of tiles not completed by reports. Threading: any.
  void wrote(std::int32_t tc, std::int32_t tr, std::int32_t samples) noexcept;

  /// Samples that were infinite and became holes.
  [[nodiscard]] std::int64_t infinities() const noexcept {
    return infinities_->load(std::memory_order_relaxed);
  }

  /// Bounds, counts and the tree; the builder is empty afterwards.
  [[nodiscard]] Version build() &&;

 private:
  /// The values of a tile that its node stores. In a store, reading the tile again would read it from the
  /// disk.
  struct Summary {
    HeightBounds bounds;
    bool marked = false;
    bool holed = false;
  };

  FieldBuilder(Grid grid, std::shared_ptr<FieldMemory> memory);
  void summarise(std::size_t place) noexcept;
  [[nodiscard]] std::int32_t samplesOf(std::size_t place) const noexcept;
  [[nodiscard]] Node* buildNode(int level, std::int32_t column, std::int32_t row, bool& marked, bool& holed,
                                HeightBounds& bounds);

  std::shared_ptr<const FieldDescription> description_;
  std::shared_ptr<FieldMemory> memory_;
  std::vector<TileRef> tiles_;      // row-major
  std::vector<Summary> summaries_;  // of each
  // Samples of each that wrote() has not reported yet; none where the builder started with holes.
  std::unique_ptr<std::atomic<std::int32_t>[]> missing_;
  std::int32_t tile_columns_ = 0;
  std::int32_t tile_rows_ = 0;
  std::unique_ptr<std::atomic<std::int64_t>> infinities_;
};

/// A field from one plain array, for tests and small fields: heights row-major, row 0 lowest, width * height
/// elements; marks empty or as many bytes. Asserts that the sizes agree.
[[nodiscard]] Version makeField(const Grid& grid, const std::vector<float>& heights,
                                const std::vector<std::uint8_t>& marks = {});

}  // namespace fettle::engine
