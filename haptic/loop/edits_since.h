#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "engine/field/live_field.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::haptic {

/// The version that a job's result will be merged into, and the tiles that the loop edited since (the steps are
/// in loop_tick.h). Loop thread; noexcept, nothing allocated or freed.
class EditsSince {
 public:
  static constexpr int kMostTiles = 64;

  /// Starts a list for the job `id`. Returns the previous base, to be freed elsewhere.
  [[nodiscard]] engine::Version begin(engine::Version base, std::uint64_t id) noexcept {
    id_ = id;
    valid_ = true;
    count_ = 0;
    return std::exchange(base_, std::move(base));
  }
  /// The list no longer says what was edited: the state was replaced.
  void drop() noexcept { valid_ = false; }
  /// Ends the list. Returns its base, to be freed elsewhere.
  [[nodiscard]] engine::Version end() noexcept {
    valid_ = false;
    return std::move(base_);
  }
  [[nodiscard]] bool covers(std::uint64_t id) const noexcept { return valid_ && id == id_; }

  /// Adds the tiles of an edit; more than kMostTiles are too many, and the list is dropped.
  void add(const engine::SampleRect& rect) noexcept;

  /// Puts the tiles that `live` has changed since the base into `field`. Returns their number; -1 when the pool
  /// of tiles is empty, the field is then partly changed.
  [[nodiscard]] int carryInto(engine::LiveField& field, const engine::Version& live) const noexcept;

 private:
  struct TileIndex {
    std::int32_t column, row;
  };

  engine::Version base_;
  std::uint64_t id_ = 0;
  bool valid_ = false;
  std::array<TileIndex, kMostTiles> tiles_{};
  int count_ = 0;
};

}  // namespace fettle::haptic
