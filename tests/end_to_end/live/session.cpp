#include "tests/end_to_end/live/session.h"

#include <cmath>
#include <cstdio>

#include <thread>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "tests/support/process.h"

namespace fettle::tests {

namespace {

using namespace std::chrono_literals;

constexpr int kSide = 201;
const glm::dvec3 kAbove{0.0, 0.0, 6.0};

}  // namespace

void writePlate(const std::string& path, double side_mm) {
  engine::Grid grid;
  grid.width = grid.height = kSide;
  grid.spacing_x = grid.spacing_y = side_mm / (kSide - 1);
  std::vector<float> heights;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      heights.push_back(static_cast<float>(5e-4 * side_mm * std::sin(1.9 * c) * std::cos(2.3 * r)));
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(engine::makeField(grid, heights), path, {}, job));
}

bool eventually(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + 30s;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

void expectNoSanitizerReport(const LiveProgram& program) {
  for (const char* word : {"AddressSanitizer", "ThreadSanitizer", "LeakSanitizer", "runtime error:"})
    EXPECT_EQ(program.err().find(word), std::string::npos) << program.err();
}

Session::Session(Firmware firmware_to_run, std::vector<std::string> more_arguments, double side_mm)
    : firmware(firmware_to_run), woody(folder.path().string(), "woody", firmware_to_run) {
  scan = folder.file("plate.tif");
  strokes = folder.file("session.csv");
  out = folder.file("after.tif");
  marks = folder.file("marks.png");
  writePlate(scan, side_mm);
  woody.plug();
  std::vector<std::string> arguments{"record", scan,       strokes,         out,      "--marks-out",
                                     marks,    "--device", "woodenhaptics", "--keys", "--json"};
  if (firmware == Firmware::kW8) arguments.insert(arguments.end(), {"--switch", "always"});
  arguments.insert(arguments.end(), more_arguments.begin(), more_arguments.end());
  program = std::make_unique<LiveProgram>(arguments, folder.path().string());
}

void Session::calibrate() {
  ASSERT_TRUE(program->says("device not calibrated")) << program->err();
  woody.turnTo({0, 0, 0});
  // Asked again while it does not take: a key may come before the driver has seen the first report.
  ASSERT_TRUE(eventually([&] {
    if (firmware == Firmware::kP14)
      woody.pressCalibration();
    else
      program->press('c');
    return program->says("device connected", 1s);
  })) << program->err();
}

void Session::arm() {
  // Pressed again while it does not take: nobody is armed in a tick that comes 10 ms late.
  ASSERT_TRUE(eventually([&] {
    program->press('a');
    return program->says(" s: active", 2s);
  })) << program->err();
}

bool Session::armedAgainAfterAFault() {
  if (!program->said(" s: fault,")) return false;
  const glm::dvec3 at = at_;
  goTo(kAbove, 200ms);
  arm();
  goTo(at, 300ms);
  return true;
}

void Session::goTo(const glm::dvec3& desk_mm, std::chrono::milliseconds length) {
  at_ = desk_mm;
  woody.moveTo(countsAt(desk_mm), length);
  std::this_thread::sleep_for(length + 20ms);
}

void Session::touch(double mm) {
  goTo(kAbove, 400ms);
  goTo({0.0, 0.0, -mm}, 300ms);
}

void Session::use(char tool_key) {
  program->press(tool_key);
  if (firmware == Firmware::kP14) woody.pressStylus(true);
}

void Session::release() {
  if (firmware == Firmware::kP14)
    woody.pressStylus(false);
  else
    program->press('f');
}

void Session::expectForce() {
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(armedAgainAfterAFault());
    return woody.log().ma != std::array<std::int16_t, 3>{};
  })) << program->err();
}

void Session::expectNoForce() {
  EXPECT_TRUE(eventually([&] { return woody.log().ma == std::array<std::int16_t, 3>{}; })) << program->err();
}

Felt Session::felt(const std::string& attack, std::size_t from) {
  const Felt f = feltIn(woody.history(), kSlew_n_per_ms, from);
  std::printf("| %-58s | %-3s | %5d | %6.3f | %7.4f | %7.4f |\n", attack.c_str(),
              firmwareName(firmware).c_str(), f.peak_ma, f.peak_n, f.rate_n_per_ms, f.rise_n);
  std::fflush(stdout);
  // A milliampere is 2 mN; the pose of a report is a millisecond younger than the one its force was made for.
  EXPECT_LE(f.peak_n, kPeak_n * 1.02);
  // Two milliseconds of rise at once, after a report that the machine held up, is what the guard allows.
  EXPECT_LE(f.rise_n, 2.0 * kSlew_n_per_ms * 1.02);
  EXPECT_LE(f.ahead_n, 2.0 * kSlew_n_per_ms * 1.02);
  return f;
}

nlohmann::json Session::end() {
  program->press('q');
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectNoSanitizerReport(*program);
  nlohmann::json report = program->report();
  if (!report.is_object()) {
    ADD_FAILURE() << program->out() << program->err();
    return nlohmann::json::object();
  }
  EXPECT_EQ(report["hash"], report["replay_hash"]);
  EXPECT_TRUE(report["reproduced"].get<bool>());
  EXPECT_EQ(report["lost_rows"], 0);
  EXPECT_EQ(report["refused_edits"], 0);
  EXPECT_LE(report["safety"]["given_peak_n"].get<double>(), kPeak_n * (1.0 + 1e-12));
  // And by the command itself, in a process of its own.
  const std::vector<std::string> replay = {
      FETTLE_PROGRAM, "replay", scan, strokes, folder.file("replayed.tif"), "--json"};
  const Outcome replayed = runProcess(replay);
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  const auto again = nlohmann::json::parse(replayed.out, nullptr, false);
  EXPECT_TRUE(again.is_object() && again["hash"] == report["hash"]) << replayed.out;
  EXPECT_EQ(again.value("scene", ""), report.value("scene", "")) << "taken where it lies";
  return report;
}

}  // namespace fettle::tests
