#pragma once

#include <cstdint>
#include <memory>

#include "engine/field/version.h"

namespace fettle::engine {

/// Whether a LiveField may request memory from the system when its pool is empty.
enum class Growth {
  kNever,    ///< the haptic loop: a write that finds the pool empty changes nothing and returns false
  kAllowed,  ///< replay, import, jobs
};

/// The only state of a field that may be written. Writing first copies what is shared with a version (one
/// tile and one node per level), and writes in place what is not.
///
/// Threading: one owner thread at a time. With Growth::kNever no method but the constructor and destructor
/// allocates, locks or throws; snapshot() is O(1). Its versions may be read and dropped by any thread.
class LiveField {
 public:
  LiveField(Version start, Growth growth) noexcept;
  LiveField& operator=(LiveField&&) = delete;

  [[nodiscard]] const Grid& grid() const noexcept { return state_.grid(); }
  /// Valid until the next write.
  [[nodiscard]] FieldReader reader() const noexcept { return state_.reader(); }

  /// As Version::lineCuts(); valid until adopt().
  [[nodiscard]] const LineCuts* lineCuts() const noexcept { return state_.lineCuts(); }

  /// The present state, immutable from now on. O(1).
  [[nodiscard]] Version snapshot() const noexcept { return state_; }

  /// Continues from another version of the same grid; returns the previous state, so that the caller decides
  /// on which thread it is freed.
  [[nodiscard]] Version adopt(Version version) noexcept;

  /// Turns the field upside down: changes the sign, no sample.
  void invert() noexcept { state_.sign_ = -state_.sign_; }

  /// Writes the samples [column, column + columns) x [row, row + rows), which must lie in the field, from
  /// `heights` (row-major, stride in elements, [height_unit], with the version's sign as in readHeights; NaN
  /// makes a hole, an infinity counts as one). Tiles whose bits would not change are not copied. False, and
  /// nothing changed, when the pool is empty (Growth::kNever) or memory is exhausted.
  [[nodiscard]] bool writeHeights(std::int32_t column, std::int32_t row, std::int32_t columns,
                                  std::int32_t rows, const float* heights, std::ptrdiff_t stride) noexcept;

  /// The same for one sample.
  [[nodiscard]] bool setHeight(std::int32_t column, std::int32_t row, float height) noexcept;

  /// Marks (or unmarks) one sample. False, and nothing changed, as for writeHeights.
  [[nodiscard]] bool setMark(std::int32_t column, std::int32_t row, bool marked) noexcept;

  /// Puts a whole tile in place (bounds and counts already right), taking over the reference.
  [[nodiscard]] bool replaceTile(std::int32_t tc, std::int32_t tr, TileRef tile) noexcept;

  /// A tile to fill and pass to replaceTile; empty when the pool is empty as above.
  [[nodiscard]] TileRef newTile() noexcept;

  /// Writes refused because the pool was empty.
  [[nodiscard]] std::uint64_t refusedWrites() const noexcept { return refused_; }

 private:
  static constexpr int kMaxDepth = 5;
  struct Path {
    Node* nodes[kMaxDepth];  // nodes[0] = root
    int depth = 0;
    Tile* tile = nullptr;
  };
  [[nodiscard]] Node* ownNode(Node*& slot) noexcept;
  [[nodiscard]] bool ownNodes(std::int32_t tc, std::int32_t tr, Path& path) noexcept;
  [[nodiscard]] bool ownTile(std::int32_t tc, std::int32_t tr, Path& path) noexcept;
  static void publish(const Path& path, std::int32_t tc, std::int32_t tr, bool holed) noexcept;
  [[nodiscard]] bool tileHoled(const Tile& tile, std::int32_t tc, std::int32_t tr) const noexcept;

  Version state_;
  Growth growth_;
  std::uint64_t refused_ = 0;
};

}  // namespace fettle::engine
