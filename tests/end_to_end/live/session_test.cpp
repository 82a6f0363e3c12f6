// What a person does in a session, through the real program and a device that is only pretended: what it
// leaves behind, and that a replay of the recording leaves the same.
#include <cmath>
#include <fstream>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "tests/end_to_end/live/session.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;

class LiveSession : public testing::TestWithParam<Firmware> {};
INSTANTIATE_TEST_SUITE_P(Firmware, LiveSession, testing::Values(Firmware::kW8, Firmware::kP14),
                         [](const auto& i) { return firmwareName(i.param); });

std::size_t rowsWithNaN(const std::string& path) {
  std::ifstream file(path);
  std::size_t rows = 0;
  for (std::string line; std::getline(file, line);) rows += line.find("nan") != std::string::npos ? 1 : 0;
  return rows;
}

// Press, smooth, mark, lift; ends with what the program reports.
nlohmann::json pressSmoothAndMark(Session& session) {
  session.calibrate();
  session.arm();
  session.touch(3.0);
  session.expectForce();
  session.use('s');
  session.goTo({30.0, 0.0, -3.0}, 500ms);
  session.release();
  session.goTo({30.0, 0.0, 5.0}, 200ms);
  session.expectNoForce();
  session.goTo({30.0, 20.0, -3.0}, 300ms);
  session.use('m');
  session.goTo({-10.0, 20.0, -3.0}, 500ms);
  session.release();
  session.goTo({0.0, 0.0, 20.0}, 200ms);
  session.expectNoForce();
  return session.end();
}

TEST_P(LiveSession, PressSmoothAndMarkAreFeltKeptAndReplayedToTheSameBits) {
  // A machine that holds the program up for 50 ms gets a fault and no edits from then on, as it should: that
  // session shows nothing of what this test is about, and another is played.
  std::optional<Session> session;
  nlohmann::json report;
  for (int attempt = 0; attempt < 3; ++attempt) {
    session.emplace(GetParam());
    report = pressSmoothAndMark(*session);
    if (report["safety"]["faults"] == 0) break;
  }
  const Felt felt = session->felt("a session: press, smooth, mark, lift");
  EXPECT_EQ(report["safety"]["faults"], 0);
  EXPECT_GT(felt.peak_n, 0.8);  // 3 mm of the hand at 0.5 N/mm, bent by the straight line of counts
  EXPECT_GT(report["samples_changed"], 20);
  EXPECT_GT(report["marked"], 20);
  EXPECT_GE(report["strokes"], 2);
  EXPECT_EQ(report["ended_by"], "key");
  EXPECT_NEAR(report["scale"].get<double>(), 0.5, 1e-9);
  EXPECT_NEAR(report["felt_stiffness_n_per_mm"].get<double>(), 0.5, 1e-9);
  EXPECT_TRUE(report["scene"].is_null()) << "the default scene as it is";
  EXPECT_EQ(session->woody.log().ma, (std::array<std::int16_t, 3>{}));
  EXPECT_EQ(session->woody.log().watchdog_fired, 0U);
}

// The hand does the same and feels an ordinary part at 1:1; what was fitted is written for the replay.
TEST_P(LiveSession, AScanOfMicrometresOrKilometresIsFeltKeptAndReplayedToTheSameBits) {
  for (const double side_mm : {5e-3, 5e6}) {
    std::optional<Session> session;
    nlohmann::json report;
    for (int attempt = 0; attempt < 3; ++attempt) {
      session.emplace(GetParam(), std::vector<std::string>{}, side_mm);
      report = pressSmoothAndMark(*session);
      if (report["safety"]["faults"] == 0) break;
    }
    EXPECT_EQ(report["safety"]["faults"], 0);
    EXPECT_GT(session->felt("a session on another scale").peak_n,
              1.6);  // 3 mm of the hand at 1 N/mm, as above
    EXPECT_GT(report["samples_changed"], 20);
    EXPECT_GT(report["marked"], 20);
    EXPECT_NEAR(report["scale"].get<double>() / (side_mm / 200.0), 1.0, 1e-6);
    EXPECT_NEAR(report["felt_stiffness_n_per_mm"].get<double>(), 1.0, 1e-3);
    EXPECT_EQ(report["scene"], session->folder.file("session.csv.scene.toml"));
  }
}

TEST_P(LiveSession, NothingIsGivenOrEditedUntilThePersonArms) {
  Session session(GetParam());
  session.calibrate();
  session.use('s');
  session.touch(3.0);
  session.goTo({20.0, 0.0, -3.0}, 300ms);
  EXPECT_EQ(session.woody.log().most_ma, 0);
  // Armed deep inside: still nothing, until the stylus came out once.
  ASSERT_TRUE(eventually([&] {
    session.program->press('a');
    return session.program->says("armed", 2s);
  }));
  session.goTo({0.0, 0.0, -4.0}, 300ms);
  EXPECT_EQ(session.woody.log().most_ma, 0);
  session.felt("armed 2 mm inside the surface");
  session.release();
  session.goTo({0.0, 0.0, 6.0}, 300ms);
  ASSERT_TRUE(session.program->says("ramping"));
  session.goTo({0.0, 0.0, -3.0}, 300ms);
  session.expectForce();
  const nlohmann::json report = session.end();
  EXPECT_EQ(report["samples_changed"], 0);
}

TEST_P(LiveSession, StrokeIsKeptWhenTheDeviceIsPulledOutAndWorkGoesOnAfterItIsBack) {
  Session session(GetParam());
  session.calibrate();
  session.arm();
  session.touch(3.0);
  session.use('s');
  session.goTo({20.0, 0.0, -3.0}, 400ms);
  session.expectForce();
  session.woody.unplug();
  ASSERT_TRUE(session.program->says("stroke kept")) << session.program->err();
  ASSERT_TRUE(session.program->says("fault, unplugged")) << session.program->err();
  session.release();
  session.goTo({0.0, 0.0, 6.0}, 100ms);
  const std::size_t back = session.woody.history().size();
  session.woody.plug();
  session.calibrate();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(session.woody.log().most_ma, 0);  // the fault stands until the person arms
  session.arm();
  session.touch(3.0);
  session.use('s');
  session.goTo({-20.0, 0.0, -3.0}, 400ms);
  session.expectForce();
  session.release();
  session.goTo({0.0, 0.0, 6.0}, 200ms);
  session.felt("pulled out in a stroke, back, armed again", back);
  const nlohmann::json report = session.end();
  EXPECT_GE(report["strokes"], 2);
  EXPECT_EQ(report["device"]["disconnects"], 1);
  EXPECT_GE(report["safety"]["faults"], 1);
  EXPECT_GT(report["samples_changed"], 20);
  EXPECT_GT(rowsWithNaN(session.strokes), 0U);  // while it was out: no position, so none in the file
}

TEST_P(LiveSession, CtrlCEndsTheSessionAndKeepsItWithZeroForce) {
  Session session(GetParam());
  session.calibrate();
  session.arm();
  session.touch(3.0);
  session.use('s');
  session.goTo({20.0, 0.0, -3.0}, 300ms);
  session.expectForce();
  session.program->signal(SIGINT);
  EXPECT_EQ(session.program->wait(), 0) << session.program->err();
  expectNoSanitizerReport(*session.program);
  const nlohmann::json report = session.program->report();
  ASSERT_TRUE(report.is_object()) << session.program->err();
  EXPECT_EQ(report["ended_by"], "signal");
  EXPECT_TRUE(report["reproduced"].get<bool>());
  EXPECT_GT(report["samples_changed"], 0);
  EXPECT_TRUE(std::filesystem::exists(session.out));
  EXPECT_EQ(session.woody.log().ma, (std::array<std::int16_t, 3>{}));
  EXPECT_EQ(session.woody.log().watchdog_fired, 0U);
  session.felt("Ctrl-C while pressing");
}

TEST(LiveWithoutDevice, SimulatedHandAndRealTimeReplayAreRecordedToTheSameBits) {
  const TempFolder folder;
  Session plate(Firmware::kW8, {"--seconds", "0.2"});
  EXPECT_EQ(plate.program->wait(), 0) << plate.program->err();
  std::ofstream path(folder.file("path.csv"));
  path << "t,x,y,z,tool\n";
  for (int i = 0; i <= 20; ++i)
    path << 0.1 * i << ',' << 30 + i << ",50," << (i < 3 || i > 17 ? 3.0 : -2.0) << ",smooth\n";
  path.close();
  for (const std::string device : {"hand:", "replay:"}) {
    LiveProgram program({"record", plate.scan, folder.file("r.csv"), folder.file("o.tif"), "--device",
                         device + folder.file("path.csv"), "--rate", "2000", "--json"},
                        folder.path().string());
    ASSERT_EQ(program.wait(), 0) << program.err();
    expectNoSanitizerReport(program);
    const nlohmann::json report = program.report();
    EXPECT_EQ(report["ended_by"], device == "hand:" ? "end of the strokes" : "time");
    EXPECT_TRUE(report["reproduced"].get<bool>()) << report;
    EXPECT_GT(report["samples_changed"], 0) << device;
    EXPECT_GT(report["ticks"], 1000) << device;
  }
}

}  // namespace
}  // namespace fettle::tests
