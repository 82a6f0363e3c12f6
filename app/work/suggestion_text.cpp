#include "app/work/suggestion_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/texts/texts.h"
#include "app/work/filter_preview.h"
#include "engine/filter/catalogue.h"

namespace fettle::app {

namespace {

using engine::FilterCandidate;
using engine::FilterSuggestion;
using engine::SuggestionRequest;

bool isUnchanged(const FilterCandidate& c) {
  return c.spec.window == 1;
}

bool isAffordable(const FilterCandidate& c, const SuggestionRequest& asked) {
  return !asked.budget_s || c.seconds <= *asked.budget_s;
}

std::string errorText(double error, const render::ShownUnit& unit) {
  return fmt::format("{:.3g} {}", error * unit.per_unit, unit.name);
}

// Whatever time it takes; null: none is.
const FilterCandidate* cheapestWithin(const FilterSuggestion& found, double tolerance) {
  const FilterCandidate* cheapest = nullptr;
  for (const FilterCandidate& c : found.candidates)
    if (c.error() <= tolerance && (cheapest == nullptr || c.betterThan(*cheapest))) cheapest = &c;
  return cheapest;
}

// Filters leave much of what whole lines are off; to level them takes it out.
std::string linesText(const FilterSuggestion& found, const render::ShownUnit& unit) {
  constexpr double kMuch = 0.3;  // of the noise: a tenth of its square
  const bool rows = found.rows >= found.columns;
  const double off = rows ? found.rows : found.columns;
  if (!(off > kMuch * found.sigma)) return {};
  return rows ? trFormat("Rows are off by {}: level lines first. ", errorText(off, unit))
              : trFormat("Columns are off by {}: level lines first. ", errorText(off, unit));
}

// What a filter is listed for; less of `of` is better.
struct Merit {
  const char* why;
  double (*of)(const FilterCandidate&);
};
constexpr Merit kMerits[] = {
    {textOf("the least error"), [](const FilterCandidate& c) { return c.error(); }},
    {textOf("the least error on flats"), [](const FilterCandidate& c) { return c.error_flat; }},
    {textOf("the least error near edges"), [](const FilterCandidate& c) { return c.error_edge; }},
    {textOf("the least computing of those that help"), [](const FilterCandidate& c) { return c.cost; }},
};

}  // namespace

std::string candidateName(const FilterCandidate& candidate) {
  return isUnchanged(candidate) ? engine::methodOf(candidate)
                                : filterName(candidate.spec) + engine::detailsOf(candidate);
}

std::string filterTimeText(double seconds) {
  return seconds < 99.5 ? fmt::format("{:.2g} s", seconds) : durationText(seconds);
}

std::string leftText(const FilterCandidate& c, const render::ShownUnit& unit) {
  const auto part = [&](double error, const char* where) {
    return std::isnan(error) ? std::string() : fmt::format("{} {}", errorText(error, unit), where);
  };
  const std::string flat = part(c.error_flat, tr("on flats")), edge = part(c.error_edge, tr("near edges"));
  return flat.empty() || edge.empty() ? flat + edge : trFormat("{} and {}", flat, edge);
}

std::string reasonText(const FilterSuggestion& found, const SuggestionRequest& asked,
                       const SuggestionWords& words) {
  const FilterCandidate& pick = found.picked();
  const auto& [unit, method] = words;
  const FilterCandidate *marked = nullptr, *flattest = nullptr;
  for (const FilterCandidate& c : found.candidates) {
    if (!isAffordable(c, asked)) continue;
    if (c.around_edges && (marked == nullptr || c.error() < marked->error())) marked = &c;
    if (flattest == nullptr || c.error_flat < flattest->error_flat) flattest = &c;
  }
  const std::string tolerance = errorText(asked.tolerance, unit);
  std::string why = trFormat("The noise of the whole scan, offsets of rows and columns included, is {}. ",
                             errorText(found.sigma, unit)) +
                    linesText(found, unit);
  if (isUnchanged(pick) && found.met())
    return why + trFormat("The unchanged scan stays within {}: no filter is needed.", tolerance);
  if (found.met()) {
    why += trFormat(
        "{} leaves {}, in about {}; of all tested filters that stay within {}, none needs less computing.",
        method(pick), leftText(pick, unit), filterTimeText(pick.seconds), tolerance);
  } else {
    const double over = pick.error() / asked.tolerance;
    why += isUnchanged(pick)
               ? trFormat("Nothing helps: none leaves less than the unchanged scan, {}: {:.2g} times {}.",
                          leftText(pick, unit), over, tolerance)
               : trFormat("{} helps most{}: it leaves {} of {}, in about {}. That is {:.2g} times {}.",
                          method(pick), asked.budget_s ? trFormat(" in {:g} s", *asked.budget_s) : "",
                          leftText(pick, unit), leftText(found.candidates.front(), unit),
                          filterTimeText(pick.seconds), over, tolerance);
    const FilterCandidate* slow = cheapestWithin(found, asked.tolerance);
    if (slow != nullptr)
      why +=
          trFormat(" {} does, in about {}: allow that time.", method(*slow), filterTimeText(slow->seconds));
    else if (flattest != nullptr && flattest->error_flat <= asked.tolerance)
      why += trFormat(
          " Only flats: {} leaves {}; edges that need a smaller error must be smoothed with the stylus or "
          "scanned again.",
          method(*flattest), leftText(*flattest, unit));
    else
      // Independent noise of n scans has a root of n less in their mean.
      why += trFormat(" For {} take the mean of about {:.0f} scans, or one with less noise.", tolerance,
                      std::ceil(over * over));
  }
  if (marked != nullptr && !pick.around_edges)
    why += trFormat(" Marking edges first leaves {} ({}): marked samples keep their noise.",
                    leftText(*marked, unit), method(*marked));
  if (found.outlier_share > 1e-4)
    why += trFormat(
        " {:.2g} % of the samples are single outliers: the filter {} removes these and nothing else.",
        100.0 * found.outlier_share, engine::name(engine::FilterKind::kOutliers));
  return why;
}

std::vector<ListedFilter> listedFilters(const FilterSuggestion& found, const SuggestionRequest& asked,
                                        const render::ShownUnit& unit) {
  const std::vector<FilterCandidate>& all = found.candidates;
  std::vector<ListedFilter> listed;
  if (!isUnchanged(found.picked())) {
    const std::string tolerance = errorText(asked.tolerance, unit);
    listed.push_back({found.pick, found.met() ? trFormat("the least computing of all within {}", tolerance)
                                              : trFormat("nearest to {}", tolerance)});
  }
  const double unchanged = all.front().error();
  for (const Merit& merit : kMerits) {
    const FilterCandidate* best = nullptr;
    for (const FilterCandidate& c : all) {
      if (isUnchanged(c) || !isAffordable(c, asked) || !(c.error() < unchanged)) continue;
      // Of equals the first; NaN is no error.
      if (const double of = merit.of(c); !std::isnan(of) && (best == nullptr || of < merit.of(*best)))
        best = &c;
    }
    if (best == nullptr) continue;
    const auto candidate = static_cast<std::size_t>(best - all.data());
    const auto known = std::ranges::find(listed, candidate, &ListedFilter::candidate);
    if (known != listed.end())
      known->why += std::string(", ") + tr(merit.why);
    else
      listed.push_back({candidate, tr(merit.why)});
  }
  const auto others = listed.begin() + (isUnchanged(found.picked()) ? 0 : 1);
  std::stable_sort(others, listed.end(), [&](const ListedFilter& a, const ListedFilter& b) {
    return all[a.candidate].error() < all[b.candidate].error();
  });
  return listed;
}

}  // namespace fettle::app
