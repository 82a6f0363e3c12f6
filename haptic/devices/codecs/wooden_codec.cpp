#include "haptic/devices/codecs/wooden_codec.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace fettle::haptic {

namespace {

constexpr std::size_t kW8Bytes = 8;
constexpr std::size_t kP14Bytes = 14;

// The stylus button adds 10000 to encoder d, whose own range stays below 5000.
constexpr int kButtonThreshold = 5000;
constexpr int kButtonOffset = 10000;

std::int16_t int16At(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8U)));
}

void putInt16(std::span<std::uint8_t> bytes, std::size_t at, std::int16_t value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  bytes[at] = static_cast<std::uint8_t>(bits & 0xFFU);
  bytes[at + 1] = static_cast<std::uint8_t>(bits >> 8U);
}

std::int16_t milliampere(double ma) noexcept {
  constexpr double kLimit = 6000.0;  // the serial boards reject values above it
  return std::isfinite(ma) ? static_cast<std::int16_t>(std::lround(std::clamp(ma, -kLimit, kLimit))) : 0;
}

void unfoldButton(WoodenReport& report) noexcept {
  report.stylus_button = report.encoders[3] > kButtonThreshold;
  if (report.stylus_button)
    report.encoders[3] = static_cast<std::int16_t>(report.encoders[3] - kButtonOffset);
}

std::optional<WoodenReport> decodeLine(std::span<const std::uint8_t> bytes) noexcept {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return std::nullopt;
  text = text.substr(1, text.size() - 2);
  std::array<int, 8> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), numbers[i]);
    if (error != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (i + 1 == numbers.size()) break;
    if (text.empty() || text.front() != ',') return std::nullopt;
    text.remove_prefix(1);
  }
  if (!text.empty()) return std::nullopt;
  constexpr int kModels = 3;  // 1 Polhem, 2 vintage PHANTOM, 3 Woody
  if (numbers[0] < 1 || numbers[0] > kModels) return std::nullopt;
  WoodenReport report;
  for (std::size_t i = 0; i < 6; ++i)
    report.encoders[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(numbers[i + 1] & 0xFFFF));
  report.fault = numbers[7];
  unfoldButton(report);
  return report;
}

}  // namespace

std::optional<WoodenForm> woodenFormOfSize(std::size_t bytes) noexcept {
  if (bytes == kW8Bytes) return WoodenForm::kW8;
  if (bytes == kP14Bytes) return WoodenForm::kP14;
  return std::nullopt;
}

std::optional<WoodenReport> decodeWooden(WoodenForm form, std::span<const std::uint8_t> bytes) noexcept {
  if (form == WoodenForm::kS) return decodeLine(bytes);
  if (woodenFormOfSize(bytes.size()) != form) return std::nullopt;
  WoodenReport report;
  const std::size_t encoders = form == WoodenForm::kW8 ? 3 : 6;
  for (std::size_t i = 0; i < encoders; ++i) report.encoders[i] = int16At(bytes, 2 * i);
  if (form == WoodenForm::kW8) {
    report.counter = static_cast<std::uint16_t>(int16At(bytes, 6));
  } else {
    report.calibration_latched = int16At(bytes, 12) == 1;
    unfoldButton(report);
  }
  return report;
}

std::size_t encodeWooden(WoodenForm form, const WoodenCommand& command,
                         std::span<std::uint8_t, kWoodenLongest> out) noexcept {
  const std::array<std::int16_t, 3> ma{milliampere(command.ma.x), milliampere(command.ma.y),
                                       milliampere(command.ma.z)};
  if (form == WoodenForm::kS) {
    char* at = reinterpret_cast<char*>(out.data());
    char* const end = at + out.size();
    *at++ = '[';
    for (std::size_t i = 0; i < 3; ++i) {
      at = std::to_chars(at, end, ma[i]).ptr;
      *at++ = i < 2 ? ',' : ']';
    }
    *at++ = '\n';
    return static_cast<std::size_t>(at - reinterpret_cast<char*>(out.data()));
  }
  const std::size_t size = form == WoodenForm::kW8 ? kW8Bytes : kP14Bytes;
  std::fill_n(out.begin(), size, std::uint8_t{0});
  if (form == WoodenForm::kP14 && command.preset) {
    putInt16(out, 6, 1);
    for (std::size_t i = 0; i < 3; ++i) putInt16(out, 8 + 2 * i, (*command.preset)[i]);
    return size;
  }
  for (std::size_t i = 0; i < 3; ++i) putInt16(out, 2 * i, ma[i]);
  return size;
}

}  // namespace fettle::haptic
