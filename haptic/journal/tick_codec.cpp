#include "haptic/journal/tick_codec.h"

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace fettle::haptic {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;  // reference for time differences; correct for any rate
constexpr std::int64_t kLongest_ns = std::int64_t{1} << 58;  // nine years: sums stay far from overflow
constexpr std::uint64_t kLatest_ns = std::uint64_t{1} << 59;
constexpr std::uint8_t kNewX = 1, kNewY = 2, kNewZ = 4, kNewTool = 8, kNoInput = 16;

void putVarint(std::string& out, std::uint64_t value) {
  for (; value >= 128; value >>= 7) out += static_cast<char>(value | 128);
  out += static_cast<char>(value);
}

void putBits(std::string& out, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int shift = 0; shift < 64; shift += 8) out += static_cast<char>(bits >> shift);
}

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Reads what the functions above wrote; false at the end of the bytes.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] bool end() const { return at_ == bytes_.size(); }

  bool byte(std::uint8_t& out) {
    if (end()) return false;
    out = static_cast<std::uint8_t>(bytes_[at_++]);
    return true;
  }
  bool varint(std::uint64_t& out) {
    out = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      std::uint8_t b = 0;
      if (!byte(b)) return false;
      out |= std::uint64_t{b & 127U} << shift;
      if (b < 128) return true;
    }
    return false;
  }
  bool bits(double& out) {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 8) {
      std::uint8_t b = 0;
      if (!byte(b)) return false;
      value |= std::uint64_t{b} << shift;
    }
    out = std::bit_cast<double>(value);
    return true;
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

void TickPacker::endRun() {
  if (run_ == 0) return;
  block_ += static_cast<char>(kNoInput);
  putVarint(block_, std::exchange(run_, 0));
  block_ += static_cast<char>(run_tool_);
}

void TickPacker::add(const haptic::StrokeSample& tick) {
  ++count_;
  if (!std::isfinite(tick.tip_mm.x)) {
    if (tick.tool != run_tool_) endRun();
    run_tool_ = tick.tool;
    ++run_;
    return;
  }
  endRun();
  const std::int64_t ns = std::llround(tick.t * 1e9);
  const std::int64_t late = ns - last_ns_ - kPeriod_ns;
  const auto what = static_cast<std::uint8_t>((sameBits(tick.tip_mm.x, last_.tip_mm.x) ? 0 : kNewX) |
                                              (sameBits(tick.tip_mm.y, last_.tip_mm.y) ? 0 : kNewY) |
                                              (sameBits(tick.tip_mm.z, last_.tip_mm.z) ? 0 : kNewZ) |
                                              (tick.tool == last_.tool ? 0 : kNewTool));
  block_ += static_cast<char>(what);
  putVarint(block_, (static_cast<std::uint64_t>(late) << 1) ^ static_cast<std::uint64_t>(late >> 63));
  if ((what & kNewX) != 0) putBits(block_, tick.tip_mm.x);
  if ((what & kNewY) != 0) putBits(block_, tick.tip_mm.y);
  if ((what & kNewZ) != 0) putBits(block_, tick.tip_mm.z);
  if ((what & kNewTool) != 0) block_ += static_cast<char>(tick.tool);
  last_ = tick;
  last_ns_ = ns;
}

std::string TickPacker::take() {
  endRun();
  last_ = {};
  last_ns_ = 0;
  count_ = 0;
  return std::exchange(block_, {});
}

engine::Result<std::vector<haptic::StrokeSample>> unpackTicks(std::string_view block) {
  const auto damaged = [] { return engine::inputError("the recorded ticks are damaged", "journal"); };
  constexpr std::uint64_t kMostTicks = 1U << 28U;  // in one run: three days; limits the memory requested
  std::vector<haptic::StrokeSample> ticks;
  Bytes bytes(block);
  haptic::StrokeSample last;
  std::int64_t last_ns = 0;
  while (!bytes.end()) {
    std::uint8_t what = 0;
    std::uint64_t number = 0;
    if (!bytes.byte(what) || !bytes.varint(number)) return damaged();
    if (what == kNoInput) {
      std::uint8_t tool = 0;
      if (number == 0 || number > kMostTicks || !bytes.byte(tool) || tool >= haptic::kTools) return damaged();
      haptic::StrokeSample nothing = last;
      nothing.tip_mm.x = std::numeric_limits<double>::quiet_NaN();
      nothing.tool = static_cast<haptic::Tool>(tool);
      ticks.insert(ticks.end(), number, nothing);
      continue;
    }
    if (what > (kNewX | kNewY | kNewZ | kNewTool)) return damaged();
    if (number > kLatest_ns) return damaged();
    const auto late = static_cast<std::int64_t>((number >> 1) ^ (~(number & 1) + 1));
    last_ns += kPeriod_ns + late;
    if (last_ns < -kLongest_ns || last_ns > kLongest_ns) return damaged();
    last.t = 1e-9 * static_cast<double>(last_ns);
    if ((what & kNewX) != 0 && !bytes.bits(last.tip_mm.x)) return damaged();
    if ((what & kNewY) != 0 && !bytes.bits(last.tip_mm.y)) return damaged();
    if ((what & kNewZ) != 0 && !bytes.bits(last.tip_mm.z)) return damaged();
    if ((what & kNewTool) != 0) {
      std::uint8_t tool = 0;
      if (!bytes.byte(tool) || tool >= haptic::kTools) return damaged();
      last.tool = static_cast<haptic::Tool>(tool);
    }
    ticks.push_back(last);
  }
  return ticks;
}

}  // namespace fettle::haptic
