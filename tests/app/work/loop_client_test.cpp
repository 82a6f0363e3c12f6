// The live loop as the window sees it, with a simulated hand that gives force: armed and disarmed.
#include "app/work/loop_client.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "engine/field/mark_setter.h"
#include "haptic/loop/adopt_filtered.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using haptic::SafetyState;
using namespace std::chrono_literals;

constexpr auto kPatience = 30s;

bool givesForce(const haptic::LoopState& state) {
  return state.safety == SafetyState::kRamping || state.safety == SafetyState::kActive;
}

// The field with one more marked sample.
engine::Version withMark(const engine::Version& field, std::int32_t column, std::int32_t row) {
  engine::MarkSetter setter(field);
  const std::int32_t width = field.grid().width;
  std::vector<unsigned char> mask(static_cast<std::size_t>(width));
  for (std::int32_t r = field.grid().height - 1; r >= 0; --r) {
    field.reader().readMarks(0, r, width, 1, mask.data(), width);
    if (r == row) mask[static_cast<std::size_t>(column)] = 1;
    EXPECT_TRUE(setter.take(r, mask.data()));
  }
  return setter.result();
}

class LoopClientTest : public ::testing::Test {
 protected:
  // A hand that lands on a plate and lifts again, every second: one that is armed while it is deep inside
  // would feel nothing until it has come out.
  std::unique_ptr<LoopClient> start(const std::string& tool = "feel") {
    auto client = tryStart(tool, haptic::defaultScene(), false);
    if (!client) {
      ADD_FAILURE() << client.error().line();
      return nullptr;
    }
    return std::move(*client);
  }
  engine::Result<std::unique_ptr<LoopClient>> tryStart(const std::string& tool, const haptic::Scene& scene,
                                                       bool lower_scene) {
    const std::string strokes = folder_.file("strokes.csv");
    {
      std::ofstream out(strokes);
      out << "t,x,y,z,tool\n";
      for (int i = 0; i < 6000; ++i)
        out << 0.01 * i << ",5,5," << 0.2 + 0.4 * std::cos(0.0628 * i) << ',' << tool << '\n';
    }
    const engine::Version plate = tests::fieldOf(
        64, 64, [](int, int) { return 0.0; }, 0.2, 0.2);
    LoopClientOptions options;
    options.device = "hand:" + strokes;
    options.fitting = {.fits = false, .lowers = lower_scene};
    return LoopClient::start(engine::History(plate, std::size_t{1} << 20), plate, scene, options, nullptr);
  }
  // Goes round as the window does.
  static bool until(LoopClient& client, const std::function<bool(const haptic::LoopState&)>& is) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
      client.poll();
      if (is(client.state())) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  static void rounds(LoopClient& client, std::uint64_t ticks) {
    const std::uint64_t end = client.state().tick + ticks;
    EXPECT_TRUE(until(client, [&](const haptic::LoopState& s) { return s.tick >= end; }));
  }

  tests::TempFolder folder_;
};

TEST_F(LoopClientTest, who_disarmed_is_not_armed_again_by_the_program) {
  const auto client = start();
  ASSERT_TRUE(client);
  ASSERT_TRUE(until(*client, [](const auto& s) { return s.safety == SafetyState::kActive && s.contact; }))
      << "a simulated hand arms itself";
  client->disarm();
  rounds(*client, 2);  // the tick under way may not have seen it
  // Longer than the program waits between two tries to arm by itself.
  for (int i = 0; i < 30; ++i) {
    rounds(*client, 10);
    ASSERT_EQ(client->state().safety, SafetyState::kUncalibrated) << i;
  }
  EXPECT_EQ(client->state().given_n, glm::dvec3(0.0));
  client->arm();
  EXPECT_TRUE(until(*client, givesForce));
}

TEST_F(LoopClientTest, arming_and_disarming_at_once_leaves_it_disarmed) {
  const auto client = start();
  ASSERT_TRUE(client);
  ASSERT_TRUE(until(*client, givesForce));
  for (int i = 0; i < 50; ++i) {
    client->arm();
    client->disarm();
    rounds(*client, 3);
    ASSERT_EQ(client->state().safety, SafetyState::kUncalibrated) << i;
    client->disarm();
    client->arm();
    ASSERT_TRUE(until(*client, [](const auto& s) { return s.safety != SafetyState::kUncalibrated; })) << i;
  }
}

// The field, the step under way and who is armed outlive the loop.
TEST_F(LoopClientTest, another_rate_begins_without_force_and_loses_nothing) {
  const auto client = start("mark");
  ASSERT_TRUE(client);
  ASSERT_TRUE(until(*client, [](const auto& s) { return givesForce(s) && s.stroke > 0; }));
  const haptic::LoopState before = client->state();
  const engine::Status set = client->setRate(4000.0);
  ASSERT_TRUE(set) << set.error().line();
  EXPECT_EQ(client->rate(), 4000.0);
  EXPECT_FALSE(client->finished());
  EXPECT_FALSE(givesForce(client->state())) << "of the new loop's first ticks";
  EXPECT_LT(client->state().tick, before.tick);
  const std::int64_t steps = client->history().number();
  EXPECT_GE(steps, 1) << "the stroke under way became a step";
  EXPECT_TRUE(client->upright() == client->history().current());
  // The simulated hand is armed by itself again, as at its start, and works on where it was.
  ASSERT_TRUE(until(*client, givesForce));
  ASSERT_TRUE(until(*client, [&](const auto&) { return client->measuredRate() > 2000.0; }));
  EXPECT_EQ(client->timing().lateness.figures().count > 0, true);
  client->undo();
  ASSERT_TRUE(until(*client, [&](const auto&) { return client->upright() == client->history().current(); }));
  // Who disarmed stays disarmed.
  client->disarm();
  ASSERT_TRUE(client->setRate(1000.0));
  rounds(*client, 500);
  EXPECT_EQ(client->state().safety, SafetyState::kUncalibrated);
  // Out of range nothing happens.
  EXPECT_FALSE(client->setRate(999.0));
  EXPECT_FALSE(client->setRate(10001.0));
  EXPECT_EQ(client->rate(), 1000.0);
  EXPECT_EQ(client->state().link, haptic::LinkState::kConnected);
}

// A worker offers a filter's result while a person undoes: the loop takes both within some ticks. Whatever the order, the
// history's state is the field, and nothing is left that only one of them has.
TEST_F(LoopClientTest, an_undo_while_an_offer_is_unanswered_leaves_history_and_field_alike) {
  const auto client = start();
  ASSERT_TRUE(client);
  const engine::Version plain = client->upright();
  const auto agree = [&](const auto&) { return client->upright() == client->history().current(); };
  for (int trial = 0; trial < 40; ++trial) {
    const engine::Version field = client->upright();
    ASSERT_TRUE(client->change(field, withMark(field, trial, 1), "Marks"));
    ASSERT_TRUE(until(*client, agree));
    client->noteFilterBegun(client->noteFilterBase(), {}, "Filter");
    std::atomic<bool> offers{false}, done{false};
    std::thread worker([&] {
      const auto live = client->port().snapshot();
      if (live) {
        const engine::Version filtered = withMark(*live, trial, 9);
        offers = true;
        static_cast<void>(client->port().adopt(filtered));
      }
      offers = done = true;
    });
    while (!offers) client->poll();
    for (int k = 0; k < 200 * (trial % 8); ++k) std::this_thread::yield();
    client->undo();
    EXPECT_TRUE(until(*client, [&](const auto&) { return done.load(); }));
    client->closePort();
    worker.join();
    client->allowPort();
    rounds(*client, 5);
    ASSERT_TRUE(until(*client, agree)) << trial;
    const std::int64_t last = client->history().number();
    for (std::int64_t state = 0; state <= last; ++state) {
      client->goTo(state);
      ASSERT_TRUE(until(*client, agree)) << trial << ", state " << state;
    }
    client->goTo(0);
    ASSERT_TRUE(until(*client, agree));
    EXPECT_TRUE(client->upright() == plain);
  }
}

// As a window of one sample does: its result has the field's tiles below a root of its own.
TEST_F(LoopClientTest, a_filter_that_changes_nothing_is_no_step_and_takes_none_away) {
  const auto client = start();
  ASSERT_TRUE(client);
  const auto agree = [&](const auto&) { return client->upright() == client->history().current(); };
  ASSERT_TRUE(client->change(client->upright(), withMark(client->upright(), 3, 1), "Marks"));
  ASSERT_TRUE(until(*client, agree));
  const engine::Version marked = client->upright();
  client->noteFilterBegun(client->noteFilterBase(), {}, "Filter");
  const auto offer = [&](bool changes) {
    std::atomic<bool> done{false};
    std::thread worker([&] {
      if (const auto live = client->port().snapshot()) {
        // The marks as they were, in the tiles as they were.
        const auto same = haptic::mergeResult(*live, *live, *live);
        ASSERT_TRUE(same);
        const auto answer = client->port().adopt(changes ? withMark(*live, 5, 5) : same->version);
        EXPECT_TRUE(answer && answer->adopted);
      }
      done = true;
    });
    EXPECT_TRUE(until(*client, [&](const auto&) { return done.load(); }));
    worker.join();
  };
  offer(false);
  EXPECT_TRUE(until(*client, agree)) << "nothing is left to wait for";
  EXPECT_EQ(client->history().number(), 1);
  // The next round of the same adoption is a step of its own.
  offer(true);
  EXPECT_TRUE(until(*client, agree));
  EXPECT_EQ(client->history().number(), 2);
  client->undo();
  EXPECT_TRUE(until(*client, agree));
  EXPECT_TRUE(client->upright().reader().markedAt(3, 1)) << "the step before the filter is still there";
  EXPECT_TRUE(engine::sameHeights(client->upright(), marked));
}

TEST_F(LoopClientTest, a_stiffness_that_the_hand_does_not_hold_is_refused_with_the_largest_that_it_does) {
  const auto client = start();
  ASSERT_TRUE(client);
  ASSERT_TRUE(until(*client, givesForce));
  EXPECT_EQ(client->largestStiffness(), 6.0);
  for (const double typed : {99999.0, 1000.0, 6.01}) {
    haptic::Scene scene = client->scene();
    scene.stiffness_n_per_mm = typed;
    const engine::Status refused = client->setScene(scene);
    ASSERT_FALSE(refused) << typed;
    EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
    EXPECT_NE(refused.error().line().find("at most 6 N/mm"), std::string::npos) << refused.error().line();
    EXPECT_EQ(client->scene(), haptic::defaultScene()) << "as before";
  }
  haptic::Scene scene = client->scene();
  scene.stiffness_n_per_mm = -1.0;
  EXPECT_FALSE(client->setScene(scene)) << "out of range";
  // Twice as many ticks hold twice as much, and with that there is no way back.
  ASSERT_TRUE(client->setRate(2000.0));
  EXPECT_EQ(client->largestStiffness(), 12.0);
  scene.stiffness_n_per_mm = 10.0;
  ASSERT_TRUE(client->setScene(scene));
  const engine::Status back = client->setRate(1000.0);
  ASSERT_FALSE(back);
  EXPECT_NE(back.error().line().find("at most 6 N/mm"), std::string::npos) << back.error().line();
  EXPECT_EQ(client->rate(), 2000.0);
  EXPECT_FALSE(client->finished());
  EXPECT_TRUE(until(*client, givesForce)) << "the loop runs on";
  scene.stiffness_n_per_mm = 6.0;
  ASSERT_TRUE(client->setScene(scene));
  EXPECT_TRUE(client->setRate(1000.0));
}

// Another device than the scene was made with.
TEST_F(LoopClientTest, a_scene_too_stiff_to_begin_with_is_refused_or_lowered_with_a_notice) {
  haptic::Scene scene;
  scene.stiffness_n_per_mm = 40.0;
  const auto refused = tryStart("feel", scene, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
  EXPECT_NE(refused.error().line().find("at most 6 N/mm"), std::string::npos) << refused.error().line();
  const auto lowered = tryStart("feel", scene, true);
  ASSERT_TRUE(lowered) << lowered.error().line();
  EXPECT_EQ((*lowered)->scene().stiffness_n_per_mm, 6.0);
  const std::vector<Notice> notices = (*lowered)->takeNotices();
  EXPECT_TRUE(std::any_of(notices.begin(), notices.end(), [](const Notice& n) {
    return n.what.find("40 N/mm") != std::string::npos &&
           n.remedy.find("at most 6 N/mm") != std::string::npos;
  }));
}

}  // namespace
}  // namespace fettle::app
