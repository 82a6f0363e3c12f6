#include "engine/session/line_codec.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <unordered_set>
#include <utility>
#include <vector>

#include "engine/io/files/little_endian.h"

namespace fettle::engine {

namespace {

constexpr double kFarthest = 0x1p20;  // [samples]
constexpr std::uint8_t kLocatedBit = 1, kCreaseBit = 2;

// Takes values from the front; after one that is not there all are 0 and `good` is false.
struct LineBytes {
  std::string_view rest;
  bool good = true;

  template <class Integer>
  Integer integer() {
    if (rest.size() < sizeof(Integer)) {
      good = false;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
      value |= std::uint64_t{static_cast<std::uint8_t>(rest[i])} << (8 * i);
    rest.remove_prefix(sizeof(Integer));
    return static_cast<Integer>(value);
  }
  double real() {
    const auto value = std::bit_cast<double>(integer<std::uint64_t>());
    good = good && std::isfinite(value);
    return value;
  }
  double deviation() {
    const double value = real();
    good = good && value >= 0.0;
    return value;
  }
};

EdgePoint pointFrom(LineBytes& in) {
  EdgePoint point;
  point.position.x = in.real();
  point.position.y = in.real();
  in.good = in.good && std::abs(point.position.x) <= kFarthest && std::abs(point.position.y) <= kFarthest;
  const auto bits = in.integer<std::uint8_t>();
  in.good = in.good && bits <= (kLocatedBit | kCreaseBit);
  point.located = (bits & kLocatedBit) != 0;
  point.kind = (bits & kCreaseBit) != 0 ? LineKind::kCrease : LineKind::kStep;
  if (!point.located) return point;
  point.deviation = in.deviation();
  point.step = in.real();
  point.step_deviation = in.deviation();
  point.slope_change = in.real();
  point.slope_deviation = in.deviation();
  return point;
}

}  // namespace

std::string packLines(const EdgeLines& lines) {
  std::string out;
  appendLittle(out, static_cast<std::uint32_t>(lines ? lines->size() : 0));
  if (!lines) return out;
  for (const EdgeLine& line : *lines) {
    appendLittle(out, line.id);
    appendLittle(out, static_cast<std::uint8_t>(line.closed ? 1 : 0));
    appendLittle(out, static_cast<std::uint32_t>(line.points.size()));
    for (const EdgePoint& point : line.points) {
      appendLittle(out, point.position.x);
      appendLittle(out, point.position.y);
      appendLittle(out, static_cast<std::uint8_t>((point.located ? kLocatedBit : 0) |
                                                  (point.kind == LineKind::kCrease ? kCreaseBit : 0)));
      if (!point.located) continue;
      for (const double value :
           {point.deviation, point.step, point.step_deviation, point.slope_change, point.slope_deviation})
        appendLittle(out, value);
    }
  }
  return out;
}

std::optional<EdgeLines> unpackLines(std::string_view bytes) {
  LineBytes in{bytes};
  std::vector<EdgeLine> lines;
  std::unordered_set<std::int64_t> ids;
  for (auto left = in.integer<std::uint32_t>(); left > 0 && in.good; --left) {
    EdgeLine line;
    line.id = in.integer<std::int64_t>();
    const auto closed = in.integer<std::uint8_t>();
    line.closed = closed == 1;
    in.good = in.good && closed <= 1 && ids.insert(line.id).second;
    for (auto points = in.integer<std::uint32_t>(); points > 0 && in.good; --points)
      line.points.push_back(pointFrom(in));
    lines.push_back(std::move(line));
  }
  if (!in.good || !in.rest.empty()) return std::nullopt;
  return lines.empty() ? EdgeLines() : std::make_shared<const std::vector<EdgeLine>>(std::move(lines));
}

}  // namespace fettle::engine
