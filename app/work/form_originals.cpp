#include "app/work/form_originals.h"

#include <algorithm>
#include <cassert>

#include "engine/field/seen_field.h"

namespace fettle::app {

const engine::Version* FormOriginals::of(const engine::Version& state) const noexcept {
  const engine::FieldForm& form = state.formOver();
  if (form == nullptr) return &scan_;
  const auto found = std::ranges::find_if(seen_, [&](const auto& seen) { return seen.formOver() == form; });
  return found == seen_.end() ? nullptr : &*found;
}

const engine::Version& FormOriginals::at(const engine::Version& state) const noexcept {
  const engine::Version* known = of(state);
  assert(known != nullptr);
  return *known;
}

engine::Result<engine::Version> FormOriginals::make(const engine::Version& scan, const engine::Version& state,
                                                    engine::JobControl& job) {
  if (state.formOver() == nullptr) return scan;
  return engine::seenNear(scan.withForm(state.formOver()), state, job);
}

void FormOriginals::add(const engine::Version& seen) {
  if (of(seen) == nullptr) seen_.push_back(seen);
}

engine::Status FormOriginals::makeAll(const engine::History& history, engine::JobControl& job) {
  for (std::int64_t k = history.first(); k <= history.last(); ++k) {
    if (of(history.state(k)) != nullptr) continue;
    const auto seen = make(scan_, history.state(k), job);
    if (!seen) return tl::unexpected(seen.error());
    add(*seen);
  }
  return {};
}

void FormOriginals::keepFor(const engine::History& history, const engine::Version& shown) {
  std::erase_if(seen_, [&](const engine::Version& seen) {
    if (seen.formOver() == shown.formOver()) return false;
    for (std::int64_t k = history.first(); k <= history.last(); ++k)
      if (history.state(k).formOver() == seen.formOver()) return false;
    return true;
  });
}

}  // namespace fettle::app
