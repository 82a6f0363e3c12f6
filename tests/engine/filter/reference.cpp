#include "tests/engine/filter/reference.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "engine/field/builder.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {

namespace {

long double gaussianWeight(const FilterSpec& spec, int distance) {
  const int n = spec.window - 1;
  if (spec.sigma > 0.0) {
    const long double x = static_cast<long double>(distance) / spec.sigma;
    return std::exp(-x * x / 2);
  }
  // C(n, n / 2 + distance) / 2^n, through the logarithm of the factorial: about 1e-16 relative.
  const int k = n / 2 + distance;
  return std::exp(std::lgamma(static_cast<long double>(n + 1)) -
                  std::lgamma(static_cast<long double>(k + 1)) -
                  std::lgamma(static_cast<long double>(n - k + 1)) - n * std::log(2.0L));
}

}  // namespace

Version toVersion(const PlainField& field) {
  Grid grid;
  grid.width = field.width;
  grid.height = field.height;
  return makeField(grid, field.z, field.marks);
}

PlainField toPlain(const Version& version) {
  const FieldReader reader = version.reader();
  PlainField p{reader.width(), reader.height(), {}, {}};
  p.z.resize(static_cast<std::size_t>(reader.grid().samples()));
  p.marks.resize(p.z.size());
  reader.readHeights(0, 0, p.width, p.height, p.z.data(), p.width);
  reader.readMarks(0, 0, p.width, p.height, p.marks.data(), p.width);
  return p;
}

bool sameBits(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

bool sameBits(const PlainField& a, const PlainField& b) {
  return a.width == b.width && a.height == b.height &&
         std::equal(a.z.begin(), a.z.end(), b.z.begin(), b.z.end(),
                    [](float x, float y) { return sameBits(x, y); });
}

PlainField formed(int width, int height, const std::function<float(int, int)>& z) {
  PlainField p{width, height, {}, {}};
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) p.z.push_back(z(c, r));
  return p;
}

std::vector<std::string> hardFieldNames() {
  return {"noise",      "flat",           "concave corner",     "integers",    "steps",   "spikes",
          "denormals",  "all magnitudes", "duplicates",         "saddle",      "one row", "one column",
          "one sample", "two by two",     "scattered holes",    "hole blocks", "islands", "all holes",
          "half holes", "huge",           "zeros of both signs"};
}

PlainField hardField(const std::string& name) {
  std::mt19937 random(20041);
  const auto uniform = [&random] { return static_cast<float>(random() % 16777216U) / 16777216.0F; };
  const auto noise = [&](int, int) { return uniform() - 0.5F; };
  if (name == "noise") return formed(150, 131, noise);
  if (name == "flat") return formed(90, 70, [](int, int) { return 0.1F; });
  if (name == "concave corner")
    return formed(90, 70, [](int c, int r) {
      return 0.8F * static_cast<float>(std::max(std::abs(c - 40), std::abs(r - 33)));
    });
  if (name == "integers")
    return formed(140, 70, [&](int, int) { return static_cast<float>(random() % 65536U); });
  if (name == "steps")
    return formed(131, 90, [&](int c, int r) { return (c > 64 ? 20.0F : -3.1F) + (r > 63 ? 0.1F : 0.0F); });
  if (name == "spikes")
    return formed(133, 129, [&](int, int) {
      const float v = 1e-3F * uniform();
      return random() % 50 == 0 ? (random() % 2 == 0 ? 1e6F : -1e6F) : v;
    });
  if (name == "denormals")
    return formed(
        80, 70, [&](int, int) { return std::bit_cast<float>(static_cast<std::uint32_t>(random() % 5000)); });
  if (name == "all magnitudes")
    return formed(100, 75, [&](int, int) {
      const float v = std::ldexp(0.5F + uniform() / 2, static_cast<int>(random() % 276) - 148);
      return random() % 2 == 0 ? v : -v;
    });
  if (name == "duplicates")
    return formed(129, 66, [&](int, int) { return static_cast<float>(random() % 3); });
  if (name == "saddle")
    return formed(96, 97, [&](int c, int r) {
      return 1e-4F * static_cast<float>((c - 48) * (c - 48) - (r - 48) * (r - 48));
    });
  if (name == "one row") return formed(200, 1, noise);
  if (name == "one column") return formed(1, 200, noise);
  if (name == "one sample") return formed(1, 1, noise);
  if (name == "two by two") return formed(2, 2, noise);
  if (name == "scattered holes")
    return formed(140, 140, [&](int c, int r) { return random() % 5 == 0 ? kNan : noise(c, r); });
  if (name == "hole blocks")
    return formed(200, 90, [&](int c, int r) { return (c / 40 + r / 30) % 2 == 0 ? kNan : noise(c, r); });
  if (name == "islands")
    return formed(150, 70, [&](int c, int r) { return random() % 97 == 0 ? noise(c, r) : kNan; });
  if (name == "all holes") return formed(70, 70, [](int, int) { return kNan; });
  if (name == "half holes") return formed(150, 80, [&](int c, int r) { return c < 75 ? noise(c, r) : kNan; });
  if (name == "huge")
    return formed(70, 70, [&](int, int) {
      return (random() % 2 == 0 ? 1.0F : -1.0F) * std::numeric_limits<float>::max() * (1.0F - uniform() / 8);
    });
  if (name == "zeros of both signs")
    return formed(70, 65, [&](int, int) { return random() % 2 == 0 ? 0.0F : -0.0F; });
  std::abort();
}

void ExactSum::add(float value, std::int64_t times) {
  int exponent = 0;
  const float fraction = std::frexp(value, &exponent);
  // value = whole * 2^(exponent - 24); a denormal's whole has zeros at its end for the shift below 0.
  auto whole = static_cast<std::int64_t>(std::ldexp(fraction, 24));
  int shift = exponent - 24 + 149;
  for (; shift < 0; ++shift) whole /= 2;
  const std::int64_t product = whole * times;  // 24 + 21 bits
  const bool negative = product < 0;
  auto magnitude = static_cast<std::uint64_t>(negative ? -product : product);
  std::array<std::uint64_t, 6> term{};
  for (int bit = 0; magnitude != 0; ++bit, magnitude >>= 1)
    if ((magnitude & 1U) != 0)
      term[static_cast<std::size_t>((shift + bit) / 64)] |= std::uint64_t{1} << ((shift + bit) % 64);
  std::uint64_t carry = negative ? 1 : 0;
  for (std::size_t i = 0; i < words_.size(); ++i) {
    const std::uint64_t added = negative ? ~term[i] : term[i];
    const std::uint64_t sum = words_[i] + added;
    const std::uint64_t with_carry = sum + carry;
    carry = sum < added || with_carry < sum ? 1 : 0;
    words_[i] = with_carry;
  }
}

long double ExactSum::value() const {
  std::array<std::uint64_t, 6> words = words_;
  const bool negative = (words.back() >> 63) != 0;
  if (negative) {
    std::uint64_t carry = 1;
    for (std::uint64_t& w : words) {
      w = ~w + carry;
      carry = carry != 0 && w == 0 ? 1 : 0;
    }
  }
  long double sum = 0.0L;
  for (std::size_t i = words.size(); i-- > 0;)
    sum += std::ldexp(static_cast<long double>(words[i]), static_cast<int>(64 * i) - 149);
  return negative ? -sum : sum;
}

long double ulp(float value) {
  if (!std::isfinite(value)) return std::numeric_limits<long double>::quiet_NaN();
  if (std::fabs(value) < std::numeric_limits<float>::min()) return std::ldexp(1.0L, -149);
  return std::ldexp(1.0L, std::ilogb(value) - 23);
}

std::vector<double> totalVariationTwin(const PlainField& field, const FilterSpec& spec) {
  const int w = field.width, h = field.height;
  const auto at = [w](int c, int r) { return static_cast<std::size_t>(r) * w + c; };
  std::vector<double> along(field.z.size()), across(field.z.size()), div(field.z.size());
  const auto diverge = [&] {
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c)
        div[at(c, r)] = along[at(c, r)] - (c > 0 ? along[at(c - 1, r)] : 0.0) + across[at(c, r)] -
                        (r > 0 ? across[at(c, r - 1)] : 0.0);
  };
  for (int step = 0; step < spec.window / 2; ++step) {
    diverge();
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c) {
        // 0 where the neighbour is missing.
        const auto slope = [&](int c1, int r1) {
          if (c1 >= w || r1 >= h || std::isnan(field.at(c, r)) || std::isnan(field.at(c1, r1))) return 0.0;
          return (static_cast<double>(field.at(c1, r1)) - static_cast<double>(field.at(c, r))) /
                     spec.range_sigma +
                 div[at(c1, r1)] - div[at(c, r)];
        };
        const double a = along[at(c, r)] + 0.2F * slope(c + 1, r);
        const double b = across[at(c, r)] + 0.2F * slope(c, r + 1);
        const double length = std::max(1.0, std::hypot(a, b));
        along[at(c, r)] = a / length;
        across[at(c, r)] = b / length;
      }
  }
  diverge();
  for (std::size_t i = 0; i < div.size(); ++i) div[i] = field.z[i] + spec.range_sigma * div[i];
  return div;
}

namespace {

// Whether a sample is off the least-squares plane through the samples of its window that `apart` names, by more than the
// range and the farthest of them; by Cramer's rule.
bool farFromPlane(const PlainField& field, int column, int row, int radius, float range, auto&& apart) {
  struct Place {
    long double x, y, z;
  };
  std::vector<Place> places;
  for (int r = std::max(row - radius, 0); r <= std::min(row + radius, field.height - 1); ++r)
    for (int c = std::max(column - radius, 0); c <= std::min(column + radius, field.width - 1); ++c)
      if (apart(field.at(c, r)))
        places.push_back({static_cast<long double>(c - column), static_cast<long double>(r - row),
                          static_cast<long double>(field.at(c, r)) - field.at(column, row)});
  const auto sum = [&](auto&& of) {
    long double all = 0.0L;
    for (const Place& p : places) all += of(p);
    return all;
  };
  const long double n = static_cast<long double>(places.size());
  const long double x = sum([](const Place&p) { return p.x; }), y = sum([](const Place&p) { return p.y; });
  const long double xx = sum([](const Place&p) { return p.x * p.x; }),
                    xy = sum([](const Place&p) { return p.x * p.y; }),
                    yy = sum([](const Place&p) { return p.y * p.y; });
  const long double z = sum([](const Place&p) { return p.z; }),
                    xz = sum([](const Place&p) { return p.x * p.z; }),
                    yz = sum([](const Place&p) { return p.y * p.z; });
  const auto determinant = [](long double a, long double b, long double c, long double d, long double e,
                              long double f, long double g, long double h, long double i) {
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  };
  const long double all = determinant(n, x, y, x, xx, xy, y, xy, yy);
  if (!(all > 0.0L)) return false;  // on one line
  const long double here = determinant(z, x, y, xz, xx, xy, yz, xy, yy) / all,
                    along_x = determinant(n, z, y, x, xz, xy, y, yz, yy) / all,
                    along_y = determinant(n, x, z, x, xx, xz, y, xy, yz) / all;
  long double most = 0.0L;
  for (const Place& p : places)
    most = std::max(most, std::fabs(p.z - (here + along_x * p.x + along_y * p.y)));
  const long double side = places.front().z < 0.0L ? -1.0L : 1.0L;
  return side * here > range + most;
}

}  // namespace

std::string checkWindow(const PlainField& field, int column, int row, const FilterSpec& spec, float got,
                        const std::vector<double>& twin) {
  if (!filterOf(spec.kind).window.exists()) return "";
  const int radius = spec.window / 2;
  const int c0 = std::max(column - radius, 0);
  const int c1 = std::min(column + radius, field.width - 1);
  const int r0 = std::max(row - radius, 0);
  const int r1 = std::min(row + radius, field.height - 1);
  const auto complain = [&](long double want) {
    return fmt::format("({}, {}): got {} ({:a}), want {}\n", column, row, got, got,
                       static_cast<double>(want));
  };
  if (spec.kind == FilterKind::kBox) {
    // The error times the count, exactly: sum - count * got.
    ExactSum error, sum;
    std::int64_t count = 0;
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c)
        if (const float v = field.at(c, r); !std::isnan(v)) {
          error.add(v);
          sum.add(v);
          ++count;
        }
    error.add(got, -count);
    return std::fabs(error.value()) <= ulp(got) * static_cast<long double>(count)
               ? ""
               : complain(sum.value() / static_cast<long double>(count));
  }
  if (spec.kind == FilterKind::kGaussian) {
    std::vector<long double> weights;
    for (int k = 0; k <= radius; ++k) weights.push_back(gaussianWeight(spec, k));
    long double sum = 0.0L, weight = 0.0L, largest = 0.0L;
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c)
        if (const float v = field.at(c, r); !std::isnan(v)) {
          const long double w = weights[static_cast<std::size_t>(std::abs(r - row))] *
                                weights[static_cast<std::size_t>(std::abs(c - column))];
          sum += w * v;
          weight += w;
          largest = std::max(largest, std::fabs(static_cast<long double>(v)));
        }
    // The header's bound: each direction rounds (n + 1) / 2 + 2 times relative to the sum of |w z|, for the
    // heights and once more for the weights, 2^-53 each time: (2 n + 11) 2^-53 in all.
    const long double rounding = (spec.window + 4) * std::ldexp(largest, -51);
    return std::fabs(sum / weight - got) <= ulp(got) + rounding ? "" : complain(sum / weight);
  }
  if (spec.kind == FilterKind::kTotalVariation) {
    const long double want = twin[static_cast<std::size_t>(row) * field.width + column];
    const long double rounding = std::ldexp(static_cast<long double>(spec.window) * spec.range_sigma, -19);
    return std::fabs(want - got) <= ulp(got) + rounding ? "" : complain(want);
  }
  if (spec.kind == FilterKind::kBilateral) {
    const long double range = spec.range_sigma, sigma = spec.sigma > 0.0 ? spec.sigma : spec.window / 4.0;
    const long double centre = field.at(column, row);
    long double sum = 0.0L, weight = 0.0L;
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c)
        if (const float v = field.at(c, r); !std::isnan(v)) {
          const long double d = (v - centre) / range;
          const long double place = ((c - column) * (c - column) + (r - row) * (r - row)) / (sigma * sigma);
          const long double w = std::exp(-place / 2) * std::pow(std::max(1 - d * d / 32, 0.0L), 16);
          sum += w * d;
          weight += w;
        }
    const long double want = centre + range * sum / weight;
    const long double rounding = (spec.window + 64) * std::ldexp(range, -22);
    return std::fabs(want - got) <= ulp(got) + rounding ? "" : complain(want);
  }
  std::vector<float> samples;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      if (const float v = field.at(c, r); !std::isnan(v)) samples.push_back(v);
  if (spec.kind == FilterKind::kOutliers) {
    const float z = field.at(column, row);
    const auto range = static_cast<float>(spec.range_sigma);
    std::ranges::sort(samples);
    // Sorted, those far below are the first, those far above the last.
    const auto below = std::ranges::partition_point(samples, [&](float s) { return z - s > range; });
    const auto above = std::ranges::partition_point(samples, [&](float s) { return !(s - z > range); });
    const auto most = static_cast<std::size_t>(radius), all = samples.size();
    const auto under = static_cast<std::size_t>(below - samples.begin()),
               over = static_cast<std::size_t>(samples.end() - above);
    // Two opposite each other across it that it stands apart from; where there are no two, the plane of all such.
    const auto opposite = [&](auto&& apart) {
      bool two = false;
      for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
          const auto there = [&](int c, int r) {
            return c >= c0 && c <= c1 && r >= r0 && r <= r1 && !std::isnan(field.at(c, r));
          };
          if ((x == 0 && y == 0) || !there(column + x, row + y) || !there(column - x, row - y)) continue;
          two = true;
          if (apart(field.at(column + x, row + y)) && apart(field.at(column - x, row - y))) return true;
        }
      return !two && farFromPlane(field, column, row, radius, range, apart);
    };
    // By how much the nearest n of those apart, of which `near` is the nearest and `far` the last, differ.
    const auto clear = [&](float near, float far) {
      return std::abs(static_cast<double>(z) - near) > range + std::abs(static_cast<double>(far) - near);
    };
    const auto n = static_cast<std::size_t>(spec.window);
    if (all - under <= most && 2 * under > all &&
        clear(samples[under - 1], samples[under - std::min(n, under)]) &&
        opposite([&](float s) { return z - s > range; }))
      samples.erase(below, samples.end());
    else if (all - over <= most && 2 * over > all &&
             clear(samples[all - over], samples[all - over + std::min(n, over) - 1]) &&
             opposite([&](float s) { return s - z > range; }))
      samples.erase(samples.begin(), above);
    else
      return sameBits(got, z) ? "" : complain(z);
  } else if (spec.kind != FilterKind::kMedian) {
    return fmt::format("no reference for {}\n", name(spec.kind));
  }
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 != 0) return *middle == got ? "" : complain(*middle);
  // Rounded once: no float is nearer to the exact mean than the one we got.
  const float low = *std::max_element(samples.begin(), middle);
  const auto distance = [&](float f) {
    ExactSum d;
    d.add(low);
    d.add(*middle);
    d.add(f, -2);
    return std::fabs(d.value());
  };
  const long double here = distance(got);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  return here <= distance(std::nextafter(got, kInf)) && here <= distance(std::nextafter(got, -kInf))
             ? ""
             : complain((static_cast<long double>(low) + *middle) / 2);
}

std::string checkPass(const PlainField& before, const PlainField& after, const FilterSpec& spec,
                      int samples) {
  const auto all = static_cast<std::size_t>(before.width) * static_cast<std::size_t>(before.height);
  const std::size_t step =
      samples > 0 ? std::max<std::size_t>(all / static_cast<std::size_t>(samples), 1) | 1U : 1;
  const std::vector<double> twin =
      spec.kind == FilterKind::kTotalVariation ? totalVariationTwin(before, spec) : std::vector<double>{};
  std::string complaints;
  int found = 0;
  for (std::size_t i = 0; i < all && found < 5; ++i) {
    const int c = static_cast<int>(i) % before.width;
    const int r = static_cast<int>(i) / before.width;
    const bool kept = spec.scope == FilterScope::kKeepMarks ? before.marked(c, r) : !before.marked(c, r);
    std::string complaint;
    if (kept || std::isnan(before.z[i])) {
      if (!sameBits(before.z[i], after.z[i])) complaint = fmt::format("({}, {}): touched\n", c, r);
    } else if (std::isnan(after.z[i])) {
      complaint = fmt::format("({}, {}): a hole where none was\n", c, r);
    } else if (i % step == 0) {
      complaint = checkWindow(before, c, r, spec, after.z[i], twin);
    }
    if (complaint.empty()) continue;
    complaints += complaint;
    ++found;
  }
  return complaints;
}

std::vector<int> windowsOf(FilterKind kind, std::vector<int> windows) {
  return filterOf(kind).window.exists() ? std::move(windows) : std::vector<int>{FilterSpec{}.window};
}

Filtered filtered(const Version& input, const FilterSpec& asked) {
  JobControl job;
  FilterSpec spec = asked;
  // Six samples of makeSpec are six of whatever spacing.
  if (!validate(spec, input.grid()) && validate(spec)) spec.nesting_mm *= input.grid().spacingXMm();
  Result<Filtered> result = applyFilter(input, input, spec, job);
  if (!result) {
    fmt::print(stderr, "{}\n", result.error().line());
    std::abort();
  }
  return std::move(*result);
}

FilterSpec makeSpec(FilterKind kind, int window, double sigma) {
  FilterSpec spec;
  spec.kind = kind;
  if (filterOf(kind).window.exists()) spec.window = window;
  spec.sigma = sigma;
  if (hasRange(kind)) spec.range_sigma = 0.25;
  if (separatesScales(filterOf(kind))) spec.nesting_mm = 6.0;
  return spec;
}

}  // namespace fettle::engine::tests
