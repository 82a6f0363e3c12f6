// Where sessions lie, and who else is there.

#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::TempFolder;

// The folder read-only, for root too, while this lives.
class ReadOnly {
 public:
  explicit ReadOnly(const fs::path& folder) : folder_(folder.string()) {
    done_ = mount(folder_.c_str(), folder_.c_str(), nullptr, MS_BIND, nullptr) == 0 &&
            mount(nullptr, folder_.c_str(), nullptr, MS_REMOUNT | MS_BIND | MS_RDONLY, nullptr) == 0;
  }
  ~ReadOnly() { umount2(folder_.c_str(), MNT_DETACH); }
  [[nodiscard]] bool done() const { return done_; }

 private:
  std::string folder_;
  bool done_ = false;
};

TEST(ReadOnlyFolder, ASessionThereIsReadButNotWrittenAndSavedElsewhere) {
  const TempFolder folder;
  const TempFolder elsewhere;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  Play play(3, 200, 150);
  for (int a = 0; a < 20; ++a) play.act(nullptr);
  ASSERT_TRUE(saveSession(play.session, path, job));
  const ReadOnly read_only(folder.path());
  if (!read_only.done()) GTEST_SKIP() << "mounting is not permitted";
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
  const auto writer = SessionWriter::open(path, {}, {}, importField, job);
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().kind, ErrorKind::kInput);
  EXPECT_NE(writer.error().line().find("Read-only file system"), std::string::npos) << writer.error().line();
  EXPECT_NE(writer.error().line().find("save the session elsewhere"), std::string::npos)
      << writer.error().line();
  const auto session = openSession(path, {}, importField, job);
  ASSERT_TRUE(session);
  EXPECT_FALSE(saveSession(*session, folder.file("b.fettle"), job));
  auto other = SessionWriter::create(*session, elsewhere.file("b.fettle"), {}, job);
  ASSERT_TRUE(other) << other.error().line();
  for (int a = 0; a < 5; ++a) play.act(other->get());
  ASSERT_TRUE((*other)->close(job));
  EXPECT_EQ(differenceOnDisk(play.session, elsewhere.file("b.fettle")), "");
}

TEST(ReadOnlyFolder, ALogThatACrashLeftIsReadTooWithoutBeingTouched) {
  const TempFolder folder;
  JobControl job;
  Play play(3, 200, 150);
  {
    const TempFolder work;
    auto writer = SessionWriter::create(play.session, work.file("a.fettle"), {}, job);
    ASSERT_TRUE(writer);
    for (int a = 0; a < 20; ++a) play.act(writer->get());
    ASSERT_TRUE((*writer)->flush(job));
    fs::copy_file(work.file("a.fettle"), folder.file("a.fettle"));
    fs::copy_file(work.file("a.fettle-wal"), folder.file("a.fettle-wal"));
  }
  const ReadOnly read_only(folder.path());
  if (!read_only.done()) GTEST_SKIP() << "mounting is not permitted";
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("a.fettle")), "");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(TwoPrograms, TheSecondLearnsWhoWorksOnTheSessionAndMayRead) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  Play play(3, 200, 150);
  auto writer = SessionWriter::create(play.session, path, {}, job);
  ASSERT_TRUE(writer);
  for (int a = 0; a < 10; ++a) play.act(writer->get());
  ASSERT_TRUE((*writer)->flush(job));
  // Really another program, for locks belong to processes.
  const auto inChild = [&](auto&& check) {
    const pid_t child = fork();
    if (child == 0) _exit(check() ? 0 : 1);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  };
  const std::string me = "process " + std::to_string(getpid()) + " is working on the session, " + path;
  EXPECT_TRUE(inChild([&] {
    const auto second = SessionWriter::open(path, {}, {}, importField, job);
    return !second && second.error().line().starts_with(me);
  }));
  EXPECT_TRUE(inChild([&] {
    const auto saved = saveSession(play.session, path, job);
    return !saved && saved.error().line().starts_with(me);
  }));
  const SessionStatus before = (*writer)->status();
  EXPECT_TRUE(inChild([&] { return differenceOnDisk(play.session, path).empty(); }));
  EXPECT_TRUE(fs::exists(path + "-wal")) << "a reader must not take the writer's log away";
  for (int a = 0; a < 10; ++a) play.act(writer->get());
  ASSERT_TRUE((*writer)->flush(job));
  EXPECT_GT((*writer)->status().committed, before.committed);
  EXPECT_TRUE(inChild([&] { return differenceOnDisk(play.session, path).empty(); }));
  // The same within one program.
  EXPECT_FALSE(SessionWriter::open(path, {}, {}, importField, job));
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
  ASSERT_TRUE((*writer)->close(job));
  EXPECT_TRUE(SessionWriter::open(path, {}, {}, importField, job));
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
}

TEST(TwoPrograms, ALockThatADeadProgramLeftMeansNothing) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  Play play(3, 100, 100);
  const pid_t child = fork();
  if (child == 0) {
    auto writer = SessionWriter::create(play.session, path, {}, job);
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ASSERT_TRUE(fs::exists(path + "-lock"));
  EXPECT_TRUE(SessionWriter::open(path, {}, {}, importField, job));
  EXPECT_FALSE(fs::exists(path + "-lock"));
}

TEST(Links, ASessionBehindALinkIsOneSession) {
  const TempFolder folder;
  const TempFolder other;
  JobControl job;
  Play play(3, 100, 100);
  auto writer = SessionWriter::create(play.session, folder.file("real.fettle"), {}, job);
  ASSERT_TRUE(writer);
  fs::create_symlink(folder.file("real.fettle"), other.file("link.fettle"));
  EXPECT_FALSE(SessionWriter::open(other.file("link.fettle"), {}, {}, importField, job));
  writer->reset();
  auto resumed = SessionWriter::open(other.file("link.fettle"), {}, {}, importField, job);
  ASSERT_TRUE(resumed) << resumed.error().line();
  for (int a = 0; a < 5; ++a) play.act(resumed->writer.get());
  ASSERT_TRUE(resumed->writer->close(job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("real.fettle")), "");
  EXPECT_TRUE(fs::is_symlink(other.file("link.fettle")));
}

TEST(Jobs, ACancelLeavesNothing) {
  const TempFolder folder;
  JobControl job;
  job.cancel();
  Play play(3, 300, 300);
  const auto saved = saveSession(play.session, folder.file("a.fettle"), job);
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 0);
}

}  // namespace
}  // namespace fettle::engine
