#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "render/residency/page_table.h"

namespace fettle::render {

/// What a pool of pages looks like.
struct PoolShape {
  int log2_side = 6;         ///< of a page [samples]
  std::uint32_t across = 1;  ///< pages along each side of a layer, <= 255
  std::uint32_t layers = 0;  ///< 0: the budget holds no page
  [[nodiscard]] std::uint32_t pages() const noexcept { return across * across * layers; }
};
/// The most that `budget` bytes hold, in images of sides up to `max_side` [samples, >= 64], of at most
/// `max_layers` layers and `max_bytes` bytes. Pages are of 256 samples a side, or smaller ones where that
/// makes fewer than kFewPages. `log2_side`, kSmallestLog2Page .. kLargestLog2Page: pages of
/// that side in any case.
[[nodiscard]] PoolShape choosePool(std::uint64_t budget, std::size_t bytes_a_sample, std::uint32_t max_side,
                                   std::uint32_t max_layers, std::uint64_t max_bytes,
                                   std::optional<int> log2_side = {});

/// Which page lies in which slot of a pool, who points at it, and which one goes when room is needed: the one
/// asked for longest ago. Slots are numbered 0 .. count - 1. Pages of equal key share a slot.
///
/// A table entry is a std::uint32_t of somebody else's that holds the slot, or kNone; it is set to kNone here
/// when its page goes, and must stay put as long as it holds a slot.
///
/// Threading: one thread at a time. Every call takes constant time, but for the entries of a shared slot.
class PageSlots {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  explicit PageSlots(std::uint32_t count);

  enum class Hold {
    kFixed,  ///< stays until released
    kWhile,  ///< goes when room is needed
  };
  /// As many slots more, free ones, behind those there are.
  void grow(std::uint32_t more);
  /// A slot for `entry` (which holds none) with nothing in it yet: a free one, or that of the page used
  /// longest ago, unless that was in frame `frame` itself. False when there is none.
  [[nodiscard]] bool take(std::uint32_t* entry, Hold hold, std::uint64_t frame);
  /// Points `entry` (which holds none) at the slot of an equal page, if there is one.
  [[nodiscard]] bool share(std::uint32_t* entry, Hold hold, int number, const PageGrid::Key& key,
                           std::uint64_t frame);
  /// The page is wanted in this frame: it stays through it.
  void use(std::uint32_t slot, std::uint64_t frame);
  [[nodiscard]] bool usedIn(std::uint32_t slot, std::uint64_t frame) const noexcept {
    return at(slot).frame == frame;
  }
  void release(std::uint32_t* entry);

  /// What a slot holds, so that share() finds it: page `number` of a grid (all grids of a pool are alike).
  /// Nothing for a key of null pointers.
  void name(std::uint32_t slot, int number, const PageGrid::Key& key);
  /// What a slot holds is no longer what its key said, or what the key points at may go.
  void forget(std::uint32_t slot);
  [[nodiscard]] bool named(std::uint32_t slot) const noexcept { return at(slot).named; }
  /// Entries that point at a slot.
  [[nodiscard]] std::size_t holders(std::uint32_t slot) const noexcept { return at(slot).holders.size(); }

  [[nodiscard]] std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(slots_.size()); }
  [[nodiscard]] std::uint32_t used() const noexcept { return count() - free_; }
  /// Slots that entries hold for good.
  [[nodiscard]] std::uint32_t fixed() const noexcept { return fixed_; }
  /// Room promised to entries that hold for good, as if none of them shared a slot: each may come to need one
  /// of its own. False when there is not that much.
  [[nodiscard]] bool reserve(std::uint32_t entries) noexcept {
    if (entries > count() - reserved_) return false;
    reserved_ += entries;
    return true;
  }
  void giveBack(std::uint32_t entries) noexcept { reserved_ -= entries; }
  /// Pages that went because room was needed, ever.
  [[nodiscard]] std::int64_t evicted() const noexcept { return evicted_; }

 private:
  struct Name {
    int number = 0;
    PageGrid::Key key{};
    friend bool operator==(const Name&, const Name&) = default;
  };
  struct NameHash {
    std::size_t operator()(const Name& name) const noexcept;
  };
  struct Holder {
    std::uint32_t* entry;
    Hold hold;
  };
  struct Slot {
    std::vector<Holder> holders;
    std::uint32_t fixed = 0;  // of them
    std::uint64_t frame = 0;
    std::uint32_t before = kNone, after = kNone;  // in the list of slots that may go; kNone: its ends
    bool listed = false, named = false;
    Name name;
  };
  [[nodiscard]] const Slot& at(std::uint32_t slot) const noexcept { return slots_[slot]; }
  void unlist(std::uint32_t slot) noexcept;
  void listAtFront(std::uint32_t slot) noexcept;  // goes first
  void listAtBack(std::uint32_t slot) noexcept;   // goes last
  void hold(std::uint32_t slot, std::uint32_t* entry, Hold hold, std::uint64_t frame);

  std::vector<Slot> slots_;
  std::uint32_t front_ = kNone, back_ = kNone;
  std::uint32_t free_ = 0, fixed_ = 0, reserved_ = 0;
  std::int64_t evicted_ = 0;
  std::unordered_map<Name, std::uint32_t, NameHash> named_;
};

}  // namespace fettle::render
