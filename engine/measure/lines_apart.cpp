#include "engine/measure/lines_apart.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fettle::engine {

namespace {

constexpr std::int32_t kMostOfLine = 512;  // of a line
constexpr std::size_t kFewestShared = 8;   // that two lines share, for a median to say something

double middleOfPairs(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Result<LinesApart> linesApart(const Version& field, const LineOffsets& offsets, JobControl& job) {
  const FieldReader reader = field.reader();
  const auto heightAt = [&](std::int32_t line, std::int32_t place) {
    return static_cast<double>(offsets.axis == ScanAxis::kX ? reader.heightAt(place, line)
                                                            : reader.heightAt(line, place));
  };
  const std::int32_t step = std::max(1, offsets.length / kMostOfLine);
  const HeightBounds bounds = reader.bounds();
  const double least =
      1e-6 * std::max(std::abs(static_cast<double>(bounds.min)), std::abs(static_cast<double>(bounds.max)));
  LinesApart worst;
  std::vector<double> before, after;
  for (const std::int32_t lag : kLineLags) {
    LinesApart apart{.lag = lag, .least = least};
    std::int64_t pairs = 0;
    for (std::int32_t line = 0; line + lag < offsets.lines; ++line) {
      if (line % 256 == 0 && job.cancelled()) return cancelled();
      before.clear();
      after.clear();
      for (std::int32_t place = 0; place < offsets.length; place += step) {
        const double d = heightAt(line + lag, place) - heightAt(line, place);
        if (!std::isfinite(d)) continue;
        before.push_back(d);
        after.push_back(d - (offsets.takenAt(line + lag, place) - offsets.takenAt(line, place)));
      }
      if (before.size() < kFewestShared) continue;
      apart.before += std::abs(middleOfPairs(before));
      apart.after += std::abs(middleOfPairs(after));
      ++pairs;
    }
    if (pairs > 0) {
      apart.before /= static_cast<double>(pairs);
      apart.after /= static_cast<double>(pairs);
    }
    // Of neighbours in any case; of others where levelling made these worse, the more times the more.
    const bool worse_than_found =
        apart.worse() && (!worst.worse() || apart.after * worst.before > worst.after * apart.before);
    if (lag == kLineLags.front() || worse_than_found) worst = apart;
  }
  return worst;
}

}  // namespace fettle::engine
