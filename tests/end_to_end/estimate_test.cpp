#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

int entriesOf(const TempFolder& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
}

// Memory and disk do not depend on what else the machine does; of time only the order is asked here.
TEST(Estimate, ForesawMemoryAndDiskWithinATenthAndTheOrderOfTheTime) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "2500x2500"}).status, 0);
  const auto before = fettleJson({"filter", in, out, "--filter", "planes", "--passes", "4", "--estimate"});
  EXPECT_EQ(entriesOf(folder), 1) << "an estimate leaves no file";
  const auto report = fettleJson({"filter", in, out, "--filter", "planes", "--passes", "4"});
  ASSERT_TRUE(report.contains("estimate"));
  for (const auto& estimate : {before, report["estimate"]}) {
    EXPECT_NEAR(estimate.at("memory_bytes").get<double>() / report.at("peak_memory_bytes").get<double>(), 1.0,
                0.1);
    EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / report.at("disk_bytes").get<double>(), 1.0, 0.1);
    EXPECT_EQ(report.at("disk_bytes"), fs::file_size(out));
    const double time = estimate.at("work_seconds").get<double>() / report.at("seconds").get<double>();
    EXPECT_GT(time, 0.1);
    EXPECT_LT(time, 10.0);
  }
}

// Each thread holds a square of generalised variation, 8 MB, and the heap keeps pieces of what was freed.
TEST(Estimate, OfSquaresInMemoryIsNotBelowWhatTheyTake) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "2100x2100"}).status, 0);
  for (const std::string threads : {"1", "2"}) {
    const auto report =
        fettleJson({"filter", in, folder.file("o.tif"), "--filter", "tgv", "--threads", threads});
    const double ratio =
        report.at("estimate").at("memory_bytes").get<double>() / report.at("peak_memory_bytes").get<double>();
    EXPECT_GE(ratio, 0.99) << threads << " threads";
    EXPECT_LE(ratio, 1.4) << threads << " threads";
  }
}

TEST(Estimate, KnowsFormatsThatPackAndKeptWork) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "1500x1500"}).status, 0);
  for (const std::string name : {"o.asc", "o.fettle", "o.ply"}) {
    const std::string out = folder.file(name);
    const auto estimate = fettleJson({"filter", in, out, "--filter", "planes", "--estimate", "--resume"});
    EXPECT_NEAR(estimate.at("kept_bytes").get<double>(), 4.0 * 1500 * 1500, 0.1 * 4.0 * 1500 * 1500);
    ASSERT_EQ(fettle({"filter", in, out, "--filter", "planes"}).status, 0);
    EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out)), 1.0, 0.1)
        << name;
  }
}

// Each command that takes long has an estimate, which does nothing.
TEST(Estimate, OfOtherCommandsForeseesTheDiskAndWritesNothing) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), other = folder.file("t.tif"), recipe = folder.file("r.toml");
  for (const std::string& scan : {in, other})
    ASSERT_EQ(fettle({"synth", scan, "--size", "1500x1500"}).status, 0);
  std::ofstream(recipe)
      << "recipe = 1\n[[step]]\ndo = \"mark_edges\"\n[[step]]\ndo = \"filter\"\nfilter = \"planes\"\n";
  const std::vector<std::vector<std::string>> commands{
      {"convert", in, folder.file("o.stl")},
      {"convert", in, folder.file("o.asc")},
      {"apply", recipe, in, folder.file("o.tif")},
      {"compare", in, other, "--deviation", folder.file("d.tif")},
      {"mark", in, folder.file("m.tif"), "--edges"}};
  for (std::vector<std::string> command : commands) {
    const std::string out = command[0] == "apply"     ? command[3]
                            : command[0] == "compare" ? command[4]
                                                      : command[2];
    command.emplace_back("--estimate");
    const auto estimate = fettleJson(command);
    EXPECT_EQ(entriesOf(folder), 3) << command[0];
    EXPECT_GT(estimate.at("seconds").get<double>(), 0.0) << command[0];
    EXPECT_GT(estimate.at("memory_bytes").get<double>(), 4.0 * 1500 * 1500) << command[0];
    command.pop_back();
    ASSERT_EQ(fettle(command).status, 0) << command[0];
    // Marks lie densely here and there, so that a piece says little of a packed picture.
    if (command[0] != "mark") {
      EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out)), 1.0, 0.1)
          << out;
    }
    fs::remove(out);
  }
  const auto batch =
      fettle({"convert", in, other, "--out-dir", folder.file("all"), "--to", "asc", "--estimate"});
  EXPECT_NE(batch.out.find("s.tif  about "), std::string::npos) << batch.out;
  EXPECT_EQ(entriesOf(folder), 3);
  const auto suggestion = fettleJson({"filter", in, "--suggest", "--tolerance", "10um", "--estimate"});
  EXPECT_GT(suggestion.at("work_seconds").get<double>(), 0.1);
}

// A crop, a turn, other spacings: the result has other samples than the scan.
TEST(Estimate, OfTransformsAndFillsForeseesTheDiskOfTheResult) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), recipe = folder.file("r.toml");
  ASSERT_EQ(fettle({"synth", in, "--size", "2000x1500"}).status, 0);
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"transform\"\ncrop = [0, 0, 90, 40]\n[[step]]\ndo = "
                           "\"fill\"\n[[step]]\ndo = \"filter\"\nfilter = \"planes\"\n";
  const std::vector<std::vector<std::string>> commands{
      {"transform", in, folder.file("o.tif"), "--crop-samples", "100,200,900,1300"},
      {"transform", in, folder.file("o.asc"), "--turn", "90"},
      {"transform", in, folder.file("o.tif"), "--angle", "20"},
      {"transform", in, folder.file("o.ply"), "--to-spacing", "0.06,0.09"},
      {"transform", in, folder.file("o.fettle"), "--angle", "-7"},
      {"fill", in, folder.file("o.tif")},
      {"remove", in, folder.file("o.tif"), "--below", "0"},
      {"apply", recipe, in, folder.file("o.tif")}};
  for (std::vector<std::string> command : commands) {
    const std::string out = command[0] == "apply" ? command[3] : command[2];
    command.emplace_back("--estimate");
    const auto estimate = fettleJson(command);
    EXPECT_EQ(entriesOf(folder), 2) << command[0];
    command.pop_back();
    ASSERT_EQ(fettle(command).status, 0) << command[0];
    EXPECT_GT(estimate.at("work_seconds").get<double>(), 0.0) << command[0];
    // A session packs: of a turned piece other corners are empty than of the turned scan.
    EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out)), 1.0,
                out.ends_with(".fettle") ? 0.25 : 0.1)
        << command[0] << " " << out;
    fs::remove(out);
  }
  const auto holed = fettleJson({"fill", in, folder.file("o.tif"), "--method", "membrane", "--estimate"});
  EXPECT_TRUE(holed.contains("seconds")) << "the simulated scan has holes";
}

// What is seen under a form and the samples both go to their new places; the estimate is not that of the samples alone.
TEST(Estimate, OfATransformCountsTheFormOverTheScan) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), plain = folder.file("plain.fettle"),
                    formed = folder.file("formed.fettle"), out = folder.file("o.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "2000x1500"}).status, 0);
  ASSERT_EQ(fettle({"convert", in, plain}).status, 0);
  ASSERT_EQ(fettle({"level", in, formed, "--layer", "put", "--form", "poly5"}).status, 0);
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"--turn", "90"}, {"--angle", "20"}, {"--to-spacing", "0.06"}}) {
    const auto estimateOf = [&](const std::string& scan) {
      std::vector<std::string> words{"transform", scan, out, "--estimate"};
      words.insert(words.end(), how.begin(), how.end());
      return fettleJson(words);
    };
    std::vector<std::string> words{"transform", formed, out};
    words.insert(words.end(), how.begin(), how.end());
    const Outcome done = fettle(words);
    ASSERT_EQ(done.status, 0) << done.err;
    fs::remove(out);
    const auto with = estimateOf(formed), without = estimateOf(plain);
    const double ratio = with.at("memory_bytes").get<double>() / static_cast<double>(done.peak_bytes);
    // Without the form a half to two thirds of it was foreseen.
    EXPECT_GT(ratio, 0.85) << how[0] << " " << with.dump();
    EXPECT_LT(ratio, 1.4) << how[0] << " " << with.dump();
    EXPECT_GT(with.at("memory_bytes"), without.at("memory_bytes")) << how[0];
    EXPECT_GT(with.at("work_seconds"), 0.0) << how[0];
  }
}

double ratioOfMemory(std::vector<std::string> command, const std::string& out) {
  command.emplace_back("--estimate");
  const auto estimate = fettleJson(command);
  command.pop_back();
  const Outcome done = fettle(command);
  EXPECT_EQ(done.status, 0) << done.err;
  fs::remove(out);
  return estimate.at("memory_bytes").get<double>() / static_cast<double>(done.peak_bytes);
}

// Of a scan without a form: the turned result is larger than the scan, and most of its tiles have samples.
TEST(Estimate, OfATransformForeseesTheMemoryOfItsResult) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.tif"), recipe = folder.file("r.toml");
  ASSERT_EQ(fettle({"synth", in, "--size", "2000x1500"}).status, 0);
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"transform\"\nangle = 20\n";
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"transform", in, out, "--angle", "20"},
        {"transform", in, out, "--turn", "90"},
        {"transform", in, out, "--to-spacing", "0.03"},
        {"apply", recipe, in, out}}) {
    const double ratio = ratioOfMemory(command, out);
    EXPECT_GT(ratio, 0.88) << command[0] << ' ' << command[1] << ' ' << command[3];
    EXPECT_LT(ratio, 1.4) << command[0] << ' ' << command[1] << ' ' << command[3];
  }
}

// A form that a recipe lays over the scan is what is seen of it, and of what changes are limited from.
TEST(Estimate, OfARecipeCountsTheFormThatItLaysOverTheScan) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), recipe = folder.file("r.toml");
  ASSERT_EQ(fettle({"synth", in, "--size", "2000x1500"}).status, 0);
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"form\"\nform = \"poly5\"\nlayer = \"put\"\n";
  for (const char* name : {"o.fettle", "o.tif"}) {
    const std::string out = folder.file(name);
    const auto estimate = fettleJson({"apply", recipe, in, out, "--estimate"});
    // It is counted as work. How long it takes is what the pieces took that were tried, on a machine that others use, too.
    EXPECT_GT(estimate.at("work_seconds"), 0.0) << estimate.dump();
    const double ratio = ratioOfMemory({"apply", recipe, in, out}, out);
    EXPECT_GT(ratio, 0.88) << name;
    EXPECT_LT(ratio, 1.4) << name;
  }
}

// A session keeps what changed beside the original: much where a step is, nothing in the middle.
TEST(Estimate, OfASessionLooksForChangesAllOverTheScan) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.fettle");
  ASSERT_EQ(fettle({"synth", in, "--size", "2000x1500"}).status, 0);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"remove", in, out, "--below", "0"}, {"remove", in, out, "--above", "2"}}) {
    std::vector<std::string> asked = command;
    asked.emplace_back("--estimate");
    const auto estimate = fettleJson(asked);
    ASSERT_EQ(fettle(command).status, 0);
    const double ratio = estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out));
    EXPECT_GT(ratio, 0.8) << command[3];
    EXPECT_LT(ratio, 1.25) << command[3];
    fs::remove(out);
  }
}

// Nearly all triangles are at edges and holes, of which the middle of the simulated part has few.
TEST(Estimate, OfAMeshWithAnErrorLooksAllOverTheScan) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif"), out = folder.file("o.stl");
  ASSERT_EQ(fettle({"synth", in, "--size", "2000x2000", "--seed", "2"}).status, 0);
  for (const std::string error : {"20um", "100um"}) {
    const auto estimate = fettleJson({"convert", in, out, "--max-error", error, "--estimate"});
    ASSERT_EQ(fettle({"convert", in, out, "--max-error", error, "--force"}).status, 0);
    const double ratio = estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out));
    // With a large error all depends on how many of the blocks an edge crosses.
    EXPECT_GT(ratio, error == "20um" ? 0.9 : 0.7) << error;
    EXPECT_LT(ratio, error == "20um" ? 1.1 : 1.4) << error;
    fs::remove(out);
  }
}

// Times are those of a machine that may be busy: they are not compared here.
TEST(Estimate, OfMeasuringCommandsForeseesMemoryAndDisk) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  for (const auto& [name, seed] : {std::pair("s.tif", "1"), {"t.tif", "2"}})
    ASSERT_EQ(fettle({"synth", file(name), "--size", "400x400", "--seed", seed}).status, 0);
  ASSERT_EQ(fettle({"convert", file("s.tif"), file("n.stl"), "--max-error", "100um"}).status, 0);
  const std::vector<std::vector<std::string>> commands{
      {"level", file("s.tif"), file("o.tif"), "--form", "poly2"},
      {"level", file("s.tif"), file("o.fettle"), "--layer", "put"},
      {"fit", file("s.tif"), "--residuals", file("o.tif")},
      {"measure", file("s.tif"), "--noise-trials", "4"},
      {"features", file("s.tif"), "--labels", file("o.tif")},
      {"align", file("s.tif"), file("t.tif"), file("o.tif")},
      {"compare", file("s.tif"), file("n.stl"), "--deviation", file("o.tif")},
      {"mosaic", file("s.tif"), file("t.tif"), file("o.tif"), "--layout", "2x1", "--overlap", "90"}};
  for (std::vector<std::string> command : commands) {
    const bool named_last = command[0] == "fit" || command[0] == "compare" || command[0] == "features";
    const std::string out = named_last                ? command.back()
                            : command[0] == "level"   ? command[2]
                            : command[0] == "measure" ? ""
                                                      : command[3];
    command.emplace_back("--estimate");
    const auto estimate = fettleJson(command);
    EXPECT_EQ(entriesOf(folder), 3) << command[0];
    command.pop_back();
    const Outcome done = fettle(command);
    ASSERT_EQ(done.status, 0) << command[0] << done.err;
    const double memory = estimate.at("memory_bytes").get<double>() / static_cast<double>(done.peak_bytes);
    EXPECT_GT(memory, 0.8) << command[0] << " " << estimate.dump();
    EXPECT_LT(memory, 2.0) << command[0] << " " << estimate.dump();
    EXPECT_GT(estimate.at("seconds"), 0.0) << command[0];
    if (out.empty()) continue;
    // A session packs level places to nothing, of which squares may show none.
    if (!out.ends_with(".fettle")) {
      EXPECT_NEAR(estimate.at("disk_bytes").get<double>() / static_cast<double>(fs::file_size(out)), 1.0,
                  0.15)
          << command[0];
    }
    fs::remove(out);
  }
}

TEST(Estimate, ShortWorkBeginsWithoutAWord) {
  const TempFolder folder;
  const std::string in = folder.file("s.tif");
  ASSERT_EQ(fettle({"synth", in, "--size", "300x300"}).status, 0);
  const Outcome outcome = fettle({"filter", in, folder.file("o.tif"), "--filter", "median"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_FALSE(fettleJson({"filter", in, folder.file("o.tif"), "--filter", "median"}).contains("estimate"));
}

}  // namespace
}  // namespace fettle::tests
