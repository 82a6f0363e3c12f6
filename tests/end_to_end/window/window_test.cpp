// Drives the real program on a display of its own, as a person would: with a mouse and keys, looking at the
// screen.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/io/import.h"
#include "engine/io/marks.h"
#include "tests/end_to_end/window/display.h"
#include "tests/support/process.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 1000;
constexpr int kHeight = 700;
// The window's surface without menu, panels (320 px at the right) and status line.
constexpr Part kSurface{4, 40, 540, 600};

class Hand {
 public:
  explicit Hand(const Display& display) : display_(display) {}

  void key(const std::string& name) const { display_.hands({"key", name}); }
  void type(const std::string& text) const { display_.hands({"type", "--delay", "5", text}); }
  void at(int x, int y) const { display_.hands({"mousemove", std::to_string(x), std::to_string(y)}); }
  void drag(int button, int x0, int y0, int x1, int y1, int steps) const {
    const std::string b = std::to_string(button);
    at(x0, y0);
    std::this_thread::sleep_for(150ms);
    display_.hands({"mousedown", b});
    for (int i = 1; i <= steps; ++i) {
      at(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps);
      std::this_thread::sleep_for(30ms);
    }
    std::this_thread::sleep_for(150ms);
    display_.hands({"mouseup", b});
  }
  [[nodiscard]] Screen look() const { return display_.screen(); }
  /// Looks until the screen is as asked for, and has stopped moving.
  [[nodiscard]] Screen until(const std::string& what, const std::function<bool(const Screen&)>& is) const {
    const auto end = std::chrono::steady_clock::now() + 20s;
    Screen before = look();
    while (std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(250ms);
      Screen now = look();
      if (now.width == kWidth && is(now) && differing(now, before, kSurface, 2) == 0) return now;
      before = std::move(now);
    }
    ADD_FAILURE() << "never seen: " << what;
    return before;
  }
  /// Looks until the surface is another picture than `before`, in at least `pixels` pixels.
  [[nodiscard]] Screen changed(const std::string& what, const Screen& before, int pixels = 30) const {
    return until(what, [&](const Screen& now) { return differing(before, now, kSurface) >= pixels; });
  }
  [[nodiscard]] Screen same(const std::string& what, const Screen& as) const {
    return until(what, [&](const Screen& now) { return differing(as, now, kSurface) == 0; });
  }

 private:
  const Display& display_;
};

bool waitForFile(const std::string& path) {
  for (int i = 0; i < 200; ++i) {
    if (std::filesystem::exists(path)) return true;
    std::this_thread::sleep_for(50ms);
  }
  return false;
}

engine::Version load(const std::string& path) {
  engine::JobControl job;
  auto field = engine::importField(path, {}, job);
  if (!field) {
    ADD_FAILURE() << field.error().line();
    std::abort();
  }
  return field->field;
}

struct Differences {
  std::int64_t changed = 0;
  std::int64_t changed_marked = 0;
  std::int64_t marked = 0;
};
Differences compare(const engine::Version& a, const engine::Version& b) {
  Differences d;
  const engine::FieldReader x = a.reader(), y = b.reader();
  for (std::int32_t r = 0; r < x.height(); ++r)
    for (std::int32_t c = 0; c < x.width(); ++c) {
      const float p = x.heightAt(c, r), q = y.heightAt(c, r);
      const bool differs = !(p == q || (p != p && q != q));
      d.changed += differs;
      d.marked += y.markedAt(c, r);
      d.changed_marked += differs && y.markedAt(c, r);
    }
  return d;
}

class WindowTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!display.works()) GTEST_SKIP() << "no Xvfb";
    setenv("DISPLAY", display.name().c_str(), 1);
    setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);
    const Outcome made = runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "320x320", "--seed", "5"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  /// Runs the program on the scan, and `work` while it runs.
  Outcome view(const std::function<void(const Hand&)>& work) {
    ProcessOptions options;
    options.while_running = [&](int) {
      work(Hand(display));
      return true;
    };
    return runProcess(
        {FETTLE_PROGRAM, "view", scan, "--size", "1000x700", "--validate", "--json", "--seconds", "120"},
        options);
  }

  TempFolder folder;
  Display display{kWidth, kHeight, folder.path()};
  std::string scan = (folder.path() / "part.tif").string();
};

TEST_F(WindowTest, a_scan_is_smoothed_marked_filtered_and_saved_by_hand) {
  const std::string smoothed_path = (folder.path() / "smoothed.tif").string();
  const std::string filtered_path = (folder.path() / "filtered.tif").string();
  const Outcome outcome = view([&](const Hand& hand) {
    const Screen empty = hand.look();
    const Screen opened =
        hand.until("the scan", [&](const Screen& now) { return differing(empty, now, kSurface) > 20000; });
    hand.drag(2, 250, 300, 330, 280, 6);
    const Screen turned = hand.changed("another side of the scan", opened, 2000);
    hand.key("7");  // from above
    const Screen above = hand.changed("the scan from above", turned, 2000);

    hand.key("s");
    hand.drag(1, 200, 330, 360, 330, 16);
    hand.key("Escape");  // the stylus goes, what it did stays
    hand.at(20, 660);
    const Screen smoothed = hand.changed("a smoother surface", above);
    EXPECT_EQ(differing(above, smoothed, {4, 100, 540, 150}), 0) << "changed where no stroke was";
    hand.key("ctrl+s");
    std::this_thread::sleep_for(700ms);
    hand.type(smoothed_path);
    hand.key("Return");
    EXPECT_TRUE(waitForFile(smoothed_path));

    hand.key("m");
    hand.drag(1, 220, 420, 340, 420, 12);
    hand.key("Escape");
    hand.at(20, 660);
    const Screen marked = hand.changed("marks", hand.look().width > 0 ? smoothed : above);

    hand.key("n");
    hand.key("n");  // box, Gaussian, median
    hand.key("p");
    const Screen preview = hand.changed("a preview beside the field", marked, 300);
    hand.key("Return");
    const Screen filtered = hand.until("the median and no preview", [&](const Screen& now) {
      return differing(preview, now, kSurface) > 300 && differing(marked, now, kSurface) > 300;
    });
    hand.key("ctrl+z");
    (void)hand.same("the field before the median", marked);
    hand.key("ctrl+z");
    (void)hand.same("the field without marks", smoothed);
    hand.key("ctrl+shift+z");
    hand.key("ctrl+shift+z");
    (void)hand.same("the median again", filtered);

    hand.key("ctrl+shift+s");
    std::this_thread::sleep_for(700ms);
    hand.type(filtered_path);
    hand.key("Return");
    EXPECT_TRUE(waitForFile(filtered_path));
    std::this_thread::sleep_for(500ms);
    hand.key("ctrl+q");
  });
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["validation_messages"], nlohmann::json::array());
  EXPECT_EQ(report["filters_applied"], 1);
  EXPECT_EQ(report["steps"], 3);
  EXPECT_EQ(report["saved"], filtered_path);
  EXPECT_EQ(report["unsaved_changes"], false);
  EXPECT_GT(report["edits_shown"], 0);

  const engine::Version original = load(scan), smoothed = load(smoothed_path), filtered = load(filtered_path);
  const Differences stroke = compare(original, smoothed);
  EXPECT_GT(stroke.changed, 200);
  // The stroke is a band: half the width of the field, some fourteen samples high.
  EXPECT_LT(stroke.changed, 320 * 40);

  // What the window saved is what the filter makes of what was smoothed and marked, to the bit.
  auto marked = engine::importMarks(smoothed, (folder.path() / "filtered_marks.png").string());
  ASSERT_TRUE(marked) << marked.error().line();
  engine::FilterSpec median;
  median.kind = engine::FilterKind::kMedian;
  engine::JobControl job;
  const auto expected = engine::applyFilter(*marked, original, median, job);
  ASSERT_TRUE(expected);
  EXPECT_EQ(compare(expected->field, filtered).changed, 0);
  const Differences kept = compare(smoothed, expected->field);
  EXPECT_GT(kept.marked, 50);
  EXPECT_EQ(kept.changed_marked, 0);
  EXPECT_GT(kept.changed, 10000);
}

TEST_F(WindowTest, work_is_not_lost_without_a_question) {
  const Outcome outcome = view([&](const Hand& hand) {
    const Screen empty = hand.look();
    const Screen opened =
        hand.until("the scan", [&](const Screen& now) { return differing(empty, now, kSurface) > 20000; });
    hand.key("m");
    hand.drag(1, 200, 330, 300, 330, 10);
    hand.key("Escape");
    hand.at(20, 660);
    const Screen marked = hand.changed("marks", opened);
    hand.key("ctrl+q");
    const Screen asked = hand.changed("a question", marked, 1000);
    hand.key("Escape");
    (void)hand.same("the field again", marked);
    hand.key("ctrl+q");
    (void)hand.same("the question again", asked);
    hand.key("d");
  });
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["unsaved_changes"], true);
}

TEST_F(WindowTest, a_display_that_closes_ends_the_program_with_a_word) {
  const Outcome outcome = view([&](const Hand& hand) {
    const Screen empty = hand.look();
    (void)hand.until("the scan", [&](const Screen& now) { return differing(empty, now, kSurface) > 20000; });
    display.close();
  });
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("fettle: error: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("display"), std::string::npos) << outcome.err;
}

TEST(NoWindowTest, without_a_display_the_program_says_so) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const Outcome outcome = runProcess({FETTLE_PROGRAM, "view"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("there is no display"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace fettle::tests
