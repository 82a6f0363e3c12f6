// Whatever hands do, in frames of any length: the window continues, and its journal plays to what it saved.
#include <csignal>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "engine/io/raster/marks.h"
#include "tests/end_to_end/window/frame_gate.h"
#include "tests/end_to_end/window/monkey.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using State = User::State;

constexpr int kSlow = 50;    // one frame in so many is held up ...
constexpr auto kDelay = 1s;  // ... for so long
constexpr int kProbe = 40;   // frames between two looks whether the window still does what it is asked to
constexpr int kMostEscapes = 20;  // until nothing is open any more

std::int64_t number(const char* variable, std::int64_t otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoll(text);
}

// Nothing is left that Esc would end.
bool calm(const State& s) {
  return s["dialog"] == "none" && s["settled"] == true && s["text_field"] == false &&
         s.value("tool", "view") == "view" && s.value("variants", State::array()).empty() &&
         s.value("suggested", 0) == 0 && s.value("lasso", "") == "" && s.value("adjusting", "") == "" &&
         s.value("plane_point", State()).is_null() && !s.value("radial", State()).is_string();
}

// Everything that must come up. `folder` has "second.tif", "left.tif", "there.tif" and "broken.tif".
std::vector<Reach> reachesIn(const TempFolder& folder) {
  std::vector<Reach> all;
  const auto add = [&](const char* kind, const std::string& what, std::function<bool(const State&)> is,
                       std::vector<std::string> way) {
    way.insert(way.begin(), "Escape");
    all.push_back({kind, what, std::move(is), std::move(way)});
  };
  using Ways = std::vector<std::pair<std::string, std::vector<std::string>>>;
  for (const auto& [what, way] : Ways{{"view", {}},
                                      {"feel", {"t"}},
                                      {"smooth", {"s"}},
                                      {"mark", {"m"}},
                                      {"unmark", {"u"}},
                                      {"free", {"l"}},
                                      {"box", {"b"}}})
    add(
        "tool", what,
        [is = what](const State& s) { return s.value("tool", "") == is || s.value("lasso", "") == is; }, way);
  for (const auto& [what, way] :
       Ways{{"open", {"ctrl+o"}},
            {"import", {"ctrl+shift+o"}},
            {"compare", {"alt+b"}},
            {"join", {"alt+j"}},
            {"save as", {"ctrl+shift+s"}},
            {"export", {"ctrl+e"}},
            {"open scene", {"alt+o"}},
            {"save scene", {"alt+s"}},
            {"export sections", {"Home", "7", "over 40 40", "q", "over 60 60", "shift+q", "ctrl+shift+e"}},
            {"export report", {"alt+e"}},
            // Marked may be too few samples, or all but too few.
            {"export fits", {"ctrl+shift+f", "ctrl+i", "ctrl+shift+f", "alt+f"}},
            {"unsaved", {"ctrl+i", "drop " + folder.file("second.tif")}},
            {"replace", {"ctrl+e", "ctrl+a", "type " + folder.file("there.tif"), "Return"}},
            {"recover", {"drop " + folder.file("left.tif"), "Delete"}},
            {"device", {"ctrl+shift+d"}},
            {"shortcuts", {"F1"}},
            {"message", {"drop " + folder.file("broken.tif"), "Delete"}}})
    add(
        "dialog", what, [is = what](const State& s) { return s["dialog"] == is; }, way);
  for (const std::string& panel : namesOfPanels())
    add("panel", panel,
        [panel](const State& s) {
          const State open = s.value("panels", State::array());
          return std::find(open.begin(), open.end(), panel) != open.end();
        },
        {"panel " + panel, "panel " + panel, "panel " + panel});
  add("seen", "tools around the cursor",
      [](const State& s) { return s.value("radial", State()).is_string(); }, {"s", "space"});
  add("seen", "filters that are tried", [](const State& s) { return s.value("trying_filters", false); },
      {"ctrl+f"});
  add("seen", "a point of a plane",
      [](const State& s) { return s.value("plane_point", State()).is_number(); }, {"alt+d"});
  add("seen", "a fit", [](const State& s) { return s.value("fits", State()).is_object(); },
      {"ctrl+shift+f", "ctrl+i", "ctrl+shift+f"});
  add("seen", "full screen", [](const State& s) { return s["full_screen"] == true; }, {"F11"});
  add("seen", "the scan as it was", [](const State& s) { return s.value("shows_before", false); },
      {"hold BackSpace", "release BackSpace"});
  add("seen", "light panels", [](const State& s) { return s["light_panels"] == true; }, {"alt+g"});
  add("seen", "dark panels", [](const State& s) { return s["light_panels"] == false; }, {"alt+g"});
  return all;
}

class MonkeyTest : public WindowTest {
 protected:
  MonkeyTest() : WindowTest(Frames::kThroughVulkan) {}

  void SetUp() override {
    WindowTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    // What is typed without a folder goes here.
    before_ = fs::current_path();
    fs::current_path(folder.path());
    for (const std::string& copy : {second_, left_, fresh_, folder.file("there.tif")})
      fs::copy_file(scan, copy);
    std::ofstream(broken_) << "II*";
    // Work that was not saved, to be found again.
    const auto program = start({left_}, {}, AtRest::kSmooth);
    User user(display, *program, "left");
    (void)opened(*program);
    (void)user.key("ctrl+i");
    program->until("kept", [](const State& s) { return s["kept"] == true; });
    program->signal(SIGKILL);
    (void)program->wait();
    fs::copy(state_, kept_state_, fs::copy_options::recursive);
    for (Reach& r : reaches_)
      if (r.what == "recover") r.before = [this] { leaveWorkAgain(); };
  }
  void TearDown() override {
    if (!before_.empty()) fs::current_path(before_);
  }

  // Chance may have gone on with the work that was left, or written over its scan.
  void leaveWorkAgain() {
    fs::copy_file(scan, left_, fs::copy_options::overwrite_existing);
    fs::copy(kept_state_, state_, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }

  // A life of the program, from its start to where a frame waits. False: it has ended already.
  bool begin() {
    program_ = start({scan}, gate_.environment());
    ++lives_;
    program_->until("something to do", [](const State& s) {
      return s["settled"] == true && (s["path"] != "" || s["dialog"] == "recover");
    });
    return gate_.hold();
  }
  void end() {
    count();
    EXPECT_EQ(program_->wait(), 0) << program_->err();
    expectSilence(*program_);
    program_.reset();
    // It may have ended while no frame was held: the gate has not noticed then.
    gate_.disconnect();
  }
  // As a failure of power would.
  void kill() {
    if (!program_) return;
    count();
    program_->signal(SIGKILL);
    (void)program_->wait();
    program_.reset();
    gate_.disconnect();
  }
  void count() {
    program_->each([&](const State& s) {
      for (Reach& r : reaches_) r.times += r.is(s) ? 1 : 0;
      most_steps_ = std::max(most_steps_, s.value("last_step", std::int64_t{0}));
    });
  }
  [[nodiscard]] bool anywhereLeft() const {
    return std::ranges::any_of(reaches_, [](const Reach& r) { return r.times == 0; });
  }
  // May be none.
  [[nodiscard]] std::deque<std::string> wayToTheLeast(Monkey& monkey) {
    const Reach* least = nullptr;
    int ties = 0;
    for (const Reach& r : reaches_) {
      if (least == nullptr || r.times < least->times) ties = 0;
      if ((least == nullptr || r.times <= least->times) && monkey.below(++ties) == 0) least = &r;
    }
    // Once it has been everywhere it wanders: work that is left alone for a while makes a longer journal.
    if (least->times > 0 && monkey.below(6) > 0) return {};
    return {least->way.begin(), least->way.end()};
  }
  bool drop(const std::string& file) {
    gate_.release();
    (void)other.drop(other.windowOf("fettle"), {file});
    return gate_.hold();
  }
  // By Esc alone everything is left that is open; then a tool comes when it is asked for. False: the program
  // was about to end, and has.
  bool comesToRest() {
    gate_.release();
    User user(display, *program_, "monkey");
    try {
      user.at({20, height_ - 60});
      (void)user.press("Escape");  // the panels may have the keyboard, which is not reported
      for (int i = 1; !calm(user.rest()); ++i) {
        if (i == kMostEscapes) {
          State last = program_->now();
          last.erase("texts");
          ADD_FAILURE() << "Esc does not lead out of " << last.dump();
          break;
        }
        (void)user.press("Escape");
      }
      // A field, a dialog and the panels that have the keyboard are left one after the other.
      (void)user.press("Escape");
      (void)user.rest();
      if (program_->now().contains("tool")) {
        (void)user.press("s");
        program_->until("a tool", [](const State& s) { return s["tool"] == "smooth"; });
        // Figures that are still computed in the background end before the tool: of what runs, Esc ends the last one begun.
        (void)user.press("Escape");
        for (int i = 1; i < kMostEscapes && !calm(user.rest()); ++i) (void)user.press("Escape");
        program_->until("no tool", calm);
      }
    } catch (const std::runtime_error&) {
      if (!program_->ended()) throw;
      return false;
    }
    return true;
  }

  void play(std::int64_t actions, Monkey& monkey) {
    std::deque<std::string> errand;
    for (std::int64_t done = 0; done < actions;) {
      if (!program_ && !begin()) {
        end();
        continue;
      }
      if (errand.empty() && monkey.below(anywhereLeft() ? 2 : 3) == 0) errand = wayToTheLeast(monkey);
      if (monkey.below(60) == 0) other.askToClose(other.windowOf("fettle"));
      int things = 1;
      bool lives = true;
      if (errand.empty()) {
        things = static_cast<int>(std::min<std::int64_t>(monkey.actions(), actions - done));
        lives = doInAFrame(monkey, monkey.burst(things, program_->now()), "");
      } else {
        lives = step(monkey, errand.front());
        errand.pop_front();
      }
      done += things;
      most_ = std::max(most_, things);
      if (lives && frames_ % kProbe == kProbe - 1) {
        letGo(monkey);
        lives = comesToRest() && gate_.hold();
      }
      if (!lives) end();
    }
    letGo(monkey);
  }
  // Where chance did not lead it goes by itself: from rest the whole way, and waits there for what it began. Again where a header is
  // scrolled out of sight, which is found by some notches at a time.
  void goWhereChanceDidNotLead(Monkey& monkey) {
    constexpr int kTries = 10, kInPlace = 5, kFrames = 15;
    for (Reach& reach : reaches_)
      for (int tries = 0; reach.times == 0 && tries < kTries; ++tries) {
        if (reach.before) {
          kill();
          reach.before();
        }
        if (!program_ && !begin()) {
          end();
          continue;
        }
        bool lives = comesToRest() && gate_.hold();
        for (std::size_t i = 0; lives && i < reach.way.size(); ++i) {
          lives = step(monkey, reach.way[i]);
          // A dialog that follows takes no key before it stands in its place.
          const int rest = reach.way[i].starts_with("drop ") ? kInPlace : 0;
          for (int frame = 0; lives && frame < rest; ++frame) lives = doInAFrame(monkey, {}, "");
        }
        // A header below long panels takes more turns of the wheel than a way has.
        const bool turns = !reach.way.empty() && reach.way.back().starts_with("panel ");
        for (int i = 0; lives && reach.times == 0 && i < kFrames; ++i)
          lives = turns ? step(monkey, reach.way.back()) : doInAFrame(monkey, {}, "");
        letGo(monkey);
        if (!lives) end();
      }
  }
  // One step of a way, in a frame. False: the program has ended.
  bool step(Monkey& monkey, const std::string& what) {
    const std::string dropped = what.starts_with("drop ") ? what.substr(5) : "";
    return doInAFrame(monkey, monkey.step(what, program_->now()), dropped);
  }
  // The frame before waits to be shown: all of this comes to the next one. False: the program has ended.
  bool doInAFrame(Monkey& monkey, const std::vector<std::string>& words, const std::string& dropped) {
    if (!words.empty()) display.hands(words);
    if (++frames_ % kSlow == kSlow / 2) {
      std::this_thread::sleep_for(kDelay);
      ++slow_;
    }
    bool lives = gate_.step();
    if (lives && !dropped.empty()) lives = drop(dropped);
    // Some frames in which hands rest: a click is done when its button is seen to be up again.
    for (int rest = monkey.below(3); lives && rest > 0; --rest) lives = gate_.step();
    count();
    return lives;
  }
  // Of a button and of the key that an errand may hold.
  void letGo(Monkey& monkey) {
    std::vector<std::string> words = monkey.letGo();
    words.insert(words.end(), {"keyup", "BackSpace"});
    display.hands(words);
  }
  // One more step; how many there are then.
  std::int64_t invertMarks(User& user) const {
    const std::int64_t before = program_->now()["steps"];
    (void)user.press("ctrl+i");
    return program_->until(
        "a step", [&](const State& s) { return s["steps"] == before + 1 && s["settled"] == true; })["steps"];
  }
  void openFresh(std::uint32_t window) {
    EXPECT_EQ(other.drop(window, {fresh_}), "");
    program_->until("a fresh scan",
                    [&](const State& s) { return s["path"] == fresh_ && s["settled"] == true; });
  }
  // Marks of a field, from a file next to it if there is one.
  static std::int64_t marked(const std::string& field, const std::string& marks) {
    if (!fs::exists(marks)) return 0;
    auto with = engine::importMarks(load(field), marks);
    EXPECT_TRUE(with) << with.error().line();
    return with ? compare(*with, *with).marked : -1;
  }

  std::string second_ = folder.file("second.tif"), left_ = folder.file("left.tif");
  // What the program remembers, and how it was when work had been left.
  std::string state_ = folder.file("fettle"), kept_state_ = folder.file("kept_state");
  std::string fresh_ = folder.file("fresh.tif"), broken_ = folder.file("broken.tif");
  fs::path before_;
  FrameGate gate_{folder.file("gate")};
  std::unique_ptr<ViewProgram> program_;
  int lives_ = 0, most_ = 0;
  std::int64_t frames_ = 0, slow_ = 0;
  std::int64_t most_steps_ = 0;
  std::vector<Reach> reaches_ = reachesIn(folder);
};

TEST_F(MonkeyTest, hands_without_sense_leave_a_window_that_works_and_a_journal_that_plays_to_what_was_saved) {
  const std::int64_t actions = number("FETTLE_MONKEY_ACTIONS", 1000);
  const std::int64_t seed = number("FETTLE_MONKEY_SEED", 20261122);
  fmt::print("seed {} (FETTLE_MONKEY_SEED), {} actions (FETTLE_MONKEY_ACTIONS)\n", seed, actions);
  std::fflush(stdout);
  Monkey monkey(static_cast<std::uint64_t>(seed), width_, height_);
  play(actions, monkey);
  const auto left = std::ranges::count_if(reaches_, [](const Reach& reach) { return reach.times == 0; });
  goWhereChanceDidNotLead(monkey);

  // It works: all that is open can be left, ...
  while (!program_ || !comesToRest()) {
    if (program_) end();
    (void)begin();
  }
  count();
  User user(display, *program_, "after the monkey");
  const std::uint32_t window = other.windowOf("fettle");
  if (program_->now()["path"] == "") openFresh(window);
  // ... what was done is saved, with one more step, ...
  const std::string session = folder.file("monkey.fettle"), field = folder.file("monkey.tif");
  const std::int64_t steps = invertMarks(user);
  saveAs(user, session);
  (void)user.press("ctrl+e");
  program_->until("where to", [](const State& s) {
    return s["dialog"] == "export" && s["settled"] == true && s["text_field"] == true;
  });
  // As a person would: what stands there is chosen first.
  (void)user.key("ctrl+a");
  user.type(field);
  (void)user.press("Return");
  program_->until("written", [&](const State& s) { return s["status"] == "written: " + field; });
  // ... another scan is opened, a step of it undone, ...
  openFresh(window);
  EXPECT_EQ(program_->now()["steps"], 0);
  EXPECT_EQ(invertMarks(user), 1);
  EXPECT_EQ(user.key("ctrl+z")["steps"], 0);
  // ... and it quits.
  (void)quit(user);
  program_.reset();

  const std::string played = folder.file("played.tif"), marks = folder.file("played_marks.png");
  const Outcome replayed = runProcess({FETTLE_PROGRAM, "replay", session, played, "--marks-out", marks});
  if (const char* kept = std::getenv("FETTLE_WINDOW_SHOTS"); kept != nullptr && replayed.status != 0) {
    // What does not play to what was saved is to be looked at.
    fs::create_directories(kept);
    fs::copy_file(session, fs::path(kept) / fmt::format("monkey_{}.fettle", getpid()));
  }
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_EQ(compare(load(field), load(played)).changed, 0);
  EXPECT_EQ(marked(field, folder.file("monkey_marks.png")), marked(played, marks));

  fmt::print(
      "{} frames, {} held up for a second; at most {} things in one; {} lives; at most {} steps, {} played; "
      "chance left out {} of {} places\n",
      frames_, slow_, most_, lives_, most_steps_, steps, left, reaches_.size());
  for (const Reach& r : reaches_) fmt::print("  {:6} reported with {} {}\n", r.times, r.kind, r.what);
  std::fflush(stdout);
  for (const Reach& r : reaches_) EXPECT_GT(r.times, 0) << r.kind << " " << r.what;
  EXPECT_GE(slow_, 1);
}

}  // namespace
}  // namespace fettle::tests
