// A session that refers to its scan, and what may become of the scan's file.

#include <filesystem>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "engine/session/session_scan.h"
#include "engine/session/session_writer.h"
#include "tests/engine/session/play.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::TempFolder;

class ReferredScan : public testing::Test {
 protected:
  ReferredScan() {
    EXPECT_TRUE(exportField(play.session.original, scan, {}, job));
    take({}, scan);
  }
  // The play continues with what a file holds.
  void take(const ImportOptions& options, const std::string& file) {
    const auto stamp = fileStamp(file);
    const auto imported = importField(file, options, job);
    ASSERT_TRUE(imported) << imported.error().line();
    play.session.original = imported->field;
    play.session.history = History(imported->field);
    play.session.scan = {file, options, imported->format, stamp};
    play.session.storage = OriginalStorage::kReferenced;
  }
  void replaceScan() { ASSERT_TRUE(exportField(strangeField(77, 200, 150), scan, {}, job)); }

  TempFolder folder;
  JobControl job;
  std::string scan = folder.file("scan.tif"), path = folder.file("a.fettle");
  Play play{4, 200, 150};
};

TEST_F(ReferredScan, IsEmbeddedWhereItsFileIsNoLongerTheOneThatWasRead) {
  for (int a = 0; a < 6; ++a) play.act(nullptr);
  ASSERT_TRUE(saveSession(play.session, path, job));
  EXPECT_EQ(sessionFacts(path)->storage, OriginalStorage::kReferenced);
  auto open = SessionWriter::open(path, {}, {}, importField, job);
  ASSERT_TRUE(open);
  replaceScan();
  ASSERT_TRUE(saveSession(play.session, folder.file("b.fettle"), job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("b.fettle")), "");
  // A session that is worked on goes elsewhere with its scan, too.
  ASSERT_TRUE(open->writer->saveAs(folder.file("c.fettle"), OriginalStorage::kReferenced, job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("c.fettle")), "");
  fs::remove(scan);
  ASSERT_TRUE(saveSession(play.session, folder.file("d.fettle"), job));
  EXPECT_EQ(differenceOnDisk(play.session, folder.file("d.fettle")), "");
}

TEST_F(ReferredScan, IsEmbeddedWhereTheSessionCouldNotImportItAgain) {
  const std::string depth = folder.file("depth.tif");
  ASSERT_TRUE(exportField(strangeField(5, 60, 40), depth, {}, job));
  ImportOptions camera;
  camera.depth_camera = DepthCamera{500.0, 500.0, 29.5, 19.5};
  take(camera, depth);
  ASSERT_TRUE(saveSession(play.session, path, job));
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
}

TEST_F(ReferredScan, IsPutIntoASessionBeforeItsFileIsReplaced) {
  for (int a = 0; a < 6; ++a) play.act(nullptr);
  ASSERT_TRUE(saveSession(play.session, path, job));
  auto facts = sessionFacts(path);
  ASSERT_TRUE(facts) << facts.error().line();
  EXPECT_EQ(facts->storage, OriginalStorage::kReferenced);
  EXPECT_EQ(facts->steps, play.session.history.last());
  EXPECT_EQ(facts->journal_entries, 6);
  EXPECT_TRUE(needsFile(*facts, scan));
  const std::string copy = folder.file("copy.tif");
  fs::copy_file(scan, copy);
  EXPECT_FALSE(needsFile(*facts, copy));
  {
    // Not while another program writes to it.
    const auto other = SessionWriter::open(path, {}, {}, importField, job);
    ASSERT_TRUE(other);
    const auto refused = embedScan(path, importField, job);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  }
  ASSERT_TRUE(embedScan(path, importField, job));
  ASSERT_TRUE(embedScan(path, importField, job));  // again is nothing
  facts = sessionFacts(path);
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->storage, OriginalStorage::kEmbedded);
  EXPECT_FALSE(needsFile(*facts, scan));
  replaceScan();
  EXPECT_EQ(differenceOnDisk(play.session, path), "");
}

}  // namespace
}  // namespace fettle::engine
