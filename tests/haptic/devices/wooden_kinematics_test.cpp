#include "haptic/devices/wooden/wooden_kinematics.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "haptic/devices/wooden/wooden_calibration.h"
#include "tests/support/source_tree.h"

namespace fettle::haptic {
namespace {

constexpr double kPi = std::numbers::pi;
// Positions are sums of a few products below 1 m: some 10 roundings of 1.1e-16 each.
constexpr double kRounding = 1e-14;

glm::dvec3 randomAngles(std::mt19937& random) {
  std::uniform_real_distribution<double> turn(-1.5, 1.5);
  return {turn(random), turn(random), turn(random)};
}

// Angles of the workspace's origin: two links over the foot at (0.22, 0.08), solved by Newton.
glm::dvec3 originAngles(const WoodenConfig& c) {
  glm::dvec3 t{0.0, 0.3, 0.7};
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 p = woodenPosition(c, t);
    const glm::dmat3 j = woodenJacobian(c, t);
    const double det = j[1].x * j[2].z - j[2].x * j[1].z;
    t.y -= (p.x * j[2].z - j[2].x * p.z) / det;
    t.z -= (j[1].x * p.z - p.x * j[1].z) / det;
  }
  return t;
}

TEST(WoodenKinematics, HomePoseOfWoody2015IsWhereItsMakersSay) {
  const WoodenConfig c = *wooden("woody_v2015");
  const glm::dvec3 angles = woodenAngles(c, {0, 0, 6000});
  EXPECT_NEAR(angles.z, kPi / 2, kRounding);
  const glm::dvec3 p = woodenPosition(c, angles);
  EXPECT_NEAR(p.x, 0.025, kRounding);
  EXPECT_NEAR(p.y, 0.0, kRounding);
  EXPECT_NEAR(p.z, 0.205, kRounding);
}

TEST(WoodenKinematics, AlignedMotorTurnsTheBodyTheOtherWay) {
  WoodenConfig c = *wooden("woody_v2015");
  c.motor_and_body_aligned = {true, false, true};
  const glm::dvec3 angles = woodenAngles(c, {100, 100, -6000});
  EXPECT_LT(angles.x, 0.0);
  EXPECT_GT(angles.y, 0.0);
  EXPECT_NEAR(angles.z, kPi / 2, kRounding);
}

TEST(WoodenKinematics, ResolutionAndForcePerAmpereAtTheOriginAreThePublishedOnes) {
  const WoodenConfig c = *wooden("woody_v2015");
  const glm::dvec3 origin = originAngles(c);
  ASSERT_LT(glm::length(woodenPosition(c, origin)), kRounding);
  const glm::dmat3 j = woodenJacobian(c, origin);
  const glm::dvec3 per_count = woodenAngles(c, {1, 1, 1});
  const glm::dvec3 published_mm{0.043, 0.054, 0.064};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(1000.0 * glm::length(j[i]) * per_count[i], published_mm[i], 0.0005) << i;

  // Force along an axis at which the most loaded motor has 1 A.
  const glm::dvec3 published_n{1.6, 1.9, 2.1};
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 f{0.0};
    f[axis] = 1.0;
    const glm::dvec3 ma = woodenCurrents(c, woodenTorques(c, origin, f));
    const double most = std::max({std::abs(ma.x), std::abs(ma.y), std::abs(ma.z)});
    EXPECT_NEAR(1000.0 / most, published_n[axis], 0.05) << axis;
  }
}

TEST(WoodenKinematics, JacobianIsTheNumericDerivativeOfThePosition) {
  std::mt19937 random(7);
  for (const char* name : {"woody_v2015", "woody_v2019", "aluhaptics_v2"}) {
    const WoodenConfig c = *wooden(name);
    for (int n = 0; n < 200; ++n) {
      const glm::dvec3 t = randomAngles(random);
      const glm::dmat3 j = woodenJacobian(c, t);
      for (int i = 0; i < 3; ++i) {
        // Central difference: error h^2/6 f''' + eps f / h, with f and f''' below 0.5 m and h = 1e-5 this is
        // 8e-12 + 1e-11.
        constexpr double h = 1e-5;
        glm::dvec3 up = t;
        glm::dvec3 down = t;
        up[i] += h;
        down[i] -= h;
        const glm::dvec3 numeric = (woodenPosition(c, up) - woodenPosition(c, down)) / (2.0 * h);
        EXPECT_LT(glm::length(numeric - j[i]), 5e-11) << name;
      }
    }
  }
}

TEST(WoodenKinematics, TorquesDoTheWorkOfTheForce) {
  // Virtual work: tau . dtheta = F . J dtheta, for any motion; the published closed forms, written out.
  std::mt19937 random(8);
  const WoodenConfig c = *wooden("woody_v2015");
  for (int n = 0; n < 200; ++n) {
    const glm::dvec3 t = randomAngles(random);
    const glm::dvec3 f = 3.0 * randomAngles(random);
    const double lb = c.length_body_m.y;
    const double lc = c.length_body_m.z;
    const double r = lb * std::sin(t.y) + lc * std::sin(t.z);
    const glm::dvec3 expected{r * (-std::sin(t.x) * f.x + std::cos(t.x) * f.y),
                              lb * (std::cos(t.x) * std::cos(t.y) * f.x +
                                    std::sin(t.x) * std::cos(t.y) * f.y - std::sin(t.y) * f.z),
                              lc * (std::cos(t.x) * std::cos(t.z) * f.x +
                                    std::sin(t.x) * std::cos(t.z) * f.y + std::sin(t.z) * f.z)};
    EXPECT_LT(glm::length(woodenTorques(c, t, f) - expected), kRounding);
  }
}

TEST(WoodenKinematics, CurrentsOverTheLimitKeepTheirDirection) {
  const WoodenConfig c = *wooden("woody_v2015");
  const LimitedCurrents limited = limitCurrents(c, {1000.0, -12000.0, 3000.0});
  EXPECT_DOUBLE_EQ(limited.scale, 0.25);
  EXPECT_EQ(limited.ma, (glm::dvec3{250.0, -3000.0, 750.0}));
  EXPECT_EQ(limitCurrents(c, {3000.0, -3000.0, 1.0}).scale, 1.0);
}

TEST(WoodenKinematics, EachMotorHasItsOwnLimit) {
  WoodenConfig c = *wooden("woody_v2015");
  c.max_current_a = {1.0, 3.0, 3.0};
  EXPECT_DOUBLE_EQ(limitCurrents(c, {2000.0, 3000.0, 0.0}).scale, 0.5);
}

TEST(WoodenKinematics, NonFiniteCurrentsGiveNone) {
  const WoodenConfig c = *wooden("woody_v2015");
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {inf, -inf, std::nan("")})
    EXPECT_EQ(limitCurrents(c, {100.0, bad, 100.0}).ma, glm::dvec3{0.0});
}

TEST(WoodenKinematics, DeskFrameHasRightAwayAndUp) {
  EXPECT_EQ(woodenToDesk({1, 0, 0}), (glm::dvec3{0, -1, 0}));  // towards the user = not away
  EXPECT_EQ(woodenToDesk({0, 1, 0}), (glm::dvec3{1, 0, 0}));
  const glm::dvec3 v{0.3, -0.7, 0.2};
  EXPECT_EQ(deskToWooden(woodenToDesk(v)), v);
}

TEST(WoodenConfigFile, ShippedFilesAreThePublishedConfigurations) {
  for (const char* name : {"woody_v2015", "woody_v2019", "aluhaptics_v2"}) {
    const auto file = readWoodenConfig(tests::inSourceTree("assets/devices/") + name + ".json");
    ASSERT_TRUE(file) << file.error().line();
    const WoodenConfig built_in = *wooden(name);
    const std::array<std::int32_t, 3> counts{123, -456, 789};
    const glm::dvec3 angles = woodenAngles(built_in, counts);
    EXPECT_EQ(woodenAngles(*file, counts), angles) << name;
    EXPECT_EQ(woodenPosition(*file, angles), woodenPosition(built_in, angles)) << name;
    EXPECT_EQ(woodenCurrents(*file, glm::dvec3{0.1}), woodenCurrents(built_in, glm::dvec3{0.1})) << name;
    EXPECT_EQ(file->calibrate_enc, built_in.calibrate_enc) << name;
    const DeviceProfile p = woodenProfile(*file);
    EXPECT_DOUBLE_EQ(p.max_force_n, 5.0);
    EXPECT_DOUBLE_EQ(p.max_stiffness_n_per_mm, 1.0);
    EXPECT_DOUBLE_EQ(p.max_damping_n_s_per_mm, 0.008);
    EXPECT_DOUBLE_EQ(p.workspace_radius_mm, 100.0);
  }
}

TEST(WoodenConfigFile, EachBadFieldIsNamed) {
  std::ifstream file(tests::inSourceTree("assets/devices/woody_v2015.json"));
  const nlohmann::json good = nlohmann::json::parse(file);
  ASSERT_TRUE(parseWoodenConfig(good.dump(), "x"));
  const auto problem = [&](const char* field, const nlohmann::json& value) {
    nlohmann::json bad = good;
    if (value.is_null())
      bad.erase(field);
    else
      bad[field] = value;
    const auto r = parseWoodenConfig(bad.dump(), "woody.json");
    return r ? std::string() : r.error().line();
  };
  EXPECT_NE(problem("diameter_body_b", nullptr).find("diameter_body_b"), std::string::npos);
  EXPECT_NE(problem("torque_constant_motor_c", 0).find("torque_constant_motor_c"), std::string::npos);
  EXPECT_NE(problem("length_body_a", 80).find("length_body_a"), std::string::npos);  // millimetres
  EXPECT_NE(problem("cpr_encoder_a", "2000").find("cpr_encoder_a"), std::string::npos);
  EXPECT_NE(problem("calibrate_enc_c", 40000).find("calibrate_enc_c"), std::string::npos);
  EXPECT_NE(problem("max_current_motor_a", 6.5).find("max_current_motor_a"), std::string::npos);
  EXPECT_FALSE(parseWoodenConfig("[1,2", "x"));
  EXPECT_FALSE(parseWoodenConfig("[]", "x"));
  EXPECT_FALSE(readWoodenConfig("/nowhere/woodenhaptics.json"));
  EXPECT_FALSE(wooden("omega"));
}

WoodenReport reportOf(std::int16_t a, std::int16_t b, std::int16_t c, bool latched = false) {
  WoodenReport r;
  r.encoders = {a, b, c, 0, 0, 0};
  r.calibration_latched = latched;
  return r;
}

TEST(WoodenCalibration, HostOffsetMakesTheHomePoseReadItsCounts) {
  WoodenCalibration calibration(WoodenCalibration::Method::kHost, {0, 0, 6000});
  calibration.onReport(reportOf(-30, 40, 32700), false, 0);
  EXPECT_FALSE(calibration.calibrated());
  calibration.onReport(reportOf(-30, 40, 32700), true, 0);
  ASSERT_TRUE(calibration.calibrated());
  EXPECT_EQ(calibration.counts(), (std::array<std::int32_t, 3>{0, 0, 6000}));
  calibration.onReport(reportOf(-20, 30, -32736), false, 0);  // c advanced by 100, over the border
  EXPECT_EQ(calibration.counts(), (std::array<std::int32_t, 3>{10, -10, 6100}));
}

TEST(WoodenCalibration, DeviceIsBelievedOnlyWhenItReadsAsPreset) {
  WoodenCalibration calibration(WoodenCalibration::Method::kDevice, {0, 0, 6000});
  calibration.onReport(reportOf(5, 5, 6005), false, 0);
  EXPECT_FALSE(calibration.presetRequested());
  calibration.onReport(reportOf(900, 900, 900, true), false, 0);  // its button
  EXPECT_TRUE(calibration.presetRequested());
  calibration.onReport(reportOf(5, 5, 6005, true), false, 0);  // near home, but nothing was sent yet
  EXPECT_FALSE(calibration.calibrated());
  calibration.onReport(reportOf(900, 900, 900, true), false, 1);  // sent, not obeyed
  EXPECT_FALSE(calibration.calibrated());
  calibration.onReport(reportOf(2, -3, 6004, true), false, 2);
  EXPECT_TRUE(calibration.calibrated());
  EXPECT_FALSE(calibration.presetRequested());
  EXPECT_EQ(calibration.counts(), (std::array<std::int32_t, 3>{2, -3, 6004}));
  calibration.onReport(reportOf(2, -3, 6004, true), false, 2);  // the latch holds: no second time
  EXPECT_TRUE(calibration.calibrated());
  calibration.onReport(reportOf(2, -3, 6004, false), false, 2);
  calibration.onReport(reportOf(2, -3, 6004, true), false, 2);  // pressed again
  EXPECT_FALSE(calibration.calibrated());
}

}  // namespace
}  // namespace fettle::haptic
