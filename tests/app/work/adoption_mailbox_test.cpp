// A worker's questions to the live loop, answered by the main thread.
#include "app/work/adoption_mailbox.h"

#include <thread>

#include <gtest/gtest.h>

#include "tests/app/work/part.h"

namespace fettle::app {
namespace {

// As main does it: until the worker has asked.
haptic::LoopCommand nextCommand(AdoptionMailbox& mailbox, std::uint64_t& next_id) {
  for (;;) {
    if (auto command = mailbox.takeCommand(next_id)) return std::move(*command);
    std::this_thread::yield();
  }
}

TEST(AdoptionMailbox, an_offer_carries_the_id_of_the_snapshot_before_it) {
  AdoptionMailbox mailbox;
  const engine::Version live = tests::roughPart();
  bool adopted = false;
  std::thread worker([&] {
    const auto snapshot = mailbox.snapshot();
    ASSERT_TRUE(snapshot);
    const auto answer = mailbox.adopt(*snapshot);
    adopted = answer && answer->adopted && answer->version == live;
  });
  std::uint64_t next_id = 7;
  const haptic::LoopCommand question = nextCommand(mailbox, next_id);
  EXPECT_EQ(question.kind, haptic::CommandKind::kSnapshot);
  EXPECT_EQ(question.id, 7U);
  EXPECT_FALSE(mailbox.takeCommand(next_id)) << "asked once";
  mailbox.answer(live, false);
  const haptic::LoopCommand offer = nextCommand(mailbox, next_id);
  EXPECT_EQ(offer.kind, haptic::CommandKind::kAdopt);
  EXPECT_EQ(offer.id, 7U);
  EXPECT_TRUE(offer.version == live);
  EXPECT_EQ(next_id, 8U) << "other commands have ids of their own";
  mailbox.answer(live, true);
  worker.join();
  EXPECT_TRUE(adopted);
}

TEST(AdoptionMailbox, closing_releases_a_worker_that_waits_and_refuses_the_next) {
  AdoptionMailbox mailbox;
  engine::ErrorKind waiting{}, later{};
  std::thread worker([&] {
    const auto snapshot = mailbox.snapshot();
    if (!snapshot) waiting = snapshot.error().kind;
    const auto again = mailbox.snapshot();
    if (!again) later = again.error().kind;
  });
  std::uint64_t next_id = 1;
  static_cast<void>(nextCommand(mailbox, next_id));
  mailbox.close();
  worker.join();
  EXPECT_EQ(waiting, engine::ErrorKind::kCancelled);
  EXPECT_EQ(later, engine::ErrorKind::kCancelled);
  mailbox.answer(tests::roughPart(), false);  // too late: has no effect
  mailbox.open();
  std::thread next([&] { EXPECT_TRUE(mailbox.snapshot()); });
  static_cast<void>(nextCommand(mailbox, next_id));
  mailbox.answer(tests::roughPart(), false);
  next.join();
}

}  // namespace
}  // namespace fettle::app
