// What a new user types first: help, a version, a slip of the finger, and what a script asks for.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

std::string scanWithoutUnit(const TempFolder& folder) {
  std::ofstream(folder.file("scan.asc")) << "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
                                            "1 2 3 4\n5 6 7 8\n9 10 11 12\n";
  return folder.file("scan.asc");
}

TEST(Usage, HelpAndVersionAreFoundUnderTheNamesPeopleTry) {
  const std::string version = fettle({"--version"}).out;
  EXPECT_EQ(fettle({"-V"}).out, version);
  const std::string filter = fettle({"filter", "--help"}).out;
  EXPECT_NE(filter.find("--max-change"), std::string::npos);
  EXPECT_EQ(fettle({"help", "filter"}).out, filter);
  EXPECT_EQ(fettle({"help", "bench", "haptic"}).out, fettle({"bench", "haptic", "--help"}).out);
  const Outcome all = fettle({"help"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_EQ(all.out, fettle({"--help"}).out);
  EXPECT_NE(all.out.find("fettle help filter"), std::string::npos);
  expectRefused(fettle({"help", "fitler"}), "did you mean filter?");
  expectRefused(fettle({"fitler", "--help"}), "did you mean filter?");
}

TEST(Usage, TheVersionIsTheNewestReleaseOfTheChangelog) {
  std::ifstream changelog(inSourceTree("CHANGELOG.md"));
  std::string released;
  for (std::string line; released.empty() && std::getline(changelog, line);)
    if (line.starts_with("## [") && !line.starts_with("## [Unreleased]"))
      released = line.substr(4, line.find(']') - 4);
  EXPECT_EQ(fettle({"--version"}).out, "fettle " + released + "\n");
}

TEST(Usage, ASlipOfTheFingerIsAnsweredWithWhatWasMeant) {
  const TempFolder folder;
  const std::string scan = scanWithoutUnit(folder);
  const std::string out = folder.file("o.tif");
  expectRefused(fettle({"flter", scan, out}), "there is no command flter, did you mean filter?");
  expectRefused(fettle({"bench", "hapitc"}), "did you mean haptic?");
  expectRefused(fettle({"polish"}), "there is no command polish, see fettle --help");
  expectRefused(fettle({"filter", scan, out, "--filtr", "box"}),
                "there is no option --filtr, did you mean --filter?");
  expectRefused(fettle({"filter", scan, out, "--filter", "box", "--max_change=1"}),
                "did you mean --max-change?");
  expectRefused(fettle({"filter", scan, out, "-window", "5"}), "did you mean --window?");
  // A name that is missing because the option before it is misspelt.
  expectRefused(fettle({"render", scan, "--sise", "20x20"}), "did you mean --size?");
  expectRefused(fettle({"filter", scan, out, "--filter", "gausian"}), "did you mean gaussian?");
  expectRefused(fettle({"render", scan, folder.file("o.png"), "--map", "viridris"}), "did you mean viridis?");
  expectRefused(fettle({"synth", out, "--part", "brakcet"}), "did you mean bracket?");
  expectRefused(fettle({"convert", scan, folder.file("o.tfi")}), "did you mean .tif?");
  expectRefused(fettle({"convert", scan, "--out-dir", folder.file("d"), "--to", "x3d"}),
                "did you mean .x3p?");
  expectRefused(fettle({"info", scan, "--from", "acs"}), "did you mean .asc?");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Usage, QuietSaysNothingButErrors) {
  const TempFolder folder;
  const std::string scan = scanWithoutUnit(folder);  // states no unit, which is warned of
  EXPECT_NE(fettle({"convert", scan, folder.file("a.xyz")}).err, "");
  const Outcome quiet = fettle({"convert", scan, folder.file("b.xyz"), "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out, "");
  EXPECT_EQ(quiet.err, "");
  EXPECT_TRUE(std::filesystem::exists(folder.file("b.xyz")));
  EXPECT_EQ(fettleJson({"info", scan, "-q"})["width"], 4);  // what is asked for is printed
  expectRefused(fettle({"info", folder.file("none.tif"), "-q"}), "none.tif");
}

TEST(Usage, QuietRecordsWithoutAWordOfTheDevice) {
  const TempFolder folder;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "64x64", "-q"}).status, 0);
  std::ofstream strokes(folder.file("st.csv"));
  strokes << "t,x,y,z,tool\n";
  for (int k = 0; k < 100; ++k) strokes << 0.001 * k << ",3,3,40,feel\n";
  strokes.close();
  const std::vector<std::string> record{"record",
                                        folder.file("s.tif"),
                                        folder.file("q.csv"),
                                        "--device",
                                        "hand:" + folder.file("st.csv"),
                                        "--seconds",
                                        "0.05"};
  std::vector<std::string> quiet = record;
  quiet.insert(quiet.begin(), "-q");
  const Outcome printed = fettle(quiet);
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_EQ(printed.err, "");
  EXPECT_EQ(printed.out, "");
  EXPECT_NE(fettle(record).err.find("fettle: "), std::string::npos);
}

// One line with one object.
nlohmann::json errorOf(const Outcome& outcome, int status) {
  EXPECT_EQ(outcome.status, status) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  auto object = nlohmann::json::parse(outcome.err, nullptr, false);
  EXPECT_TRUE(object.is_object()) << outcome.err;
  return object.is_object() ? object : nlohmann::json::object();
}

TEST(Usage, UnderJsonAnErrorIsOneObjectOnStderr) {
  const TempFolder folder;
  const std::string scan = scanWithoutUnit(folder);
  const auto missing = errorOf(fettle({"info", folder.file("none.tif"), "--json"}), 2);
  EXPECT_EQ(missing["kind"], "input");
  EXPECT_EQ(missing["where"], folder.file("none.tif"));
  EXPECT_EQ(missing["remedy"], "check the path");
  EXPECT_EQ(missing["status"], 2);
  EXPECT_NE(missing["error"].get<std::string>().find(missing["what"].get<std::string>()), std::string::npos);
  // Of the command line itself, wherever --json stands; and after warnings, which are in the object.
  EXPECT_EQ(errorOf(fettle({"--json", "fitler"}), 2)["remedy"], "did you mean filter? see fettle --help");
  EXPECT_EQ(errorOf(fettle({"--json", "info", folder.file("none.tif")}), 2)["kind"], "input");
  EXPECT_NE(errorOf(fettle({"filter", scan, folder.file("o.tif"), "--filter", "bxo", "--json"}), 2)["error"]
                .get<std::string>()
                .find("did you mean box?"),
            std::string::npos);
  const auto late = errorOf(
      fettle({"filter", scan, folder.file("o.tif"), "--filter", "box", "--max-change", "5parsec", "--json"}),
      2);
  ASSERT_EQ(late["warnings"].size(), 1U);
  EXPECT_NE(late["warnings"][0].get<std::string>().find("states no unit"), std::string::npos);
  ProcessOptions full;
  full.file_limit = 100;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "64x64", "-q"}).status, 0);
  EXPECT_EQ(
      errorOf(fettle({"convert", folder.file("s.tif"), folder.file("o.png"), "--json"}, full), 1)["kind"],
      "failed");

  // Where all goes well the warnings are in the report, and stderr is empty. Of several scans each that fails
  // has its object.
  const Outcome done = fettle({"filter", scan, folder.file("o.tif"), "--filter", "box", "--json"});
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(nlohmann::json::parse(done.out)["warnings"].size(), 1U);
  const Outcome batch = fettle({"info", folder.file("none.tif"), scan, folder.file("nor.tif"), "--json"});
  EXPECT_EQ(batch.status, 1);
  EXPECT_EQ(nlohmann::json::parse(batch.out)["failed"], 2);
  std::istringstream lines(batch.err);
  int objects = 0;
  for (std::string line; std::getline(lines, line); ++objects) {
    const auto object = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(object.is_object()) << line;
    EXPECT_TRUE(object["error"].is_string());
  }
  EXPECT_EQ(objects, 2);
}

TEST(Usage, HelpIsHelpWithOutputFlagsAndKnowsTheCommandsOfACommand) {
  const std::string info = fettle({"help", "info"}).out;
  for (const char* flag : {"-q", "--quiet", "--json"}) {
    const Outcome printed = fettle({flag, "help", "info"});
    EXPECT_EQ(printed.status, 0) << printed.err;
    EXPECT_EQ(printed.out, info) << flag;
  }
  expectRefused(fettle({"help", "bench", "hapitc"}),
                "there is no command bench hapitc, did you mean haptic?");
  expectRefused(fettle({"help", "bench", "nope"}), "there is no command bench nope");
  expectRefused(fettle({"bench", "hapitc", "--help"}), "did you mean haptic?");
}

TEST(Usage, AnOptionBeforeItsCommandIsSentBehindIt) {
  const Outcome printed = fettle({"--compress", "lzw", "convert", "a.tif", "b.tif"});
  expectRefused(printed, "--compress is before the command that takes it");
  EXPECT_NE(printed.err.find("put it after: fettle convert --compress"), std::string::npos) << printed.err;
  expectRefused(fettle({"bench", "-q", "haptic"}), "put it after: fettle bench haptic -q");
  EXPECT_NE(fettle({"bench", "--json", "haptic"}).err.find("put it after: fettle bench haptic --json"),
            std::string::npos);
}

TEST(Usage, AWarningIsPrintedOnce) {
  const TempFolder folder;
  const std::string scan = scanWithoutUnit(folder);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", scan}, {"convert", scan, folder.file("o.stl")}}) {
    const Outcome printed = fettle(arguments);
    EXPECT_NE(printed.err.find("fettle: warning: "), std::string::npos);
    EXPECT_EQ(printed.out.find("warning"), std::string::npos) << printed.out;
    EXPECT_EQ(printed.out.find("states no unit"), std::string::npos) << printed.out;
  }
  EXPECT_EQ(fettleJson({"info", scan})["warnings"].size(), 1U);
}

TEST(Usage, AVersionThatCannotBePrintedSaysWhy) {
  const std::string program = FETTLE_PROGRAM;
  for (const std::string asked : {"-V", "--version", "--help"})
    expectFailed(runProcess({"sh", "-c", program + " " + asked + " >/dev/full"}), "the disk is full");
}

TEST(Usage, AWordBehindAFlagOrNoNumberForANumberIsRefused) {
  const TempFolder folder;
  const std::string scan = scanWithoutUnit(folder);
  expectRefused(fettle({"convert", scan, folder.file("o.tif"), "--force=word"}), "word");
  expectRefused(fettle({"view", scan, "--rate", "nan"}), "nan is not a number from");
  expectRefused(fettle({"view", scan, "--seconds", "nan"}), "nan is not a number from");
}

}  // namespace
}  // namespace fettle::tests
