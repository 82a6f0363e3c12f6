// window_times [--everything | --least] [--adapts] SCAN...: how fast the window follows a hand, printed as a table: frames while the view
// turns, edits while a brush works, keys while nothing happens, while the view turns, while a filter is computed. Each
// scan with everything shown and (without --everything) with as little as possible, alone and beside two processes that spin at normal
// priority, with drawing that adapts to the time it takes and (without --adapts) with the fixed one (fettle view --steady), all in one
// run. The 1 kHz loop runs in all of it. Before that a row of what a program that draws nothing takes to follow a hand, alone and beside
// the two. scripts/bench-window builds and starts it.
//
// Times are the program's own where a frame was passed to the window system, and this one's where an input was made: how
// long this program waits for a processor itself does not count.
#include <cmath>
#include <csignal>
#include <cstdlib>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/end_to_end/window/display.h"
#include "tests/end_to_end/window/least_frame.h"
#include "tests/end_to_end/window/view_program.h"
#include "tests/end_to_end/window/x_hand.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;
using State = ViewProgram::State;
using Clock = std::chrono::steady_clock;

constexpr int kWidth = 1280, kHeight = 800;
constexpr auto kStep = 8ms;        // between two movements of the hand
constexpr auto kTurning = 4000ms;  // of the view
constexpr auto kStroke = 2500ms;   // each of
constexpr int kStrokes = 3;
constexpr std::size_t kKeys = 40;  // in each of the situations
// Between two keys, by turns: also while the picture is made finer, a quarter of a second after a change, and drawn with four rays
// a pixel after that.
constexpr std::array kPauses{130ms, 210ms, 270ms, 350ms, 450ms};
constexpr auto kMeanPause = 282ms;

enum class Shown { kLittle, kAll };
enum class Beside { kNothing, kSpinning };
enum class Drawing { kAdapts, kSteady };

// Two processes that spin at normal priority, while this lives.
class Spinning {
 public:
  explicit Spinning(Beside beside) {
    for (int i = 0; beside == Beside::kSpinning && i < 2; ++i) {
      const pid_t pid = fork();
      if (pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (std::atomic<unsigned> count = 0;;) count.fetch_add(1, std::memory_order_relaxed);
      }
      pids_.push_back(pid);
    }
  }
  ~Spinning() {
    for (const pid_t pid : pids_) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
  }
  Spinning& operator=(Spinning&&) = delete;

 private:
  std::vector<pid_t> pids_;
};

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

void writeSettings(const std::string& folder, Shown shown) {
  const bool all = shown == Shown::kAll;
  const std::filesystem::path settings = std::filesystem::path(folder) / "fettle";
  std::filesystem::create_directories(settings);
  std::ofstream(settings / "window.json")
      << State{{"edge_lines", false},       {"marks", all},
               {"decorations", all},        {"axes", all},
               {"side_panel", all},         {"smooth_at_rest", all},
               {"filtered_normals", all},   {"occlusion", all ? 0.8 : 0.0},
               {"cavity", all ? 0.5 : 0.0}, {"stylus_pen", all},
               {"stylus_shadow", all},      {"stylus_force", all},
               {"stylus_trail", all},       {"ask_before_quitting", false}};
}

// One row of the table.
struct Row {
  std::vector<double> frames, keys, keys_turning, keys_computing;  // [ms]
  State report;
};

class Run {
 public:
  Run(const Display& display, const std::string& scan, Drawing drawing)
      : hand_(display.name()), program_(arguments(scan, drawing), {}, ViewProgram::Watched::kNo) {
    if (!hand_.works()) throw std::runtime_error("the display has no XTEST extension");
    settle("the scan at rest");
    // Nobody presses a key within a second of the first picture. Beside two that spin the rehearsal takes minutes.
    (void)program_.until(
        "the rehearsal", [](const State& s) { return s.value("rehearsed", false); },
        5 * ViewProgram::kPatience);
  }

  Row measure() {
    const State picture = program_.now()["picture"];
    const double left = picture[0], top = picture[1], width = picture[2], height = picture[3];
    middle_x_ = left + 0.5 * width;
    middle_y_ = top + 0.5 * height;
    reach_ = 0.2 * std::min(width, height);
    pressKeys(row_.keys);
    turn();
    settle("at rest after turning");
    press('7');  // from above: a stroke meets the surface everywhere
    settle("from above");
    press('s');
    for (int i = 0; i < kStrokes; ++i) stroke(i);
    computing();
    program_.signal(SIGTERM);
    (void)program_.wait();
    row_.report = State::parse(program_.out());
    return row_;
  }

 private:
  static std::vector<std::string> arguments(const std::string& scan, Drawing drawing) {
    std::vector<std::string> all{scan, "--size", fmt::format("{}x{}", kWidth, kHeight)};
    if (drawing == Drawing::kSteady) all.emplace_back("--steady");
    return all;
  }

  // What was reported in the meantime is gone afterwards.
  void drop() {
    program_.each([](const State&) {});
  }
  void settle(const char* what) {
    (void)program_.until(what, [](const State& s) { return s["settled"] == true && s["path"] != ""; });
    drop();
  }
  void press(char key) {
    const auto keys = program_.now()["keys"].get<std::uint64_t>();
    hand_.key(key);
    (void)program_.until("a key", [&](const State& s) { return s["keys"] > keys; });
    drop();
  }

  // From a key to the frame that shows the contour lines which it switches [ms].
  double keyToEffect() {
    const bool before = program_.now()["contours"];
    const std::int64_t at = hand_.key('c');
    const State seen =
        program_.until("contour lines", [&](const State& s) { return s["contours"] != before; });
    return 1e-6 * static_cast<double>(seen["shown_ns"].get<std::int64_t>() - at);
  }
  void pressKeys(std::vector<double>& times) {
    for (std::size_t i = 0; i < kKeys; ++i) {
      times.push_back(keyToEffect());
      std::this_thread::sleep_for(kPauses[i % kPauses.size()]);
    }
    settle("after keys");
  }

  // Moves for so long, the hand's way by the share of the time that has passed; `each` after each movement.
  void move(std::chrono::milliseconds time, const auto& place, const auto& each) {
    const Clock::time_point begin = Clock::now();
    for (Clock::time_point next = begin; next < begin + time; next += kStep) {
      const auto [x, y] = place(std::chrono::duration<double>(next - begin) / time);
      hand_.moveTo(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)));
      each();
      std::this_thread::sleep_until(next + kStep);
    }
  }

  void turn() {
    constexpr int kMiddle = 2;
    const auto round = [&](double share) {
      return std::pair{middle_x_ + reach_ * std::cos(12.0 * share),
                       middle_y_ + reach_ * std::sin(12.0 * share)};
    };
    const auto [x, y] = round(0.0);
    hand_.moveTo(static_cast<int>(x), static_cast<int>(y));
    hand_.press(kMiddle);
    std::int64_t last = 0;
    State view;
    const auto look = [&] {
      program_.each([&](const State& s) {
        const std::int64_t shown = s["shown_ns"];
        if (last > 0 && s["view"] != view) row_.frames.push_back(1e-6 * static_cast<double>(shown - last));
        last = shown;
        view = s["view"];
      });
    };
    move(kTurning, round, look);
    // The same with keys.
    Clock::time_point due = Clock::now();
    std::optional<std::int64_t> pressed;
    bool contours = false;
    move(kKeys * (kMeanPause + 60ms), round, [&] {
      program_.each([&](const State& s) {
        if (pressed && s["contours"] != contours) {
          row_.keys_turning.push_back(1e-6 *
                                      static_cast<double>(s["shown_ns"].get<std::int64_t>() - *pressed));
          pressed.reset();
          due = Clock::now() + kPauses[row_.keys_turning.size() % kPauses.size()];
        }
        contours = pressed ? contours : s["contours"].get<bool>();
      });
      if (!pressed && Clock::now() >= due) pressed = hand_.key('c');
    });
    hand_.release(kMiddle);
  }

  void stroke(int number) {
    constexpr int kLeft = 1;
    const double row = middle_y_ + 0.4 * reach_ * (number - 1);
    const auto along = [&](double share) {
      return std::pair{middle_x_ - reach_ + 2.0 * reach_ * share,
                       row + 0.1 * reach_ * std::sin(20.0 * share)};
    };
    const auto [x, y] = along(0.0);
    hand_.moveTo(static_cast<int>(x), static_cast<int>(y));
    std::this_thread::sleep_for(300ms);  // the stylus follows the cursor
    hand_.press(kLeft);
    move(kStroke, along, [&] { drop(); });
    hand_.release(kLeft);
    settle("after a stroke");
  }

  // Keys while a median is computed and its preview drawn.
  void computing() {
    constexpr int kFilters = 20;  // more than there are
    for (int i = 0; i < kFilters; ++i) {
      if (program_.now()["filter"].get<std::string>().starts_with("Median")) break;
      press('n');
    }
    press('p');
    for (std::size_t i = 0; i < kKeys; ++i) {
      row_.keys_computing.push_back(keyToEffect());
      if (program_.now()["filtering"] != true) press('w');  // another window: it begins again
      std::this_thread::sleep_for(kPauses[i % kPauses.size()]);
    }
  }

  XHand hand_;
  ViewProgram program_;
  Row row_;
  double middle_x_ = 0.0, middle_y_ = 0.0, reach_ = 0.0;
};

std::string pair(const std::vector<double>& times) {
  return fmt::format("{:.0f}, {:.0f}, {:.0f}", percentile(times, 0.5), percentile(times, 0.99),
                     percentile(times, 1.0));
}

void print(const std::string& scan, Shown shown, Beside beside, Drawing drawing, const Row& row) {
  const State& r = row.report;
  std::vector<double> keys = row.keys;
  keys.insert(keys.end(), row.keys_turning.begin(), row.keys_turning.end());
  keys.insert(keys.end(), row.keys_computing.begin(), row.keys_computing.end());
  fmt::print(
      "{:<16} {:<7} {:<9} {:<7} {:>15} {:>7.0f} {:>5.0f} {:>6} {:>14} {:>14} {:>14} {:>6.0f} {:>7.0f}\n",
      std::filesystem::path(scan).stem().string(), shown == Shown::kAll ? "all" : "little",
      beside == Beside::kSpinning ? "two spin" : "nothing", drawing == Drawing::kAdapts ? "adapts" : "steady",
      pair(row.frames), r.value("edit_to_pixel_p50_ms", NAN), r.value("edit_to_pixel_p99_ms", NAN),
      r.value("edits_shown", 0), pair(row.keys), pair(row.keys_turning), pair(row.keys_computing),
      percentile(keys, 0.99), r.value("lateness_p99_us", NAN));
  std::fflush(stdout);
}

// Of the display alone: no window can follow a hand more closely.
void printLeast(const Display& display) {
  constexpr int kFrames = 300;
  for (const Beside beside : {Beside::kNothing, Beside::kSpinning}) {
    const Spinning spinning(beside);
    const std::vector<double> times = leastFrames(display.name(), kWidth, kHeight, kFrames);
    fmt::print(
        "a program that draws nothing, beside {}: {:.1f}, {:.1f}, {:.1f} ms (p50, p99, most) from the hand "
        "to the display\n",
        beside == Beside::kSpinning ? "two that spin" : "nothing", percentile(times, 0.5),
        percentile(times, 0.99), percentile(times, 1.0));
  }
}

int run(const std::vector<std::string>& scans, const std::vector<Shown>& kinds,
        const std::vector<Drawing>& drawings) {
  const TempFolder folder;
  const Display display(kWidth, kHeight, folder.path());
  if (!display.works()) {
    fmt::print(stderr, "window_times: there is no Xvfb\n");
    return 1;
  }
  setenv("DISPLAY", display.name().c_str(), 1);
  printLeast(display);
  fmt::print("{:<16} {:<7} {:<9} {:<7} {:>15} {:>13} {:>6} {:>14} {:>14} {:>14} {:>6} {:>7}\n", "", "", "",
             "", "frame", "edit to pixel", "", "key", "key, turning", "key, filtering", "keys", "loop");
  fmt::print("{:<16} {:<7} {:<9} {:<7} {:>15} {:>7} {:>5} {:>6} {:>14} {:>14} {:>14} {:>6} {:>7}\n", "scan",
             "shown", "beside", "drawing", "p50,p99,most ms", "p50 ms", "p99", "edits", "p50,p99,most",
             "p50,p99,most", "p50,p99,most", "p99 ms", "p99 us");
  for (const std::string& scan : scans)
    for (const Shown shown : kinds)
      for (const Beside beside : {Beside::kNothing, Beside::kSpinning})
        for (const Drawing drawing : drawings) {
          const TempFolder home;  // without the work of the run before
          for (const char* kind : {"XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME"})
            setenv(kind, home.path().c_str(), 1);
          writeSettings(home.path(), shown);
          const Spinning spinning(beside);
          print(scan, shown, beside, drawing, Run(display, scan, drawing).measure());
        }
  return 0;
}

}  // namespace
}  // namespace fettle::tests

int main(int argc, char** argv) {
  using fettle::tests::Drawing;
  using fettle::tests::Shown;
  std::vector<std::string> scans(argv + 1, argv + argc);
  std::vector<Shown> kinds{Shown::kAll};
  if (std::erase(scans, "--least") > 0)
    kinds = {Shown::kLittle};
  else if (std::erase(scans, "--everything") == 0)
    kinds.push_back(Shown::kLittle);
  std::vector<Drawing> drawings{Drawing::kAdapts};
  if (std::erase(scans, "--adapts") == 0) drawings.push_back(Drawing::kSteady);
  if (scans.empty()) {
    fmt::print(stderr, "window_times [--everything | --least] [--adapts] SCAN...\n");
    return 2;
  }
  try {
    return fettle::tests::run(scans, kinds, drawings);
  } catch (const std::exception& error) {
    fmt::print(stderr, "window_times: {}\n", error.what());
    return 1;
  }
}
