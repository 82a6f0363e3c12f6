#include "haptic/devices/codecs/wooden_codec.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "haptic/devices/wooden/wooden_calibration.h"

namespace fettle::haptic {
namespace {

std::span<const std::uint8_t> bytesOf(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::vector<std::uint8_t> encoded(WoodenForm form, const WoodenCommand& command) {
  std::array<std::uint8_t, kWoodenLongest> out;
  out.fill(0xEE);
  const std::size_t size = encodeWooden(form, command, out);
  return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size)};
}

TEST(WoodenCodec, W8InputIsThreeEncodersAndACounterLowByteFirst) {
  const std::array<std::uint8_t, 8> wire{0x70, 0x17, 0xFF, 0xFF, 0x00, 0x80, 0x34, 0xF2};
  const auto r = decodeWooden(WoodenForm::kW8, wire);
  ASSERT_TRUE(r);
  EXPECT_EQ(r->encoders, (std::array<std::int16_t, 6>{6000, -1, -32768, 0, 0, 0}));
  EXPECT_EQ(r->counter, 0xF234);
  EXPECT_FALSE(r->stylus_button);
}

TEST(WoodenCodec, P14InputCarriesSixEncodersButtonAndCalibrationLatch) {
  const std::array<std::uint8_t, 14> wire{1, 0, 2, 0, 3, 0, 0x88, 0x27, 5, 0, 0xFA, 0xFF, 1, 0};
  const auto r = decodeWooden(WoodenForm::kP14, wire);
  ASSERT_TRUE(r);
  // Encoder d reads 10120: the button's 10000 on top of 120.
  EXPECT_EQ(r->encoders, (std::array<std::int16_t, 6>{1, 2, 3, 120, 5, -6}));
  EXPECT_TRUE(r->stylus_button);
  EXPECT_TRUE(r->calibration_latched);
}

TEST(WoodenCodec, ButtonThresholdIsAboveFiveThousand) {
  std::array<std::uint8_t, 14> wire{};
  wire[6] = 0x88;
  wire[7] = 0x13;  // 5000
  EXPECT_FALSE(decodeWooden(WoodenForm::kP14, wire)->stylus_button);
  wire[6] = 0x89;  // 5001
  const auto pressed = decodeWooden(WoodenForm::kP14, wire);
  EXPECT_TRUE(pressed->stylus_button);
  EXPECT_EQ(pressed->encoders[3], -4999);
}

TEST(WoodenCodec, SerialLineIsModelSixEncodersAndAFault) {
  const auto r = decodeWooden(WoodenForm::kS, bytesOf("[1,8327,-10926,27140,0,30,-1,7]\r\n"));
  ASSERT_TRUE(r);
  EXPECT_EQ(r->encoders, (std::array<std::int16_t, 6>{8327, -10926, 27140, 0, 30, -1}));
  EXPECT_EQ(r->fault, 7);
}

TEST(WoodenCodec, SerialEncoderPastSixteenBitsWraps) {
  EXPECT_EQ(decodeWooden(WoodenForm::kS, bytesOf("[3,32768,-32769,65536,0,0,0,0]"))->encoders,
            (std::array<std::int16_t, 6>{-32768, 32767, 0, 0, 0, 0}));
}

TEST(WoodenCodec, MalformedSerialLinesAreRefused) {
  for (const std::string_view line :
       {"", "\n", "[]", "[1,2,3]", "[1,0,0,0,0,0,0,0,0]", "1,0,0,0,0,0,0,0", "[1,0,0,0,0,0,0,0",
        "[1,0,0,0,,0,0,0]", "[1, 0,0,0,0,0,0,0]", "[1,0,0,0,0,0,0,x]", "[1,0,0,0,0,0,0,0]x",
        "[0,0,0,0,0,0,0,0]", "[4,0,0,0,0,0,0,0]", "[1,99999999999,0,0,0,0,0,0]", "[1,nan,0,0,0,0,0,0]"})
    EXPECT_FALSE(decodeWooden(WoodenForm::kS, bytesOf(line))) << line;
}

TEST(WoodenCodec, HidReportsOfAnyOtherLengthAreRefused) {
  const std::array<std::uint8_t, 64> wire{};
  for (std::size_t n = 0; n <= wire.size(); ++n) {
    const std::span<const std::uint8_t> report(wire.data(), n);
    EXPECT_EQ(decodeWooden(WoodenForm::kW8, report).has_value(), n == 8) << n;
    EXPECT_EQ(decodeWooden(WoodenForm::kP14, report).has_value(), n == 14) << n;
  }
}

TEST(WoodenCodec, OutputsHaveTheirGoldenBytes) {
  const WoodenCommand command{.ma = {1500.4, -2.5, 300.0}};
  EXPECT_EQ(encoded(WoodenForm::kW8, command),
            (std::vector<std::uint8_t>{0xDC, 0x05, 0xFD, 0xFF, 0x2C, 0x01, 0, 0}));
  EXPECT_EQ(encoded(WoodenForm::kP14, command),
            (std::vector<std::uint8_t>{0xDC, 0x05, 0xFD, 0xFF, 0x2C, 0x01, 0, 0, 0, 0, 0, 0, 0, 0}));
  const std::vector<std::uint8_t> line = encoded(WoodenForm::kS, command);
  EXPECT_EQ(std::string(line.begin(), line.end()), "[1500,-3,300]\n");
}

TEST(WoodenCodec, PresetGivesCommandOneAndNoCurrent) {
  const WoodenCommand command{.ma = {1000, 1000, 1000}, .preset = {{8327, -10926, 6000}}};
  EXPECT_EQ(encoded(WoodenForm::kP14, command),
            (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 1, 0, 0x87, 0x20, 0x52, 0xD5, 0x70, 0x17}));
}

TEST(WoodenCodec, NoInputMakesACurrentPastSixAmpere) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double ma : {6000.5, 1e300, inf, -1e300, -inf, std::nan(""), 32767.0, -32769.0}) {
    const std::vector<std::uint8_t> out = encoded(WoodenForm::kW8, {.ma = glm::dvec3{ma}});
    const auto sent = static_cast<std::int16_t>(out[0] | (out[1] << 8));
    EXPECT_LE(std::abs(sent), 6000) << ma;
    EXPECT_EQ(sent == 0, !std::isfinite(ma)) << ma;
  }
}

TEST(WoodenCodec, AnyBytesDecodeOrAreRefusedWithoutReadingPastTheEnd) {
  std::mt19937 random(20040928);
  for (int i = 0; i < 200000; ++i) {
    // The heap copy has exactly the report's size, so that the address sanitizer sees a step too far.
    std::vector<std::uint8_t> report(random() % 40);
    const char alphabet[] = "[],-0123456789\n x";
    const bool text = (i & 1) != 0;
    for (auto& b : report)
      b = text ? static_cast<std::uint8_t>(alphabet[random() % (sizeof alphabet - 1)])
               : static_cast<std::uint8_t>(random());
    for (const WoodenForm form : {WoodenForm::kW8, WoodenForm::kP14, WoodenForm::kS}) {
      const auto r = decodeWooden(form, report);
      if (r && form != WoodenForm::kS) {
        EXPECT_EQ(woodenFormOfSize(report.size()), form);
      }
    }
  }
}

TEST(EncoderUnwrap, CountsOnAcrossTheSixteenBitBorderBothWays) {
  EncoderUnwrap u;
  EXPECT_EQ(u.next(32000), 32000);
  EXPECT_EQ(u.next(-32000), 33536);
  EXPECT_EQ(u.next(32000), 32000);
  u.reset();
  EXPECT_EQ(u.next(-7), -7);
}

TEST(EncoderUnwrap, FollowsManyTurnsExactly) {
  EncoderUnwrap u;
  std::int32_t true_count = 12;
  std::mt19937 random(1);
  EXPECT_EQ(u.next(static_cast<std::int16_t>(true_count)), true_count);
  for (int i = 0; i < 100000; ++i) {
    true_count += static_cast<std::int32_t>(random() % 65535) - 32767;
    ASSERT_EQ(u.next(static_cast<std::int16_t>(static_cast<std::uint16_t>(true_count & 0xFFFF))), true_count);
  }
}

}  // namespace
}  // namespace fettle::haptic
