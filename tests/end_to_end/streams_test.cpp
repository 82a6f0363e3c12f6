// "-" for standard input and output: every format goes through a pipe, and what comes out is whole.

#include <csignal>

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/source_tree.h"
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

TEST_F(Streams, MarksGoThroughPipes) {
  const std::string program = FETTLE_PROGRAM, scan = folder.file("part.tif"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "160x128", "-q"}).status, 0);
  const auto piped = [&](const std::string& to, const std::string& command) {
    const Outcome done = runProcess(
        {"sh", "-c",
         program + " mark " + scan + " - --edges -q " + to + " | " + program + " " + command + " --json"});
    EXPECT_EQ(done.status, 0) << command << done.err;
    return nlohmann::json::parse(done.out, nullptr, false);
  };
  const std::string marks = folder.file("m.png");
  ASSERT_EQ(fettle({"mark", scan, marks, "--edges"}).status, 0);
  const auto hash = fettleJson({"filter", scan, out, "--filter", "box", "--keep", marks})["hash"];
  EXPECT_NE(hash, fettleJson({"filter", scan, out, "--filter", "box"})["hash"]);
  EXPECT_EQ(piped("", "filter " + scan + " " + out + " --filter box --keep -")["hash"], hash);
  EXPECT_EQ(piped("--to tif", "filter " + scan + " " + out + " --filter box --keep -")["hash"], hash);
  const auto only = fettleJson({"filter", scan, out, "--filter", "box", "--only", marks})["hash"];
  EXPECT_EQ(piped("", "filter " + scan + " " + out + " --filter box --only -")["hash"], only);
  // The same ones for each of several scans.
  std::filesystem::copy_file(scan, folder.file("s2.tif"));
  const auto batch = piped("", "filter " + scan + " " + folder.file("s2.tif") + " --out-dir " +
                                   folder.file("d") + " --filter box --keep -");
  EXPECT_EQ(batch["files"][0]["hash"], hash);
  EXPECT_EQ(batch["files"][1]["hash"], hash);
  const auto marked = fettleJson({"mark", scan, folder.file("i.png"), "--add", marks, "--invert"})["marked"];
  EXPECT_EQ(piped("", "mark " + scan + " " + folder.file("i.png") + " --add - --invert")["marked"], marked);
  piped("", "render " + scan + " " + folder.file("p.png") + " --size 64x64 --marks -");
  EXPECT_TRUE(
      piped("", "compare " + scan + " " + out + " --truth " + scan + " --edges -")["rmse_edge"].is_number());
  std::ofstream(folder.file("strokes.csv")) << "t,x,y,z,tool\n0,0.1,0.1,-1,mark\n0.001,0.1,0.1,-1,mark\n";
  EXPECT_GT(
      piped("", "replay " + scan + " " + folder.file("strokes.csv") + " " + out + " --marks -")["marked"], 0);
  EXPECT_TRUE(fettle({"replay", scan, folder.file("strokes.csv"), out, "--marks-out", "-", "-q"})
                  .out.starts_with("\x89PNG"));
  expectRefused(fettle({"filter", scan, out, "--filter", "box", "--keep", "-"}, from("/dev/null")),
                "standard input");
  expectRefused(fettle({"filter", "-", out, "--filter", "box", "--keep", "-"}, from(scan)),
                "can only be read once");
}

TEST_F(Streams, LinesGoThroughPipesInEveryFormat) {
  const std::string scan = folder.file("part.tif"), out = folder.file("o.tif"), csv = folder.file("l.csv");
  ASSERT_EQ(fettle({"synth", scan, "--size", "160x128", "-q"}).status, 0);
  ASSERT_EQ(fettle({"mark", scan, folder.file("m.png"), "--edges", "--lines-out", csv}).status, 0);
  std::ifstream file(csv);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(fettle({"mark", scan, folder.file("m.png"), "--edges", "--lines-out", "-", "-q"}).out, text);
  EXPECT_EQ(fettle({"lines", scan, csv, "--out", "-", "-q"}).out, text);
  EXPECT_TRUE(fettle({"lines", scan, csv, "--csv", "-", "-q"}).out.starts_with("line,along_mm"));
  for (const std::string format : {"csv", "geojson", "gpkg", "dxf"}) {
    const std::string path = folder.file("lines." + format);
    ASSERT_EQ(fettle({"lines", scan, csv, "--out", path}).status, 0);
    const auto hash = fettleJson({"filter", scan, out, "--filter", "tgv", "--lines", path})["hash"];
    const Outcome piped =
        fettle({"filter", scan, out, "--filter", "tgv", "--lines", "-", "--json"}, from(path));
    ASSERT_EQ(piped.status, 0) << format << piped.err;
    EXPECT_EQ(nlohmann::json::parse(piped.out)["hash"], hash) << format;
    EXPECT_EQ(fettle({"lines", scan, "-"}, from(path)).status, 0) << format;
    EXPECT_EQ(
        fettle({"render", scan, folder.file("p.png"), "--size", "64x64", "--lines", "-"}, from(path)).status,
        0);
  }
  expectRefused(fettle({"lines", scan, "-"}, from(scan)), "its format cannot be recognised");
  expectRefused(fettle({"lines", "-", "-"}, from(scan)), "can only be read once");
  expectRefused(fettle({"lines", scan, csv, "--out", "-", "--csv", "-"}), "two outputs are standard output");
  expectRefused(fettle({"mark", scan, "-", "--edges", "--lines-out", "-"}),
                "two outputs are standard output");
}

TEST_F(Streams, SessionsAndRecipesGoThroughPipes) {
  const std::string session = inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle");
  const std::string copy = folder.file("j.fettle");
  std::filesystem::copy_file(session, copy);
  EXPECT_EQ(fettle({"journal", "-"}, from(copy)).out, fettle({"journal", copy}).out);
  expectRefused(fettle({"recipe", "-"}, from(copy)), "it belongs to this scan");
  const auto hash = fettleJson({"replay", copy, folder.file("o.tif")})["hash"];
  const Outcome replayed =
      fettle({"replay", "-", folder.file("o.tif"), "--from", "fettle", "--json"}, from(copy));
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_EQ(nlohmann::json::parse(replayed.out)["hash"], hash);
  std::ofstream(folder.file("c.toml")) << "recipe = 1\n[[step]]\ndo = \"invert\"\n";
  EXPECT_EQ(
      fettle({"apply", "-", folder.file("s.tif"), folder.file("o.tif")}, from(folder.file("c.toml"))).status,
      0);
  expectRefused(fettle({"apply", "-", "-", folder.file("o.tif")}, from(folder.file("c.toml"))),
                "cannot both be standard input");
}

TEST_F(Streams, DataThatIsNoTextIsNotWrittenToATerminal) {
  const std::string program = FETTLE_PROGRAM, scan = folder.file("s.tif");
  for (const std::string& command :
       {"convert " + scan + " - --to tif", "mark " + scan + " - --edges",
        "render " + scan + " - --size 64x64", "filter " + scan + " - --to exr --filter box"}) {
    // util-linux's script runs it on a terminal of its own.
    const Outcome shown = runProcess({"script", "-qec", program + " " + command, "/dev/null"});
    EXPECT_EQ(shown.status, 2) << command;
    EXPECT_NE(shown.out.find("standard output is a terminal"), std::string::npos) << command << shown.out;
  }
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
        {std::vector<std::string>{"mark", scan, out, "--strokes", "-"}, "--strokes"},
        {std::vector<std::string>{"synth", out, "--truth", "-"}, "--truth"}}) {
    const Outcome printed = fettle(arguments);
    expectRefused(printed, "takes no -");
    EXPECT_NE(printed.err.find(name), std::string::npos) << printed.err;
  }
}

}  // namespace
}  // namespace fettle::tests
