// Files that are no session, not of this program, or not what was written.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "engine/field/nominal_form.h"
#include "engine/formats/formats.h"
#include "engine/session/session_writer.h"
#include "engine/session/tables.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::bytesOf;
using tests::TempFolder;

void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void runSql(const std::string& path, const std::string& sql) {
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &handle), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(handle);
  sqlite3_close(handle);
}

Play somePlay(std::uint64_t seed = 9) {
  Play play(seed, 200, 150);
  for (int a = 0; a < 25; ++a) play.act(nullptr);
  return play;
}

// Refused in one line that names the file and what to do, by every way in.
void expectRefused(const std::string& path, const std::string& reason) {
  JobControl job;
  const auto check = [&](const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kInput);
    EXPECT_NE(error.line().find(reason), std::string::npos) << error.line();
    EXPECT_EQ(error.where, path);
    EXPECT_FALSE(error.remedy.empty()) << error.line();
    EXPECT_EQ(error.line().find('\n'), std::string::npos);
  };
  const auto opened = openSession(path, {}, importField, job);
  ASSERT_FALSE(opened);
  check(opened.error());
  const auto resumed = SessionWriter::open(path, {}, {}, importField, job);
  ASSERT_FALSE(resumed);
  check(resumed.error());
  EXPECT_FALSE(fs::exists(path + "-lock"));
  const auto imported = importField(path, {}, job);
  ASSERT_FALSE(imported);
}

TEST(NoSession, OtherFilesAreRefusedByName) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  writeBytes(path,
             "just text, long enough to be looked at as a header of something else entirely, and then some");
  expectRefused(path, "not a Fettle session");
  writeBytes(path, std::string(100000, '\0'));
  expectRefused(path, "not a Fettle session");
  fs::remove(path);
  runSql(path, "CREATE TABLE t(x); INSERT INTO t VALUES(1);");
  expectRefused(path, "not a Fettle session");
  JobControl job;
  for (const std::string& other :
       {folder.file("none.fettle"), folder.path().string(), std::string("/dev/null")})
    EXPECT_FALSE(openSession(other, {}, importField, job)) << other;
  writeBytes(path, "");
  const auto empty = openSession(path, {}, importField, job);
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().line().find("empty"), std::string::npos);
  EXPECT_EQ(fs::file_size(path), 0U);  // it was not made a database
}

TEST(NoSession, ANewerFormatSaysToUpdate) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  ASSERT_TRUE(saveSession(somePlay().session, path, job));
  runSql(path, fmt::format("PRAGMA user_version={}", kSessionFormat + 1));
  expectRefused(path, fmt::format("written by a newer Fettle (format {}, supported up to {})",
                                  kSessionFormat + 1, kSessionFormat));
}

TEST(Damage, LinesThatWereChangedAreNoticed) {
  const TempFolder folder;
  JobControl job;
  Session session;
  session.original = strangeField(4, 100, 80);
  session.scan.format = "none";
  session.history = History(session.original);
  EdgeLine line;
  line.points.resize(50);
  for (int k = 0; k < 2; ++k) {
    line.id = k;
    session.history.push({"Edge line", StepKind::kLines, {}, {}, 0},
                         session.original.withLines(std::make_shared<const std::vector<EdgeLine>>(1, line)));
  }
  for (const auto& [sql, reason] :
       {std::pair("DELETE FROM lines WHERE step=2", "the set of lines of step 2 is missing"),
        {"UPDATE lines SET step=7 WHERE step=2", "the set of lines of step 7 does not fit"},
        {"UPDATE lines SET data=x'00' WHERE step=1", "the set of lines of step 1 does not fit"},
        {"UPDATE lines SET data=(SELECT data FROM lines WHERE step=2) WHERE step=1", "step 1 does not fit"},
        {"UPDATE lines SET checksum=checksum+1 WHERE step=2", "step 2 does not fit"},
        {"PRAGMA user_version=1", "the set of lines of step 1 is missing"}}) {
    const std::string path = folder.file("a.fettle");
    ASSERT_TRUE(saveSession(session, path, job));
    runSql(path, sql);
    expectRefused(path, reason);
    fs::remove(path);
  }
}

TEST(Damage, FormsThatWereChangedAreNoticed) {
  const TempFolder folder;
  JobControl job;
  Session session;
  session.original = strangeField(4, 100, 80);
  session.scan.format = "none";
  session.history = History(session.original);
  for (const double base : {1.0, 2.0})
    session.history.push({"Form", StepKind::kForm, {}, {}, 0},
                         session.original.withForm(
                             std::make_shared<const NominalForm>(PolynomialForm{0, 100, 80, base, {0.0}})));
  for (const auto& [sql, reason] :
       {std::pair("DELETE FROM forms WHERE step=2", "the form of step 2 is missing"),
        {"UPDATE forms SET step=7 WHERE step=2", "the form of step 7 does not fit"},
        {"UPDATE forms SET data=x'00' WHERE step=1", "the form of step 1 does not fit"},
        {"UPDATE forms SET checksum=checksum+1 WHERE step=2", "step 2 does not fit"},
        {"PRAGMA user_version=2", "the form of step 1 is missing"}}) {
    const std::string path = folder.file("a.fettle");
    ASSERT_TRUE(saveSession(session, path, job));
    runSql(path, sql);
    expectRefused(path, reason);
    fs::remove(path);
  }
}

TEST(Damage, RowsThatWereChangedAreNoticed) {
  const TempFolder folder;
  const Play play = somePlay();
  JobControl job;
  for (const char* sql : {"UPDATE head SET state=state-1",
                          "UPDATE head SET journal=journal+1",
                          "UPDATE grid SET spacing_x=0.2",
                          "UPDATE grid SET crs_wkt='x'",
                          "UPDATE step SET name='x' WHERE number=2",
                          "UPDATE step SET sign=-sign WHERE number=1",
                          "UPDATE tile SET position=position+100 WHERE id=2",
                          "UPDATE tile SET data=(SELECT data FROM tile WHERE id=3) WHERE id=2",
                          "DELETE FROM tile WHERE id=2",
                          "DELETE FROM step WHERE number=2",
                          "DELETE FROM step WHERE number=(SELECT max(number) FROM step)",
                          "DELETE FROM journal WHERE id=(SELECT max(id) FROM journal)",
                          "UPDATE journal SET action='{}' WHERE id=1",
                          "DELETE FROM note",
                          "UPDATE note SET text='x'",
                          "DELETE FROM head",
                          "DELETE FROM grid",
                          "DELETE FROM original",
                          "UPDATE original SET storage='referenced'",
                          "DROP TABLE tile",
                          "DROP INDEX tile_place",
                          "DROP TABLE note",
                          "UPDATE tile SET step=0 WHERE step=1"}) {
    const std::string path = folder.file("a.fettle");
    ASSERT_FALSE(play.session.notes.empty());
    ASSERT_TRUE(saveSession(play.session, path, job));
    runSql(path, sql);
    const auto session = openSession(path, {}, importField, job);
    ASSERT_FALSE(session) << sql;
    EXPECT_NE(session.error().line().find("damaged"), std::string::npos)
        << sql << ": " << session.error().line();
  }
}

TEST(Damage, AFlippedBitAnywhereIsNoticedOrChangesNothing) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  const Play play = somePlay();
  JobControl job;
  ASSERT_TRUE(saveSession(play.session, path, job));
  const std::string bytes = bytesOf(path);
  std::mt19937_64 random(4);
  int noticed = 0;
  int harmless = 0;
  for (int k = 0; k < 400; ++k) {
    std::string bad = bytes;
    // Every second one in the first pages, where the schema and the small tables are.
    const std::size_t at =
        random() % (k % 2 == 0 ? std::min<std::size_t>(bytes.size(), 60000) : bytes.size());
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    writeBytes(path, bad);
    const auto session = openSession(path, {}, importField, job);
    if (!session) {
      ++noticed;
      EXPECT_FALSE(session.error().line().empty());
    } else {
      ++harmless;
      EXPECT_EQ(difference(play.session, *session, Compare::kWhole), "") << "byte " << at;
    }
    for (const char* suffix : {"-wal", "-shm", "-journal"}) fs::remove(path + suffix);
  }
  fmt::print("{} flipped bits noticed, {} harmless\n", noticed, harmless);
  EXPECT_GT(noticed, 200);
}

TEST(Damage, AFileCutShortIsNoticedWhereverItEnds) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  JobControl job;
  ASSERT_TRUE(saveSession(somePlay().session, path, job));
  const std::string bytes = bytesOf(path);
  for (std::size_t size = 1; size < bytes.size(); size += 1 + bytes.size() / 97) {
    writeBytes(path, bytes.substr(0, size));
    const auto session = openSession(path, {}, importField, job);
    ASSERT_FALSE(session) << size;
    EXPECT_EQ(session.error().kind, ErrorKind::kInput) << session.error().line();
  }
}

TEST(Damage, APageOfZerosOrNoiseIsNoticedOrUnused) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  const Play play = somePlay();
  JobControl job;
  ASSERT_TRUE(saveSession(play.session, path, job));
  const std::string bytes = bytesOf(path);
  std::mt19937_64 random(5);
  for (std::size_t page = 0; page < bytes.size() / 4096; page += 1 + bytes.size() / 4096 / 60)
    for (const bool zeros : {true, false}) {
      std::string bad = bytes;
      for (std::size_t i = 0; i < 4096; ++i)
        bad[page * 4096 + i] = zeros ? '\0' : static_cast<char>(random());
      writeBytes(path, bad);
      const auto session = openSession(path, {}, importField, job);
      EXPECT_EQ(session ? difference(play.session, *session, Compare::kWhole) : "", "") << "page " << page;
      EXPECT_FALSE(verifySession(path, job)) << "page " << page;
    }
}

TEST(Damage, ALogCutShortLosesOnlyItsLastActions) {
  const TempFolder folder;
  const std::string path = folder.file("a.fettle");
  const std::string copy = folder.file("b.fettle");
  JobControl job;
  Play play(6, 200, 150);
  SessionWriterOptions options;
  options.checkpoint_bytes = std::size_t{1} << 30;
  auto writer = SessionWriter::create(play.session, path, options, job);
  ASSERT_TRUE(writer);
  for (int a = 0; a < 20; ++a) play.act(writer->get());
  ASSERT_TRUE((*writer)->flush(job));
  const std::string file = bytesOf(path);
  const std::string log = bytesOf(path + "-wal");
  std::size_t least = 20;
  for (std::size_t size = 0; size <= log.size(); size += 1 + log.size() / 37) {
    writeBytes(copy, file);
    writeBytes(copy + "-wal", log.substr(0, size));
    fs::remove(copy + "-shm");
    const auto session = openSession(copy, {}, importField, job);
    ASSERT_TRUE(session) << session.error().line();
    Play replay(6, 200, 150);
    while (replay.session.journal.size() < session->journal.size()) replay.act(nullptr);
    EXPECT_EQ(difference(replay.session, *session, Compare::kWhole), "") << size;
    least = std::min(least, session->journal.size());
  }
  EXPECT_EQ(least, 0U);
}

}  // namespace
}  // namespace fettle::engine
