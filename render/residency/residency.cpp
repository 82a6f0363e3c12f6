#include "render/residency/residency.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "render/config.h"

namespace fettle::render {

PoolShape choosePool(std::uint64_t budget, std::size_t bytes_per_sample, std::uint32_t max_side,
                     std::uint32_t max_layers, std::uint64_t max_bytes, std::optional<int> log2_side) {
  PoolShape shape;
  const auto pages = [&] { return budget / bytes_per_sample >> (2 * shape.log2_side); };
  shape.log2_side =
      std::clamp(static_cast<int>(std::bit_width(max_side)) - 1, kSmallestLog2Page, kLargestLog2Page);
  while (shape.log2_side > kSmallestLog2Page && pages() < kFewPages) --shape.log2_side;
  if (log2_side) shape.log2_side = *log2_side;
  // The limit of an image's size applies to the heights, the larger of the two images.
  const std::uint64_t most = std::min(pages(), max_bytes / sizeof(float) >> (2 * shape.log2_side));
  const std::uint64_t widest = std::clamp<std::uint64_t>(max_side >> shape.log2_side, 1, 255);
  // A layer is at most an eighth of all pages, so that rounding to whole layers loses little; larger where
  // there would be too many layers. Always a power of two: drivers of processors compile all shaders again for an image
  // whose sides become powers of two, or no longer are, and a pool grows while somebody works.
  while (2 * shape.across <= widest && (std::uint64_t{32} * shape.across * shape.across <= most ||
                                        most / (shape.across * shape.across) > max_layers))
    shape.across *= 2;
  shape.layers =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(most / (shape.across * shape.across), max_layers));
  return shape;
}

std::size_t PageSlots::NameHash::operator()(const Name& name) const noexcept {
  auto h = static_cast<std::uint64_t>(name.number) * 0x9e3779b97f4a7c15U;
  for (const void* p : name.key) {
    h ^= reinterpret_cast<std::uintptr_t>(p);
    h *= 0xff51afd7ed558ccdU;
    h ^= h >> 32U;
  }
  return static_cast<std::size_t>(h);
}

PageSlots::PageSlots(std::uint32_t count) : slots_(count), free_(count) {
  for (std::uint32_t i = 0; i < count; ++i) listAtBack(i);
}

void PageSlots::grow(std::uint32_t more) {
  const std::uint32_t first = count();
  slots_.resize(slots_.size() + more);
  free_ += more;
  for (std::uint32_t i = count(); i > first; --i) listAtFront(i - 1);
}

void PageSlots::unlist(std::uint32_t slot) noexcept {
  Slot& s = slots_[slot];
  if (!s.listed) return;
  (s.before == kNone ? front_ : slots_[s.before].after) = s.after;
  (s.after == kNone ? back_ : slots_[s.after].before) = s.before;
  s.before = s.after = kNone;
  s.listed = false;
}

void PageSlots::listAtFront(std::uint32_t slot) noexcept {
  Slot& s = slots_[slot];
  s.after = front_;
  (front_ == kNone ? back_ : slots_[front_].before) = slot;
  front_ = slot;
  s.listed = true;
}

void PageSlots::listAtBack(std::uint32_t slot) noexcept {
  Slot& s = slots_[slot];
  s.before = back_;
  (back_ == kNone ? front_ : slots_[back_].after) = slot;
  back_ = slot;
  s.listed = true;
}

void PageSlots::hold(std::uint32_t slot, std::uint32_t* entry, Hold hold, std::uint64_t frame) {
  Slot& s = slots_[slot];
  *entry = slot;
  if (s.holders.empty()) --free_;
  s.holders.push_back({entry, hold});
  if (hold == Hold::kFixed && s.fixed++ == 0) ++fixed_;
  s.frame = std::max(s.frame, frame);
  unlist(slot);
  if (s.fixed == 0) listAtBack(slot);
}

bool PageSlots::take(std::uint32_t* entry, Hold keep, std::uint64_t frame) {
  assert(*entry == kNone);
  const std::uint32_t slot = front_;
  if (slot == kNone) return false;
  Slot& s = slots_[slot];
  if (!s.holders.empty()) {
    if (s.frame >= frame) return false;
    for (const Holder& h : s.holders) *h.entry = kNone;
    s.holders.clear();
    ++free_;
    ++evicted_;
  }
  clearName(slot);
  hold(slot, entry, keep, frame);
  return true;
}

bool PageSlots::share(std::uint32_t* entry, Hold keep, int number, const PageGrid::Key& key,
                      std::uint64_t frame) {
  assert(*entry == kNone);
  const auto found = named_.find({number, key});
  if (found == named_.end()) return false;
  hold(found->second, entry, keep, frame);
  return true;
}

void PageSlots::use(std::uint32_t slot, std::uint64_t frame) {
  Slot& s = slots_[slot];
  s.frame = frame;
  if (s.fixed != 0) return;
  unlist(slot);
  listAtBack(slot);
}

void PageSlots::release(std::uint32_t* entry) {
  if (*entry == kNone) return;
  const std::uint32_t slot = *entry;
  Slot& s = slots_[slot];
  const auto mine =
      std::find_if(s.holders.begin(), s.holders.end(), [&](const Holder& h) { return h.entry == entry; });
  assert(mine != s.holders.end());
  if (mine->hold == Hold::kFixed && --s.fixed == 0) --fixed_;
  s.holders.erase(mine);
  *entry = kNone;
  if (s.holders.empty()) {
    ++free_;
    clearName(slot);
    s.frame = 0;
    unlist(slot);
    listAtFront(slot);
  } else if (s.fixed == 0 && !s.listed) {
    listAtBack(slot);
  }
}

void PageSlots::name(std::uint32_t slot, int number, const PageGrid::Key& key) {
  clearName(slot);
  if (std::all_of(key.begin(), key.end(), [](const void* p) { return p == nullptr; })) return;
  Slot& s = slots_[slot];
  s.name = {number, key};
  // The first of two equal pages is found; the second one stays unnamed.
  s.named = named_.emplace(s.name, slot).second;
}

void PageSlots::clearName(std::uint32_t slot) {
  Slot& s = slots_[slot];
  if (s.named) named_.erase(s.name);
  s.named = false;
}

}  // namespace fettle::render
