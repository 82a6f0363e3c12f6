// What users do wrong, and what disks do: one clear line, exit status 2 (1 for a full disk), no output file,
// bounded memory.

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string smallScan(const TempFolder& folder) {
  write(folder.file("scan.asc"),
        "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
        "1 2 3 4\n5 6 7 8\n9 10 11 -9999\n");
  return folder.file("scan.asc");
}

TEST(BadInput, UsageErrorsNameTheOptionAndTheHelp) {
  expectRefused(fettle({}), "--help");
  expectRefused(fettle({"polish"}), "--help");
  expectRefused(fettle({"filter", "a.tif", "b.tif"}), "--filter");
  expectRefused(fettle({"filter", "a.tif", "b.tif", "--filter", "sharpen"}), "sharpen");
  expectRefused(fettle({"filter", "a.tif", "b.tif", "--filter", "box", "--window", "4"}), "odd");
  expectRefused(fettle({"filter", "a.tif", "b.tif", "--filter", "box", "--window", "1003"}), "1001");
  expectRefused(fettle({"synth", "a.tif", "--size", "0x5"}), "--size");
  expectRefused(fettle({"info", "a.tif", "--unit", "parsec"}), "parsec");
}

TEST(BadInput, FilesThatAreNoScansAreRefused) {
  const TempFolder folder;
  write(folder.file("empty.tif"), "");
  write(folder.file("noise.tif"), std::string("II*\0garbage that is no directory", 32));
  write(folder.file("words.png"), "this is no picture");
  write(folder.file("words.xyz"), "once upon a time\nthere was a scan\n");
  write(folder.file("huge.asc"),
        "ncols 2147483647\nnrows 2147483647\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n");
  for (const char* name :
       {"empty.tif", "noise.tif", "words.png", "words.xyz", "huge.asc", "missing.tif", "."}) {
    const std::string out = folder.file("out.tif");
    ProcessOptions bounded;
#ifndef __SANITIZE_ADDRESS__  // which maps terabytes of shadow
    // Address space, of which libraries and thread stacks take most.
    bounded.memory_limit = std::size_t{3} << 30;
#endif
    expectRefused(fettle({"convert", folder.file(name), out}, bounded), name);
    EXPECT_FALSE(std::filesystem::exists(out)) << name;
  }
}

TEST(BadInput, TruncatedScansAreRefusedAtEveryLength) {
  const TempFolder folder;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "80x70"}).status, 0);
  std::ifstream in(folder.file("s.tif"), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  for (const double share : {0.001, 0.1, 0.5, 0.9}) {
    write(folder.file("cut.tif"),
          whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    expectRefused(fettle({"info", folder.file("cut.tif")}), "cut.tif");
  }
}

TEST(BadInput, MarksOfAnotherSizeAreRefused) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  ASSERT_EQ(
      fettle({"synth", folder.file("s.tif"), "--size", "80x70", "--edges", folder.file("e.png")}).status, 0);
  expectRefused(
      fettle({"filter", scan, folder.file("o.tif"), "--filter", "box", "--keep", folder.file("e.png")}),
      "e.png");
}

TEST(BadInput, StrokesAndScenesThatAreWrongNameTheLine) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  write(folder.file("s.csv"), "t,x,y,z,tool\n0,1,1,1,feel\n0.001,1,one,1,feel\n");
  expectRefused(fettle({"replay", scan, folder.file("s.csv"), folder.file("o.tif")}), "line 3");
  write(folder.file("s.csv"), "t,x,y,z,tool\n0,1,1,1,feel\n");
  write(folder.file("scene.toml"), "[force]\nstiffness_n_per_mm = 1\nstifness = 2\n");
  expectRefused(fettle({"replay", scan, folder.file("s.csv"), folder.file("o.tif"), "--scene",
                        folder.file("scene.toml")}),
                "stifness");
  EXPECT_FALSE(std::filesystem::exists(folder.file("o.tif")));
}

TEST(BadInput, AReplayWithoutAFileToWriteSaysThat) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  write(folder.file("s.csv"), "t,x,y,z,tool\n0,1,1,1,feel\n");
  expectRefused(fettle({"replay", scan, folder.file("s.csv")}), "no file to write is named");
  expectRefused(fettle({"replay", scan}), "no strokes are named");
  ASSERT_EQ(fettle({"convert", scan, folder.file("w.fettle")}).status, 0);
  expectRefused(fettle({"replay", folder.file("w.fettle")}), "no file to write is named");
  // Two names, of which the second would have been replaced by the field.
  expectRefused(fettle({"replay", folder.file("w.fettle"), folder.file("s.csv")}), "these are strokes");
  std::ifstream strokes(folder.file("s.csv"));
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(strokes)), {}), "t,x,y,z,tool\n0,1,1,1,feel\n");
}

TEST(BadInput, OutputsThatCannotBeWrittenAreRefusedAndLeaveNothing) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  expectRefused(fettle({"convert", scan, folder.file("no/such/folder/o.tif")}), "no/such/folder");
  expectRefused(fettle({"convert", scan, folder.file("o.docx")}), "docx");
  std::filesystem::create_directory(folder.path() / "d.tif");
  expectRefused(fettle({"convert", scan, folder.file("d.tif")}), "d.tif");
  // A folder, with and without the slash, is called that, and not a format.
  std::filesystem::create_directory(folder.path() / "e");
  for (const char* name : {"e", "e/", "new/"}) {
    const Outcome outcome = fettle({"convert", scan, folder.file(name)});
    expectRefused(outcome, "the output is a folder");
    EXPECT_NE(outcome.err.find("--out-dir"), std::string::npos) << outcome.err;
    expectRefused(fettle({"synth", folder.file(name)}), "the output is a folder");
  }
  // A folder in which nothing can be made, even by root.
  expectRefused(fettle({"convert", scan, "/proc/o.tif"}), "/proc");
}

TEST(BadInput, WhatWouldDestroyAFileIsRefusedBeforeAnyWork) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  write(folder.file("s.csv"), "t,x,y,z,tool\n0,1,1,1,feel\n");
  std::filesystem::create_symlink(scan, folder.path() / "link.asc");
  expectRefused(fettle({"filter", scan, scan, "--filter", "box"}), "replace an input");
  expectRefused(fettle({"filter", scan, folder.file("link.asc"), "--filter", "box"}), "replace an input");
  expectRefused(
      fettle({"replay", scan, folder.file("s.csv"), folder.file("o.tif"), "--forces", folder.file("s.csv")}),
      "replace an input");
  expectRefused(fettle({"replay", scan, folder.file("s.csv"), folder.file("o.png"), "--marks-out",
                        folder.file("o.png")}),
                "same place");
  expectRefused(fettle({"replay", scan, folder.file("s.csv"), folder.file("o.tif"), "--marks-out",
                        folder.file("m.jpg")}),
                "m.jpg");
  expectRefused(fettle({"synth", folder.file("o.tif"), "--edges", folder.file("e.xyz")}), "e.xyz");
  expectRefused(fettle({"render", scan, folder.file("o.jpg")}), "o.jpg");
  for (const char* outside : {"5,5", "-0.1,0.5", "nan,0.5"})
    expectRefused(fettle({"render", scan, folder.file("o.png"), "--centre", outside}), "--centre");
  expectRefused(fettle({"convert", scan, "/dev/full"}), "/dev/full");
  for (const char* name : {"o.tif", "o.png", "o.jpg"})
    EXPECT_FALSE(std::filesystem::exists(folder.file(name))) << name;
}

TEST(BadInput, AnEmptyArgumentIsNotTakenForNoArgument) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  for (const char* option : {"--keep", "--only", "--max-change"})
    expectRefused(fettle({"filter", scan, folder.file("o.tif"), "--filter", "box", option, ""}), option);
}

TEST(BadInput, SeedsThatAreNoWholeNumbersAreRefused) {
  const TempFolder folder;
  for (const char* seed : {"-1", "99999999999999999999", "1.5", "x"})
    expectRefused(fettle({"synth", folder.file("o.tif"), "--seed", seed}), "--seed");
}

TEST(BadInput, AStandardErrorThatIsFullEndsNothing) {
  const TempFolder folder;
  const std::string scan = smallScan(folder);
  const std::string run =
      std::string(FETTLE_PROGRAM) + " convert " + scan + " " + folder.file("o.png") + " 2>/dev/full";
  EXPECT_EQ(runProcess({"sh", "-c", run}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.file("o.png")));
  EXPECT_EQ(runProcess({"sh", "-c", std::string(FETTLE_PROGRAM) + " info nofile 2>/dev/full"}).status, 2);
}

TEST(BadInput, AFullDiskLeavesTheOldFileAndNothingElse) {
  const TempFolder folder;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "300x300"}).status, 0);
  write(folder.file("out.tif"), "the old file");
  ProcessOptions full;
  full.file_limit = 20000;
  for (const char* name : {"out.tif", "out.asc", "out.xyz", "out.ply", "out.png"}) {
    expectFailed(fettle({"convert", folder.file("s.tif"), folder.file(name)}, full), name);
    if (std::string(name) != "out.tif") {
      EXPECT_FALSE(std::filesystem::exists(folder.file(name))) << name;
    }
  }
  std::ifstream in(folder.file("out.tif"));
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(in)), {}), "the old file");
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 2);
}

// Runs fettle where `disk` is a disk of 40 KB, and lists on standard output what is on it afterwards.
Outcome onATinyDisk(const std::string& disk, std::vector<std::string> arguments) {
  const std::string script =
      "mount -t tmpfs -o size=40k tmpfs \"$0\" || exit 77; \"$@\"; status=$?; ls -A \"$0\"; exit $status";
  arguments.insert(arguments.begin(), {"unshare", "-rm", "sh", "-c", script, disk, FETTLE_PROGRAM});
  return runProcess(arguments);
}

TEST(BadInput, AFullDiskIsAFailureThatSaysSoAndLeavesNothing) {
  const TempFolder folder;
  const std::string disk = (folder.path() / "disk").string();
  std::filesystem::create_directory(disk);
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "300x300"}).status, 0);
  // Formats that GDAL and other libraries write, and those that write themselves; a picture of marks, too.
  for (const char* name :
       {"o.tif", "o.asc", "o.xyz", "o.png", "o.exr", "o.x3p", "o.fettle", "o.stl", "o.ply"}) {
    const Outcome full = onATinyDisk(disk, {"convert", folder.file("s.tif"), disk + "/" + name});
    if (full.status == 77 || full.status == 127 || full.err.find("unshare:") != std::string::npos)
      GTEST_SKIP() << "mounting is not permitted: " << full.err;
    expectFailed(full, "the disk is full");
    // Not the sample by which the size is foreseen.
    EXPECT_NE(full.err.find(" " + disk + "/" + name + ","), std::string::npos) << full.err;
  }
  expectFailed(onATinyDisk(disk, {"convert", folder.file("s.tif"), disk + "/o.tif", "--cloud-optimised"}),
               "the disk is full");
  expectFailed(onATinyDisk(disk, {"filter", folder.file("s.tif"), disk + "/o.tif", "--filter", "box"}),
               "the disk is full");
  // Standard output is a file on it.
  const std::string run = std::string(FETTLE_PROGRAM) + " info " + folder.file("s.tif") + " >/dev/full";
  const Outcome report = runProcess({"sh", "-c", run});
  EXPECT_EQ(report.status, 1);
  EXPECT_NE(report.err.find("the disk is full"), std::string::npos) << report.err;
}

TEST(BadInput, AReaderThatHadEnoughOfTheReportIsNone) {
  const TempFolder folder;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "30x30"}).status, 0);
  const std::string pipe = folder.file("pipe");
  // The reader is gone before the first byte.
  for (const std::string& command : {"info " + folder.file("s.tif"), "info --json " + folder.file("s.tif"),
                                     std::string("filter --help"), std::string("--version")}) {
    const Outcome run =
        runProcess({"sh", "-c",
                    "rm -f " + pipe + " && mkfifo " + pipe + " && { (: <" + pipe + ") & exec 3>" + pipe +
                        "; wait; " + std::string(FETTLE_PROGRAM) + " " + command + " >&3; }"});
    EXPECT_EQ(run.status, 0) << command;
    EXPECT_EQ(run.err, "") << command;
  }
}

}  // namespace
}  // namespace fettle::tests
