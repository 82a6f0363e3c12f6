#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "render/residency/page_table.h"

namespace fettle::render {

/// Dimensions of a pool of pages.
struct PoolShape {
  int log2_side = 6;         ///< of a page [samples]
  std::uint32_t across = 1;  ///< pages along each side of a layer: a power of two, <= 128
  std::uint32_t layers = 0;  ///< 0: the budget holds no page
  [[nodiscard]] std::uint32_t pages() const noexcept { return across * across * layers; }
};
/// The largest pool within `budget` bytes, in images of sides up to `max_side` [samples, >= 64], of at most
/// `max_layers` layers and `max_bytes` bytes. Pages are of 256 samples per side, or smaller where that makes
/// fewer than kFewPages. `log2_side`, kSmallestLog2Page .. kLargestLog2Page: pages of that side in any case.
[[nodiscard]] PoolShape choosePool(std::uint64_t budget, std::size_t bytes_per_sample, std::uint32_t max_side,
                                   std::uint32_t max_layers, std::uint64_t max_bytes,
                                   std::optional<int> log2_side = {});

/// Which page is in which slot of a pool, which entries point at it, and which page is evicted: the least
/// recently requested one. Slots are numbered 0 .. count - 1. Pages of equal key share a slot.
///
/// A table entry is a std::uint32_t of the caller that holds the slot, or kNone; it is set to kNone here when
/// its page is evicted, and must not move in memory as long as it holds a slot.
///
/// Threading: one thread at a time. Every call takes constant time, but for the entries of a shared slot.
class PageSlots {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  explicit PageSlots(std::uint32_t count);

  enum class Hold {
    kFixed,      ///< stays until released
    kEvictable,  ///< may be evicted
  };
  /// Adds free slots behind the existing ones.
  void grow(std::uint32_t more);
  /// An empty slot for `entry` (which holds none): a free one, or that of the least recently used page,
  /// unless that was used in frame `frame` itself. False when there is none.
  [[nodiscard]] bool take(std::uint32_t* entry, Hold hold, std::uint64_t frame);
  /// Points `entry` (which holds none) at the slot of an equal page, if there is one.
  [[nodiscard]] bool share(std::uint32_t* entry, Hold hold, int number, const PageGrid::Key& key,
                           std::uint64_t frame);
  /// The page is requested in this frame: it stays through it.
  void use(std::uint32_t slot, std::uint64_t frame);
  [[nodiscard]] bool usedIn(std::uint32_t slot, std::uint64_t frame) const noexcept {
    return at(slot).frame == frame;
  }
  void release(std::uint32_t* entry);

  /// Content of a slot, so that share() finds it: page `number` of a grid (all grids of a pool are alike). No
  /// effect for a key of null pointers.
  void name(std::uint32_t slot, int number, const PageGrid::Key& key);
  /// The content of a slot no longer matches its key, or the memory that the key points at may be reused.
  void clearName(std::uint32_t slot);
  [[nodiscard]] bool named(std::uint32_t slot) const noexcept { return at(slot).named; }
  /// Entries that point at a slot.
  [[nodiscard]] std::size_t holders(std::uint32_t slot) const noexcept { return at(slot).holders.size(); }

  [[nodiscard]] std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(slots_.size()); }
  [[nodiscard]] std::uint32_t used() const noexcept { return count() - free_; }
  /// Slots that entries hold permanently.
  [[nodiscard]] std::uint32_t fixed() const noexcept { return fixed_; }
  /// Reserves slots for entries that hold permanently, as if none of them shared a slot: each may later need
  /// one of its own. False when too few are left.
  [[nodiscard]] bool reserve(std::uint32_t entries) noexcept {
    if (entries > count() - reserved_) return false;
    reserved_ += entries;
    return true;
  }
  void unreserve(std::uint32_t entries) noexcept { reserved_ -= entries; }
  /// Number of evicted pages since the start.
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
    std::uint32_t before = kNone, after = kNone;  // in the list of slots that may be evicted; kNone: its ends
    bool listed = false, named = false;
    Name name;
  };
  [[nodiscard]] const Slot& at(std::uint32_t slot) const noexcept { return slots_[slot]; }
  void unlist(std::uint32_t slot) noexcept;
  void listAtFront(std::uint32_t slot) noexcept;  // evicted first
  void listAtBack(std::uint32_t slot) noexcept;   // evicted last
  void hold(std::uint32_t slot, std::uint32_t* entry, Hold hold, std::uint64_t frame);

  std::vector<Slot> slots_;
  std::uint32_t front_ = kNone, back_ = kNone;
  std::uint32_t free_ = 0, fixed_ = 0, reserved_ = 0;
  std::int64_t evicted_ = 0;
  std::unordered_map<Name, std::uint32_t, NameHash> named_;
};

}  // namespace fettle::render
