#include "engine/measure/line_suggestion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "engine/measure/lines_apart.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kFewestInCommon = 8;  // for a median to say something

struct Way {
  LineMethod method;
  int degree;
};
// The simplest first: what takes one number from each line, then more of them.
constexpr Way kWays[] = {{LineMethod::kMedian, 0},     {LineMethod::kPolynomial, 0},
                         {LineMethod::kMatching, 0},   {LineMethod::kDifference, 0},
                         {LineMethod::kPolynomial, 1}, {LineMethod::kPolynomial, 2},
                         {LineMethod::kPolynomial, 3}};

double middleOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Heights of each line at some of its places, read once; NaN where none counts.
class SparseLines {
 public:
  SparseLines(const Version& field, const LineOptions& options, std::span<const std::int32_t> places)
      : places_(places), each_(places.size()) {
    const FieldReader reader = field.reader();
    const bool rows = options.axis == ScanAxis::kX;
    lines_ = rows ? reader.height() : reader.width();
    heights_.reserve(static_cast<std::size_t>(lines_) * each_);
    for (std::int32_t line = 0; line < lines_; ++line)
      for (const std::int32_t place : places) {
        const std::int32_t c = rows ? place : line, r = rows ? line : place;
        const bool counts =
            options.region == Region::kAll || reader.markedAt(c, r) == (options.region == Region::kMarked);
        heights_.push_back(counts ? reader.heightAt(c, r) : std::numeric_limits<float>::quiet_NaN());
      }
  }

  // Null: of the lines as they are. NaN where no two lines can be compared, nothing where it was cancelled.
  [[nodiscard]] std::optional<double> apart(const LineOffsets* offsets, const JobControl& job) const {
    double sum = 0.0;
    int lags = 0;
    std::vector<double> differences;
    for (const std::int32_t lag : kLineLags) {
      double all = 0.0;
      std::int64_t pairs = 0;
      for (std::int32_t line = 0; line + lag < lines_; ++line) {
        if (line % 256 == 0 && job.cancelled()) return std::nullopt;
        differences.clear();
        for (std::size_t k = 0; k < each_; ++k) {
          double d = static_cast<double>(at(line + lag, k)) - static_cast<double>(at(line, k));
          if (std::isnan(d)) continue;
          if (offsets != nullptr)
            d -= offsets->takenAt(line + lag, places_[k]) - offsets->takenAt(line, places_[k]);
          differences.push_back(d);
        }
        if (differences.size() < kFewestInCommon) continue;
        all += std::abs(middleOf(differences));
        ++pairs;
      }
      if (pairs == 0) continue;
      sum += all / static_cast<double>(pairs);
      ++lags;
    }
    return lags > 0 ? sum / lags : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  [[nodiscard]] float at(std::int32_t line, std::size_t k) const noexcept {
    return heights_[static_cast<std::size_t>(line) * each_ + k];
  }

  std::span<const std::int32_t> places_;
  std::size_t each_;
  std::int32_t lines_ = 0;
  std::vector<float> heights_;
};

}  // namespace

Result<LineSuggestion> suggestLevelling(const Version& field, const LineOptions& options, JobControl& job) {
  const FieldReader reader = field.reader();
  LineSuggestion found;
  found.length = options.axis == ScanAxis::kX ? reader.width() : reader.height();
  const std::int32_t all = std::min(found.length, 2 * LineSuggestion::kMostPlaces);
  std::vector<std::int32_t> finding, judging;
  for (std::int32_t k = 0; k < all; ++k)
    (k % 2 == 0 ? finding : judging)
        .push_back(static_cast<std::int32_t>(static_cast<std::int64_t>(k) * found.length / all));
  found.places = all;
  job.begin("trying ways to level", std::size(kWays) + 1);
  const SparseLines lines(field, options, judging);
  const auto before = lines.apart(nullptr, job);
  if (!before) return cancelled();
  if (std::isnan(*before))
    return inputError("no two lines have enough samples in common to be compared", "levelling",
                      "take all samples, or the other direction");
  found.before = *before;
  job.advance();
  double least = std::numeric_limits<double>::infinity();
  for (const Way& way : kWays) {
    LineOptions how = options;
    how.method = way.method;
    how.degree = way.degree;
    JobControl part = JobControl::partOf(job);
    const auto offsets = findLineOffsets(field, how, finding, part);
    if (!offsets) return tl::unexpected(offsets.error());
    const auto apart = lines.apart(&*offsets, job);
    if (!apart) return cancelled();
    found.tried.push_back({way.method, way.degree, *apart});
    least = std::min(least, *apart);
    job.advance();
  }
  for (std::size_t i = 0; i < found.tried.size() && !found.best; ++i)
    if (found.tried[i].apart <= LineSuggestion::kAsGood * least) found.best = i;
  if (!(LineSuggestion::kAsGood * least < found.before)) found.best.reset();
  return found;
}

}  // namespace fettle::engine
