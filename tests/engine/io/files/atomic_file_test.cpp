#include "engine/io/files/atomic_file.h"
#include "engine/formats/formats.h"

#include <csignal>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/io/raster/marks.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

namespace fs = std::filesystem;
using tests::TempFolder;

std::size_t filesIn(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Heights that no compression makes small.
Version roughField(int side) {
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  std::uint32_t state = 1;
  for (int i = 0; i < side * side; ++i) {
    state = state * 1664525U + 1013904223U;
    z.push_back(static_cast<float>(state) * 1e-3F);
    marks.push_back(static_cast<std::uint8_t>(state >> 30 & 1U));
  }
  return makeField(gridOf(side, side), z, marks);
}

// Every writer refuses with one clear line, and leaves the folder as it was.
void expectEveryWriterRefuses(const Version& field, const fs::path& folder, const std::string& reason) {
  const std::size_t before = filesIn(folder);
  // Formats that write themselves, and those that libraries write: GDAL, libtiff, OpenEXR, libarchive,
  // SQLite.
  for (const char* name :
       {"a.tif", "cog.tif", "a.asc", "a.xyz", "a.ply", "a.png", "a.exr", "a.x3p", "a.stl", "a.fettle"}) {
    ExportOptions options;
    options.cloud_optimised = std::string(name) == "cog.tif";
    const auto written = save(field, (folder / name).string(), options);
    ASSERT_FALSE(written) << name;
    EXPECT_EQ(written.error().kind, ErrorKind::kFailed) << name << ": " << written.error().line();
    EXPECT_NE(written.error().what.find("the disk is full"), std::string::npos)
        << name << ": " << written.error().line();
    EXPECT_NE(written.error().line().find(reason), std::string::npos)
        << name << ": " << written.error().line();
    EXPECT_NE(written.error().line().find((folder / name).string()), std::string::npos)
        << written.error().line();
    EXPECT_EQ(written.error().line().find(".fettle-"), std::string::npos) << written.error().line();
    EXPECT_EQ(written.error().line().find('\n'), std::string::npos);
    EXPECT_EQ(filesIn(folder), before) << name;
  }
}

TEST(AtomicFile, ContentAppearsWholeAndTheTemporaryIsGone) {
  const TempFolder folder;
  ASSERT_TRUE(writeFileAtomically(folder.file("a.txt"), "hello"));
  EXPECT_EQ(readBytes(folder.file("a.txt")), "hello");
  EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(AtomicFile, DroppedWithoutCommitLeavesWhatWasThere) {
  const TempFolder folder;
  writeBytes(folder.file("a.txt"), "old");
  {
    auto file = AtomicFile::create(folder.file("a.txt"));
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write("new"));
    EXPECT_EQ(fs::path(file->temporaryPath()).extension(), ".txt");
    EXPECT_EQ(fs::path(file->temporaryPath()).parent_path(), folder.path());
    EXPECT_EQ(readBytes(folder.file("a.txt")), "old");
  }
  EXPECT_EQ(readBytes(folder.file("a.txt")), "old");
  EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(AtomicFile, ReplacingKeepsPermissionsAndFollowsLinks) {
  const TempFolder folder;
  writeBytes(folder.file("real.txt"), "old");
  ASSERT_EQ(chmod(folder.file("real.txt").c_str(), 0640), 0);
  fs::create_symlink("real.txt", folder.file("link.txt"));
  ASSERT_TRUE(writeFileAtomically(folder.file("link.txt"), "new"));
  EXPECT_TRUE(fs::is_symlink(folder.file("link.txt")));
  EXPECT_EQ(readBytes(folder.file("real.txt")), "new");
  EXPECT_EQ(fs::status(folder.file("real.txt")).permissions(), fs::perms{0640});
}

TEST(AtomicFile, AFinishedFileReplacesAnotherAsOneThatIsWritten) {
  const TempFolder folder;
  fs::create_directory(folder.file("other"));
  // A link to another disk: a rename does not reach it.
  const bool two_disks = mount("tmpfs", folder.file("other").c_str(), "tmpfs", 0, "size=64k") == 0;
  fs::create_symlink("other/real.txt", folder.file("link.txt"));
  for (const char* content : {"first", "second"}) {
    writeBytes(folder.file("finished"), content);
    const Status status = replaceFile(folder.file("finished"), folder.file("link.txt"));
    ASSERT_TRUE(status) << status.error().line();
    EXPECT_TRUE(fs::is_symlink(folder.file("link.txt")));
    EXPECT_EQ(readBytes(folder.file("other/real.txt")), content);
    EXPECT_FALSE(fs::exists(folder.file("finished")));
    if (std::string(content) == "second") {
      EXPECT_EQ(fs::status(folder.file("other/real.txt")).permissions(), fs::perms{0640});
    }
    ASSERT_EQ(chmod(folder.file("other/real.txt").c_str(), 0640), 0);
  }
  // What cannot be replaced stays, and the finished file with it.
  writeBytes(folder.file("finished"), std::string(100'000, 'x'));
  const Status refused =
      replaceFile(folder.file("finished"), two_disks ? folder.file("link.txt") : "/dev/full");
  ASSERT_FALSE(refused);
  EXPECT_EQ(readBytes(folder.file("other/real.txt")), "second");
  EXPECT_EQ(filesIn(folder.file("other")), 1U);
  EXPECT_TRUE(fs::exists(folder.file("finished")));
  if (two_disks) umount(folder.file("other").c_str());
}

// What several users of a group made together, one of them puts in its place.
TEST(AtomicFile, AFinishedFileOfAnotherUserReplacesOne) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can make files of others";
  constexpr uid_t kNobody = 65534;
  const TempFolder folder;
  ASSERT_EQ(chmod(folder.path().c_str(), 0777), 0);
  const std::string finished = folder.file("finished"), real = folder.file("real.txt");
  for (const mode_t mode : {0666U, 0640U}) {
    writeBytes(finished, "new");
    writeBytes(real, "old");
    ASSERT_EQ(chmod(finished.c_str(), 0666), 0);
    ASSERT_EQ(chmod(real.c_str(), mode), 0);
    ASSERT_EQ(chown(real.c_str(), kNobody, static_cast<gid_t>(-1)), 0);
    ASSERT_EQ(seteuid(kNobody), 0);
    const Status status = replaceFile(finished, real);
    ASSERT_EQ(seteuid(0), 0);
    ASSERT_TRUE(status) << status.error().line();
    EXPECT_EQ(readBytes(real), "new");
    EXPECT_EQ(fs::status(real).permissions(), fs::perms{mode});
    EXPECT_FALSE(fs::exists(finished));
  }
}

TEST(AtomicFile, ALongNameAndNoExtensionWork) {
  const TempFolder folder;
  const std::string name(255, 'x');
  ASSERT_TRUE(writeFileAtomically(folder.file(name), "x"));
  EXPECT_EQ(readBytes(folder.file(name)), "x");
}

TEST(AtomicFile, DevicesFoldersAndMissingFoldersAreRefused) {
  const TempFolder folder;
  for (const std::string& path : {std::string("/dev/full"), std::string("/dev/null"), folder.path().string(),
                                  folder.file("none/a.txt"), std::string("/proc/a.txt"), std::string()}) {
    const Status status = writeFileAtomically(path, "x");
    ASSERT_FALSE(status) << path;
    EXPECT_EQ(status.error().kind, ErrorKind::kInput) << path;
  }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_EQ(filesIn(folder.path()), 0U);
}

TEST(AtomicFile, MovingHandsTheFileOver) {
  const TempFolder folder;
  auto file = AtomicFile::create(folder.file("a.txt"));
  ASSERT_TRUE(file);
  AtomicFile moved = std::move(*file);
  ASSERT_TRUE(moved.write("x"));
  ASSERT_TRUE(moved.commit());
  EXPECT_EQ(readBytes(folder.file("a.txt")), "x");
}

TEST(Writers, AFullDiskIsOneClearLineAndNoFile) {
  const TempFolder folder;
  // Too small for any of the outputs, and in steps, so that the end comes at different places: in the first
  // block, in the middle, in the directory that is written at the end.
  for (const char* size : {"size=8k", "size=64k", "size=200k"}) {
    if (mount("tmpfs", folder.path().c_str(), "tmpfs", 0, size) != 0)
      GTEST_SKIP() << "mounting is not permitted";
    expectEveryWriterRefuses(roughField(400), folder.path(), "free space on the disk");
    const Status marks_tiff = exportMarks(roughField(2000), folder.file("m.tif"));
    const Status marks_png = exportMarks(roughField(2000), folder.file("m.png"));
    for (const Status& marks : {marks_tiff, marks_png}) {
      ASSERT_FALSE(marks);
      EXPECT_EQ(marks.error().kind, ErrorKind::kFailed);
      EXPECT_NE(marks.error().what.find("the disk is full"), std::string::npos) << marks.error().line();
    }
    EXPECT_EQ(filesIn(folder.path()), 0U);
    umount(folder.path().c_str());
  }
}

TEST(Writers, ADiskThatFillsAtAnyByteOfATiffIsNoticed) {
  const TempFolder folder;
  const Version field = roughField(100);
  ASSERT_TRUE(save(field, folder.file("whole.tif")));
  const auto whole = static_cast<rlim_t>(fs::file_size(folder.file("whole.tif")));
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  for (rlim_t limit = 1; limit < whole; limit += 997) {
    const rlimit low{limit, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &low);
    const auto written = save(field, folder.file("cut.tif"));
    setrlimit(RLIMIT_FSIZE, &old);
    ASSERT_FALSE(written) << limit << " of " << whole;
    EXPECT_EQ(written.error().kind, ErrorKind::kFailed);
    EXPECT_EQ(filesIn(folder.path()), 1U);
  }
  const rlimit last{whole - 1, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &last);
  const auto written = save(field, folder.file("cut.tif"));
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(written);
}

TEST(Writers, AMissingFolderIsRefusedByEveryWriter) {
  const TempFolder folder;
  for (const char* name : {"a.tif", "a.asc", "a.xyz", "a.ply", "a.png"}) {
    const auto written = save(roughField(10), folder.file(std::string("none/") + name));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, ErrorKind::kInput);
  }
  EXPECT_FALSE(exportMarks(roughField(10), folder.file("none/m.png")));
}

TEST(Writers, AnUnknownExtensionIsRefusedByName) {
  const TempFolder folder;
  for (const char* name : {"a.docx", "a", "a.TIFF2"}) {
    const auto written = save(roughField(4), folder.file(name));
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().line().find(".tif"), std::string::npos);
  }
  EXPECT_TRUE(save(roughField(4), folder.file("a.TIF")));
}

TEST(Writers, ACancelledJobLeavesNoFile) {
  const TempFolder folder;
  JobControl job;
  job.cancel();
  for (const char* name : {"a.tif", "a.asc", "a.xyz", "a.ply", "a.png"}) {
    const auto written = exportField(roughField(100), folder.file(name), {}, job);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, ErrorKind::kCancelled);
  }
  EXPECT_EQ(filesIn(folder.path()), 0U);
}

}  // namespace
}  // namespace fettle::engine
