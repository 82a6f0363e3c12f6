#include "app/work/filter_suggester.h"

#include <utility>

#include <fmt/format.h>

#include "engine/field/difference.h"
#include "engine/inspect/noise_model.h"

namespace fettle::app {
namespace {

// Three digits: the same may be typed.
double typedShare(double noise) {
  return std::stod(fmt::format("{:.3g}", FilterSuggester::kShareOfNoise * noise));
}

// Whether trying filters would find the same. Edge lines have no part in it.
bool sameToFilters(const engine::Version& a, const engine::Version& b) {
  return a.formOver() == b.formOver() && engine::changedTiles(a, b).empty();
}

}  // namespace

void FilterSuggester::search(const LoopClient& client) {
  on_trial_ = client.newest();
  // One that was cancelled may be at work for two seconds more: nothing waits for it here.
  trying_.replace([field = on_trial_, error = tolerance,
                   budget = budget_s](engine::JobControl& job) -> engine::Result<Found> {
    Found found;
    found.asked.tolerance = error;
    if (budget > 0.0) found.asked.budget_s = budget;
    if (error == 0.0) {
      const auto noise = engine::measureNoise(field, job);
      if (!noise) return tl::unexpected(noise.error());
      // Where there is none, suggestFilter says so, whatever the tolerance.
      found.asked.tolerance = noise->sigma > 0.0 ? typedShare(noise->sigma) : 1.0;
    }
    auto suggestion = engine::suggestFilter(field, found.asked, job);
    if (!suggestion) return tl::unexpected(suggestion.error());
    found.suggestion = *std::move(suggestion);
    return found;
  });
}

void FilterSuggester::clear() {
  cancel();
  tolerance = 0.0;
  found_.reset();
  nothing_.clear();
  on_trial_ = tried_ = compared_ = {};
  outdated_ = false;
}

bool FilterSuggester::poll(const LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  const bool dropped = trying_.cancelling();
  if (auto done = trying_.take(); done) {
    changed = true;
    if (!dropped && (*done || done->error().kind == engine::ErrorKind::kInput)) {
      found_.reset();
      nothing_.clear();
      if (*done)
        found_ = std::move(**done);
      else
        nothing_ = done->error().what;
      tried_ = compared_ = std::exchange(on_trial_, {});
      outdated_ = false;
    } else if (!dropped && done->error().kind != engine::ErrorKind::kCancelled) {
      notices.push_back({done->error().what, done->error().remedy});
    }
  }
  if (!tried_.empty() && !(client.newest() == compared_)) {
    compared_ = client.newest();
    const bool outdated = !sameToFilters(tried_, compared_);
    changed |= std::exchange(outdated_, outdated) != outdated;
  }
  return changed;
}

}  // namespace fettle::app
