#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/field/version.h"
#include "engine/filter/catalogue.h"

namespace fettle::engine::tests {

/// A field as the plainest thing it could be; row-major, NaN = hole, marks empty = none.
struct PlainField {
  int width = 0;
  int height = 0;
  std::vector<float> z;
  std::vector<std::uint8_t> marks;

  [[nodiscard]] float at(int c, int r) const { return z[static_cast<std::size_t>(r) * width + c]; }
  float& at(int c, int r) { return z[static_cast<std::size_t>(r) * width + c]; }
  [[nodiscard]] bool marked(int c, int r) const {
    return !marks.empty() && marks[static_cast<std::size_t>(r) * width + c] != 0;
  }
};

[[nodiscard]] Version toVersion(const PlainField& field);
[[nodiscard]] PlainField toPlain(const Version& version);

/// All of them, for tests of what they share.
inline const std::vector<FilterKind> kEveryKind = [] {
  std::vector<FilterKind> kinds;
  for (const Filter& filter : filters()) kinds.push_back(filter.kind);
  return kinds;
}();

/// Those of them that look at a window around each sample.
inline const std::vector<FilterKind> kWindowed = [] {
  std::vector<FilterKind> kinds;
  for (const Filter& filter : filters())
    if (filter.window.exists()) kinds.push_back(filter.kind);
  return kinds;
}();

/// `windows` for a filter that has one, else the only value that it takes.
[[nodiscard]] std::vector<int> windowsOf(FilterKind kind, std::vector<int> windows);

/// The same bits, all NaN being one.
[[nodiscard]] bool sameBits(float a, float b);
[[nodiscard]] bool sameBits(const PlainField& a, const PlainField& b);

/// A field made by a formula of column and row.
[[nodiscard]] PlainField formed(int width, int height, const std::function<float(int, int)>& z);

/// The hard cases by name: see reference.cpp. Deterministic.
[[nodiscard]] std::vector<std::string> hardFieldNames();
[[nodiscard]] PlainField hardField(const std::string& name);

/// An exact sum of floats: a fixed-point number of 384 bits, last bit 2^-149. The twin of running sums.
class ExactSum {
 public:
  void add(float value, std::int64_t times = 1);
  /// To 64 bits.
  [[nodiscard]] long double value() const;

 private:
  std::array<std::uint64_t, 6> words_{};  // two's complement, least significant first
};

/// Distance between neighbouring floats at `value`, from above; of a denormal 2^-149, of what is not finite
/// NaN, which nothing is within.
[[nodiscard]] long double ulp(float value);

/// What a single window comes to, by brute force over its samples, one pass, marks not looked at.
/// Checks `got` against it and returns an empty text, or says what is wrong:
///   box      within 1 ulp of the exact mean, exact sums;
///   gaussian within 1 ulp or the stated (window + 4) * 2^-51 of the window's largest magnitude, of a long
///            double sum over window x window products;
///   median   equal to the exact median, an even count rounded once;
///   bilateral  within 1 ulp and the stated (window + 64) * 2^-22 range sigmas of long double sums;
///   tv       within 1 ulp and the stated window * 2^-19 range sigmas of the same steps in double;
///   tgv      anything: tgv_test.cpp compares it with its twin.
/// Of a total variation `twin` is totalVariationTwin of the field.
[[nodiscard]] std::string checkWindow(const PlainField& field, int column, int row, const FilterSpec& spec,
                                      float got, const std::vector<double>& twin = {});

/// What the steps of kTotalVariation make of a whole field, in double and without blocks.
[[nodiscard]] std::vector<double> totalVariationTwin(const PlainField& field, const FilterSpec& spec);

/// checkWindow for every sample (or for `samples` of them, spread evenly, when positive), holes and kept
/// samples checked to be untouched. The first few complaints, or an empty text.
[[nodiscard]] std::string checkPass(const PlainField& before, const PlainField& after, const FilterSpec& spec,
                                    int samples = 0);

/// applyFilter, expecting success.
[[nodiscard]] Filtered filtered(const Version& input, const FilterSpec& spec);

/// A range sigma of 0.25 where the kind has one; a window where it has one.
[[nodiscard]] FilterSpec makeSpec(FilterKind kind, int window, double sigma = 0.0);

}  // namespace fettle::engine::tests
