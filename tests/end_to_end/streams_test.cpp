// "-" for standard input and output: every format goes through a pipe, and what comes out is whole.

#include <csignal>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class Streams : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "64x48", "--dropouts", "1", "-q"}).status, 0);
    whole_ = fettleJson({"compare", folder.file("s.tif"), folder.file("s.tif")});
  }
  // Every sample of the scan is in the file, and no other.
  void expectSame(const std::string& path) {
    const auto deviation = fettleJson({"compare", folder.file("s.tif"), path});
    EXPECT_EQ(deviation["max_abs"], 0.0) << path;
    EXPECT_EQ(deviation["samples"], whole_["samples"]) << path;
    EXPECT_EQ(deviation["only_a"], 0) << path;
    EXPECT_EQ(deviation["only_b"], 0) << path;
  }
  static ProcessOptions from(const std::string& file) {
    ProcessOptions options;
    options.input = file;
    return options;
  }

  TempFolder folder;
  nlohmann::json whole_;
};

TEST_F(Streams, EveryFormatComesOutOfStandardOutputAndGoesIntoStandardInput) {
  for (const std::string to : {"tif", "asc", "xyz", "ply", "x3p", "exr", "fettle"}) {
    const Outcome sent = fettle({"convert", folder.file("s.tif"), "-", "--to", to});
    ASSERT_EQ(sent.status, 0) << sent.err;
    std::ofstream(folder.file("sent"), std::ios::binary) << sent.out;  // without an extension
    const Outcome back = fettle({"convert", "-", folder.file("back.tif")}, from(folder.file("sent")));
    ASSERT_EQ(back.status, 0) << to << ": " << back.err;
    expectSame(folder.file("back.tif"));
  }
}

TEST_F(Streams, PipesOfCommandsCarryDataAloneAndTheReportIsOnStderr) {
  const std::string program = FETTLE_PROGRAM;
  const std::string pipe = "cat " + folder.file("s.tif") + " | " + program +
                           " filter - - --to xyz --filter median -q | " + program +
                           " convert - - --to tif -q >" + folder.file("piped.tif");
  const Outcome outcome = runProcess({"sh", "-c", pipe});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  ASSERT_EQ(fettle({"filter", folder.file("s.tif"), folder.file("s.tif.tif"), "--filter", "median"}).status,
            0);
  EXPECT_EQ(fettleJson({"compare", folder.file("s.tif.tif"), folder.file("piped.tif")})["max_abs"], 0.0);

  const Outcome printed = fettle({"convert", folder.file("s.tif"), "-", "--to", "asc", "--json"});
  EXPECT_TRUE(printed.out.starts_with("ncols")) << printed.out.substr(0, 80);
  EXPECT_EQ(nlohmann::json::parse(printed.err)["format"], "AAIGrid");

  EXPECT_EQ(fettle({"info", "-"}, from(folder.file("s.tif"))).status, 0);
  EXPECT_TRUE(fettle({"mark", folder.file("s.tif"), "-", "--edges", "-q"}).out.starts_with("\x89PNG"));
  EXPECT_TRUE(fettle({"render", "-", "-", "--size", "64x64", "-q"}, from(folder.file("s.tif")))
                  .out.starts_with("\x89PNG"));
  EXPECT_TRUE(fettle({"synth", "-", "--to", ".XYZ", "--size", "16x16", "-q"}).out.starts_with("//X Y Z"));
}

TEST_F(Streams, WhatCannotBeIsRefusedBeforeAnythingIsWritten) {
  const std::string scan = folder.file("s.tif");
  expectRefused(fettle({"convert", scan, "-"}), "--to");
  expectRefused(fettle({"convert", scan, "-", "--to", "docx"}), "docx");
  expectRefused(fettle({"convert", scan, folder.file("o.tif"), "--to", "tif"}), "--out-dir");
  expectRefused(fettle({"convert", "-", scan, "--out-dir", folder.file("d"), "--to", "tif"}), "-");
  expectRefused(fettle({"compare", "-", "-"}, from(scan)), "can only be read once");
  expectRefused(fettle({"synth", "-", "--to", "tif", "--truth", "-"}), "-");
  expectRefused(fettle({"synth", folder.file("o.tif"), "--edges", "-"}), "standard output");
  // What is wrong with the input names it, not the file that it is kept in.
  std::ofstream(folder.file("bad")) << "no picture\n";
  const Outcome bad = fettle({"convert", "-", "-", "--to", "tif"}, from(folder.file("bad")));
  expectRefused(bad, "standard input");
  EXPECT_EQ(bad.err.find("/stdin"), std::string::npos) << bad.err;
  expectRefused(fettle({"info", "-"}, from("/dev/null")), "standard input");
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(Streams, AReaderThatGoesAwayAndAFullDiskAreFailures) {
  const std::string program = FETTLE_PROGRAM;
  const Outcome full =
      runProcess({"sh", "-c", program + " convert " + folder.file("s.tif") + " - --to xyz -q >/dev/full"});
  expectFailed(full, "the disk is full");
  const Outcome closed = runProcess(
      {"sh", "-c",
       "(" + program + " convert " + folder.file("s.tif") + " - --to asc -q; echo $? >&2) | true"});
  EXPECT_NE(closed.err.find("the reader closed it"), std::string::npos) << closed.err;
  EXPECT_TRUE(closed.err.ends_with("1\n")) << closed.err;
}

TEST_F(Streams, CtrlCEndsTheWaitForInputAndLeavesNothingBehind) {
  std::filesystem::create_directory(folder.path() / "tmp");
  const std::string fifo = folder.file("fifo");
  ASSERT_EQ(runProcess({"mkfifo", fifo}).status, 0);
  // A writer that writes nothing; its folder for temporary files is one to look into. It is opened for
  // reading and writing, so that opening it waits for nobody.
  const std::string temporary = (folder.path() / "tmp").string();
  ProcessOptions options;
  options.while_running = [&](int pid) {
    if (std::filesystem::is_empty(temporary)) return false;
    kill(pid, SIGINT);
    return true;
  };
  const Outcome outcome = runProcess({"sh", "-c",
                                      "TMPDIR=" + temporary + " exec " + FETTLE_PROGRAM + " convert - " +
                                          folder.file("o.tif") + " <>" + fifo},
                                     options);
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
  EXPECT_FALSE(std::filesystem::exists(folder.file("o.tif")));
}

// For its lifetime the process, and what it starts, stands in a folder.
class StandingIn {
 public:
  explicit StandingIn(const std::filesystem::path& folder) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder);
  }
  ~StandingIn() { std::filesystem::current_path(before_); }
  StandingIn(const StandingIn&) = delete;
  StandingIn& operator=(const StandingIn&) = delete;

 private:
  std::filesystem::path before_;
};

TEST_F(Streams, AFolderOfThatNameIsNeitherInTheWayNorMade) {
  const StandingIn here(folder.path());
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"accuracy", "-", "--only", "energy", "--effort", "0.01"},
        {"demo", "-", "--side", "64"},
        {"convert", "s.tif", "--out-dir", "-", "--to", "asc"},
        {"filter", "s.tif", "--out-dir", "-", "--filter", "box"},
        {"info", "s.tif", "--store", "-"},
        {"bench", "growth", "--plots", "-"}}) {
    expectRefused(fettle(arguments), "- is standard output, and no folder");
    EXPECT_FALSE(std::filesystem::exists("-")) << arguments.front();
  }
  std::filesystem::create_directory("-");
  const Outcome sent = fettle({"convert", "s.tif", "-", "--to", "asc"});
  EXPECT_EQ(sent.status, 0) << sent.err;
  EXPECT_TRUE(sent.out.starts_with("ncols")) << sent.out.substr(0, 80);
}

TEST_F(Streams, ArgumentsThatTakeNoneSaySo) {
  const std::string scan = folder.file("s.tif"), out = folder.file("o.tif");
  for (const auto& [arguments, name] :
       {std::pair{std::vector<std::string>{"replay", scan, "-", out}, "STROKES"},
        {std::vector<std::string>{"replay", scan, "strokes.csv", out, "--forces", "-"}, "--forces"},
        {std::vector<std::string>{"replay", scan, "strokes.csv", out, "--scene", "-"}, "--scene"},
        {std::vector<std::string>{"record", scan, "-", "--device", "hand:x"}, "STROKES"},
        {std::vector<std::string>{"info", scan, "--picture", "-"}, "--picture"},
        {std::vector<std::string>{"filter", scan, out, "--filter", "box", "--keep", "-"}, "--keep"},
        {std::vector<std::string>{"synth", out, "--truth", "-"}, "--truth"}}) {
    const Outcome printed = fettle(arguments);
    expectRefused(printed, "takes no -");
    EXPECT_NE(printed.err.find(name), std::string::npos) << printed.err;
  }
}

}  // namespace
}  // namespace fettle::tests
