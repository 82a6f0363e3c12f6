#include "app/work/mark_edit.h"

#include <atomic>

#include "engine/marks/change_marks.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using haptic::Tool;
using tests::LoopClientBench;
using tests::markedSamples;

engine::Version plate() {
  return tests::fieldOf(
      130, 100, [](int c, int) { return 0.01 * (c % 3); }, 0.1, 0.1);
}

// A change that waits until it is let go.
struct Held {
  std::shared_ptr<std::atomic<bool>> begun = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<std::atomic<bool>> go = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<std::atomic<bool>> done = std::make_shared<std::atomic<bool>>(false);

  [[nodiscard]] MarkEdit::Change change() const {
    return [begun = begun, go = go, done = done](const engine::Version& base, engine::JobControl& job) {
      begun->store(true);
      begun->notify_all();
      go->wait(false);
      auto result = engine::invertMarks(base, job);
      done->store(true);
      return result;
    };
  }
  void letGo() const {
    go->store(true);
    go->notify_all();
  }
};

TEST(MarkEdit, changes_become_steps_in_the_order_they_were_asked_for) {
  LoopClientBench bench(plate());
  MarkEdit edit;
  EXPECT_FALSE(edit.busy());
  edit.ask("All", engine::invertMarks);
  edit.ask("None", engine::clearMarks);
  edit.ask("All again", engine::invertMarks);
  EXPECT_TRUE(edit.busy());
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  ASSERT_TRUE(bench.settled());
  const engine::History& history = bench.client().history();
  ASSERT_EQ(history.number(), 3);
  EXPECT_EQ(history.info(1).name, "All");
  EXPECT_EQ(history.info(2).name, "None");
  EXPECT_EQ(history.info(3).name, "All again");
  EXPECT_EQ(history.info(2).kind, engine::StepKind::kMark);
  EXPECT_EQ(markedSamples(bench.client().upright()), 130 * 100);
  bench.client().undo();
  ASSERT_TRUE(bench.settled());
  EXPECT_EQ(markedSamples(bench.client().upright()), 0);
  EXPECT_TRUE(bench.notices().empty());
}

TEST(MarkEdit, what_changes_nothing_is_no_step) {
  LoopClientBench bench(plate());
  MarkEdit edit;
  edit.ask("None", engine::clearMarks);
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  EXPECT_EQ(bench.client().history().last(), 0);
}

TEST(MarkEdit, cancelled_nothing_is_done_however_far_it_had_got) {
  for (const bool finished : {false, true}) {
    LoopClientBench bench(plate());
    MarkEdit edit;
    const Held held;
    edit.ask("All", held.change());
    edit.ask("All again", engine::invertMarks);
    (void)edit.poll(bench.client(), bench.noticesToFill());
    held.begun->wait(false);
    if (finished) {
      // Done, but nobody looked yet.
      held.letGo();
      ASSERT_TRUE(bench.until([&] { return held.done->load(); }));
    }
    edit.cancel();
    held.letGo();
    ASSERT_TRUE(bench.until([&] {
      (void)edit.poll(bench.client(), bench.noticesToFill());
      return !edit.busy();
    }));
    EXPECT_EQ(bench.client().history().last(), 0) << finished;
    EXPECT_EQ(markedSamples(bench.client().upright()), 0) << finished;
    EXPECT_TRUE(bench.notices().empty()) << finished;
  }
}

TEST(MarkEdit, the_newest_alone_is_cancelled) {
  LoopClientBench bench(plate());
  MarkEdit edit;
  EXPECT_FALSE(edit.cancelNewest());
  const Held held;
  edit.ask("All", held.change());
  (void)edit.poll(bench.client(), bench.noticesToFill());
  held.begun->wait(false);
  edit.ask("All again", engine::invertMarks);
  EXPECT_TRUE(edit.cancelNewest());
  held.letGo();
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  ASSERT_TRUE(bench.settled());
  EXPECT_EQ(bench.client().history().number(), 1);
  EXPECT_EQ(bench.client().history().info(1).name, "All");
  // The one that is worked out.
  const Held other;
  edit.ask("None", other.change());
  (void)edit.poll(bench.client(), bench.noticesToFill());
  EXPECT_TRUE(edit.cancelNewest());
  EXPECT_FALSE(edit.cancelNewest());
  other.letGo();
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  EXPECT_EQ(bench.client().history().number(), 1);
}

TEST(MarkEdit, a_stroke_made_meanwhile_is_kept) {
  LoopClientBench bench(plate());
  MarkEdit edit;
  const Held held;
  edit.ask("All", held.change());
  (void)edit.poll(bench.client(), bench.noticesToFill());
  held.begun->wait(false);
  ASSERT_TRUE(bench.stroke(Tool::kSmooth, {5.0, 5.0, 0.01}));
  const engine::Version smoothed = bench.client().history().current();
  held.letGo();
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  ASSERT_TRUE(bench.settled());
  EXPECT_EQ(bench.client().history().number(), 2);
  const engine::Version now = bench.client().upright();
  EXPECT_EQ(markedSamples(now), 130 * 100);
  for (std::int32_t r = 0; r < 100; ++r)
    for (std::int32_t c = 0; c < 130; ++c)
      ASSERT_EQ(now.reader().heightAt(c, r), smoothed.reader().heightAt(c, r)) << c << ' ' << r;
}

TEST(MarkEdit, what_cannot_be_done_is_said) {
  LoopClientBench bench(plate());
  MarkEdit edit;
  edit.ask("Nothing", [](const engine::Version&, engine::JobControl&) -> engine::Result<engine::Version> {
    return engine::failure("no memory", "marks", "close other programs");
  });
  ASSERT_TRUE(bench.until([&] {
    (void)edit.poll(bench.client(), bench.noticesToFill());
    return !edit.busy();
  }));
  ASSERT_EQ(bench.notices().size(), 1U);
  EXPECT_EQ(bench.notices().front().what, "no memory");
  EXPECT_EQ(bench.notices().front().remedy, "close other programs");
  EXPECT_EQ(bench.client().history().last(), 0);
}

}  // namespace
}  // namespace fettle::app
