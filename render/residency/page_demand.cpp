#include "render/residency/page_demand.h"

#include <algorithm>

namespace fettle::render {
namespace {

// The vertex of a hole reads its surroundings. Level 0 does not know of holes.
bool readsSurroundings(const PatchLeaf& leaf) {
  return leaf.holed || leaf.level == 0;
}

}  // namespace

void PageDemand::requestSpan(LiveTexture& texture, const LevelSpan& span, std::uint64_t frame) {
  PageSet& pages = *texture.pages();
  auto count = std::find_if(request_counts_.begin(), request_counts_.end(),
                            [&](const auto& of) { return of.first == &texture; });
  if (count == request_counts_.end()) count = request_counts_.insert(request_counts_.end(), {&texture, 0});
  // Coarser levels too, until the finer one is uploaded.
  for (int level = span.level; level < pages.fixedFrom(); ++level) {
    const int shift = dataShift(level - span.level);
    pages.grid().over({level, span.low >> shift, span.high >> shift}, [&](int entry) {
      if (pages.markRequested(entry, frame)) requests_.push_back({&texture, entry, level, count->second++});
    });
  }
}

void PageDemand::request(const PatchTree& patches, LiveTexture& field, LiveTexture* original, int shade_level,
                         int step, std::uint64_t frame) {
  for (const PatchLeaf& leaf : patches.leaves()) {
    requestSpan(field, geometrySpan(leaf.level, leaf.patch, false), frame);
    if (readsSurroundings(leaf)) requestSpan(field, geometrySpan(leaf.level, leaf.patch, true), frame);
  }
  const int log2_page = field.pages()->grid().log2Side() + dataShift(shade_level);
  for (const PatchLeaf& part : patches.parts(log2_page)) {
    const LevelSpan shade = shadeSpan(part.level, part.patch, shade_level, step);
    requestSpan(field, shade, frame);
    if (original != nullptr) requestSpan(*original, shade, frame);
  }
}

bool PageDemand::drawable(const PatchLeaf& leaf, const PageSet& pages) noexcept {
  return pages.resident(geometrySpan(leaf.level, leaf.patch, false)) &&
         (!readsSurroundings(leaf) || pages.resident(geometrySpan(leaf.level, leaf.patch, true)));
}

PageDemand::Outcome PageDemand::upload(PagePool& pool, StagingRing& ring, std::uint64_t frame,
                                       const vk::raii::CommandBuffer& commands, const UploadBudget& budget,
                                       UploadStatistics& count) {
  std::stable_sort(requests_.begin(), requests_.end(), [](const Request& a, const Request& b) {
    return a.level != b.level ? a.level > b.level : a.number < b.number;
  });
  Outcome outcome;
  outcome.requested = static_cast<std::int64_t>(requests_.size());
  PageSlots& slots = pool.slots();
  std::int64_t room = std::int64_t{slots.count()} - slots.fixed();
  std::vector<const Request*> missing;
  for (const Request& w : requests_) {
    PageSet& pages = *w.texture->pages();
    if (!pages.resident(w.entry)) {
      missing.push_back(&w);
      --room;
      continue;
    }
    const std::uint32_t slot = pages.slots()[static_cast<std::size_t>(w.entry)];
    if (slots.usedIn(slot, frame)) continue;
    if (room-- > 0) slots.use(slot, frame);
  }
  std::int64_t spent = 0;
  bool full = false;
  for (const Request* w : missing) {
    PageSet& pages = *w->texture->pages();
    const engine::FieldReader reader = w->texture->version().reader();
    // A page is uploaded in the state of the version, so its tiles must be in that state, too.
    if (!w->texture->upToDate(w->entry)) {
      ++outcome.waiting;
      continue;
    }
    if (pages.share(w->entry, reader, frame)) continue;
    if (full) {
      ++outcome.over_budget;
      continue;
    }
    if (spent > 0 && (spent + pages.bytes(w->entry) > budget.bytes || budget.late())) {
      ++outcome.waiting;
      continue;
    }
    std::int64_t bytes = 0;
    const PageSet::Load load = pages.load(w->entry, reader, ring, frame, bytes);
    if (load == PageSet::Load::kNoSlot) full = true;
    outcome.loaded += load == PageSet::Load::kDone;
    outcome.waiting += load == PageSet::Load::kNoStaging;
    outcome.over_budget += load == PageSet::Load::kNoSlot;
    spent += bytes;
  }
  count.bytes += spent;
  count.pending_tiles += outcome.waiting;
  pool.flush(commands, ring.buffer());
  requests_.clear();
  request_counts_.clear();
  return outcome;
}

gpu::PageHead pageHead(const PageGrid& grid) {
  gpu::PageHead head{};
  for (int level = 0; level < kDataLevels; ++level)
    head.level[level] = {grid.first(level), grid.pages(level).x, grid.samples(level)};
  head.pool = {grid.log2Side(), grid.first(kDataLevels), grid.rimRow(), grid.entries()};
  return head;
}

std::vector<std::uint32_t> pageTable(const PageSet& field, const PageSet* original) {
  const auto entries = static_cast<std::size_t>(field.grid().entries());
  std::vector<std::uint32_t> table(entries * (original != nullptr ? 2 : 1));
  for (std::size_t i = 0; i < entries; ++i) {
    table[i] = field.pool().word(field.slots()[i]);
    if (original == nullptr) continue;
    const std::uint32_t other = field.pool().word(original->slots()[i]);
    table[entries + i] = other;
    table[i] |= other & 1U << gpu::kEntryAwayShift;
  }
  return table;
}

}  // namespace fettle::render
