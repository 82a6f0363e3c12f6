#include <algorithm>
#include <array>

#include "haptic/devices/hid/hid_port.h"

namespace fettle::haptic {

namespace {

// Short items, HID 1.11 section 6.2.2.2: one byte of tag, type and size, then 0, 1, 2 or 4 bytes of data.
enum Item : std::uint8_t {
  kInput = 0x80,
  kOutput = 0x90,
  kReportSize = 0x74,
  kReportId = 0x84,
  kReportCount = 0x94,
  kPush = 0xA4,
  kPop = 0xB4,
};

struct Globals {
  std::uint32_t size = 0;   // bits of one field
  std::uint32_t count = 0;  // fields
  std::uint8_t id = 0;
};

constexpr std::uint64_t kMostBits = 8 * 65536;  // longer than any real report; keeps sums from overflowing

}  // namespace

ReportSizes reportSizes(std::span<const std::uint8_t> d) noexcept {
  std::array<std::uint64_t, 256> input_bits{};
  std::array<std::uint64_t, 256> output_bits{};
  Globals g;
  std::array<Globals, 8> stack;
  std::size_t depth = 0;
  ReportSizes sizes;
  for (std::size_t at = 0; at < d.size();) {
    const std::uint8_t prefix = d[at];
    if (prefix == 0xFE) {  // long item: length in the next byte
      if (at + 1 >= d.size()) break;
      at += std::size_t{3} + d[at + 1];
      continue;
    }
    const std::size_t length = (prefix & 3U) == 3 ? 4 : prefix & 3U;
    if (at + 1 + length > d.size()) break;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < length; ++i)
      value |= static_cast<std::uint32_t>(d[at + 1 + i]) << static_cast<unsigned>(8 * i);
    at += 1 + length;
    const std::uint64_t bits = std::min(std::uint64_t{g.size} * g.count, kMostBits);
    switch (prefix & 0xFCU) {
      case kInput:
        input_bits[g.id] = std::min(input_bits[g.id] + bits, kMostBits);
        break;
      case kOutput:
        output_bits[g.id] = std::min(output_bits[g.id] + bits, kMostBits);
        break;
      case kReportSize:
        g.size = value;
        break;
      case kReportCount:
        g.count = value;
        break;
      case kReportId:
        g.id = static_cast<std::uint8_t>(value);
        sizes.numbered = true;
        break;
      case kPush:
        if (depth < stack.size()) stack[depth++] = g;
        break;
      case kPop:
        if (depth > 0) g = stack[--depth];
        break;
      default:
        break;  // usages, ranges, collections: no matter for the size
    }
  }
  const auto longest = [&](const std::array<std::uint64_t, 256>& bits) -> std::size_t {
    const std::uint64_t most = *std::max_element(bits.begin(), bits.end());
    return most == 0 ? 0 : static_cast<std::size_t>((most + 7) / 8) + (sizes.numbered ? 1 : 0);
  };
  sizes.input_bytes = longest(input_bits);
  sizes.output_bytes = longest(output_bits);
  return sizes;
}

}  // namespace fettle::haptic
