#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/filter/block_pass.h"

namespace fettle::engine {

/// Goes along with one applyFilter, block by block: what of its work is there already, and what it has worked out. It
/// decides what is done, never what comes out.
///
/// isDone(), done(), wish() and rank() are called by the workers of a pass, any number at a time; the rest on the thread of applyFilter,
/// while none works.
class FilterWork {
 public:
  FilterWork() = default;
  FilterWork& operator=(FilterWork&&) = delete;
  virtual ~FilterWork() = default;

  /// A field after some of the passes.
  struct State {
    int passes = 0;
    Version field;
  };
  /// Where to begin: `input` and no pass, or later.
  [[nodiscard]] virtual Result<State> begin(const Version& input) = 0;

  /// The next pass begins, from this state.
  [[nodiscard]] virtual Status beginPass(const State& before) = 0;

  /// Where a pass stands that goes over the whole field round by round before its first block.
  struct Rounds {
    int done = 0;
    double limit = 0.0;   ///< beyond which samples do not count in the next one [height_unit]
    std::string numbers;  ///< the surface that the last one left, in the pass's own form: any bytes
  };
  /// Those of the pass that has begun; nothing: none.
  [[nodiscard]] virtual std::optional<Rounds> roundsBefore() { return std::nullopt; }
  /// Whether roundDone() would be of use now: it copies a surface.
  [[nodiscard]] virtual bool wantsRounds() { return false; }
  virtual void roundDone(const Rounds&) {}

  /// Number of the order in which blocks are worked out; another number is another order. 0: row by row,
  /// as long as the pass lasts.
  [[nodiscard]] virtual std::uint64_t wish() { return 0; }
  /// The block of the least rank comes first. Not called in the order of number 0.
  [[nodiscard]] virtual double rank(const TileRect&) { return 0.0; }

  /// Whether the tiles of a block need not be worked out. Where it is false, done() or a cancel follows on this thread.
  [[nodiscard]] virtual bool isDone(const TileRect& block) = 0;

  /// A block was worked out: those of its tiles that changed, from made[first] on. Removes of these the ones that
  /// addMade() will append. Throws std::bad_alloc.
  virtual void done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) = 0;

  /// At the end of a pass: appends its tiles that were there already and changed.
  virtual void addMade(std::vector<NewTile>& made) = 0;
};

}  // namespace fettle::engine
