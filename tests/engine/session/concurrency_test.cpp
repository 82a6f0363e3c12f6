// What crosses between the main side, the writer's thread and a job that saves elsewhere.

#include <atomic>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

TEST(SessionConcurrency, WorkGoesOnWhileAJobSavesElsewhereAndAnotherReads) {
  // The thread sanitizer cannot see how the workers of the packaged oneTBB synchronise; what is looked at
  // here are the threads of the session, each of which then packs its tiles by itself.
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  const tests::TempFolder folder;
  JobControl job;
  Play play(31, 200, 150);
  SessionWriterOptions options;
  options.durability = Durability::kProgramDeath;
  options.checkpoint_bytes = 50000;
  auto writer = SessionWriter::create(play.session, folder.file("0.fettle"), options, job);
  ASSERT_TRUE(writer);
  std::atomic<bool> over{false};
  std::atomic<int> saved{0};
  std::thread saver([&] {
    JobControl saving;
    for (int k = 1; k <= 4; ++k) {
      const Status status =
          (*writer)->saveAs(folder.file(std::to_string(k) + ".fettle"), OriginalStorage::kEmbedded, saving);
      EXPECT_TRUE(status) << status.error().line();
      saved += status ? 1 : 0;
      EXPECT_TRUE((*writer)->flush(saving));
    }
    over = true;
  });
  std::thread reader([&] {
    JobControl reading;
    while (!over) {
      const auto session = openSession((*writer)->path(), {}, importField, reading);
      EXPECT_TRUE(session) << session.error().line();
    }
  });
  int actions = 0;
  while (!over || actions < 60) {
    play.act(writer->get());
    ++actions;
    EXPECT_FALSE((*writer)->status().error);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  saver.join();
  reader.join();
  EXPECT_EQ(saved, 4);
  ASSERT_TRUE((*writer)->close(job));
  const auto back = openSession(folder.file("4.fettle"), {}, importField, job);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(difference(play.session, *back, Compare::kWhole), "");
}

}  // namespace
}  // namespace fettle::engine
