// Many scans in one run: what works is done, what fails is reported, no file is incomplete.

#include <csignal>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class Batch : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder.path() / "out");
    for (const char* name : {"a.tif", "b.asc", "c.x3p"})
      ASSERT_EQ(fettle({"synth", folder.file(name), "--size", "64x48"}).status, 0);
  }
  [[nodiscard]] std::string out(const std::string& name = {}) const {
    return (folder.path() / "out" / name).string();
  }
  [[nodiscard]] std::vector<std::string> written() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "out"))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  TempFolder folder;
};

using Names = std::vector<std::string>;

TEST_F(Batch, FiltersEveryScanAsARunOfItsOwnWould) {
  const auto report = fettleJson({"filter", folder.file("a.tif"), folder.file("b.asc"), folder.file("c.x3p"),
                                  "--out-dir", out(), "--filter", "median", "--window", "5"});
  EXPECT_EQ(report["done"], 3);
  EXPECT_EQ(report["failed"], 0);
  EXPECT_EQ(written(), (Names{"a.tif", "b.asc", "c.x3p"}));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name = written()[i];
    const auto alone = fettleJson(
        {"filter", folder.file(name), folder.file("alone.tif"), "--filter", "median", "--window", "5"});
    EXPECT_EQ(report["files"][i]["in"], folder.file(name));
    EXPECT_EQ(report["files"][i]["out"], out(name));
    EXPECT_EQ(report["files"][i]["hash"], alone["hash"]) << name;
  }
}

TEST_F(Batch, GoesOnAfterAFailureAndSaysAtTheEndWhichAndWhy) {
  std::ofstream(folder.file("bad.tif")) << "no picture";
  const std::vector<std::string> ask{"filter",
                                     folder.file("a.tif"),
                                     folder.file("bad.tif"),
                                     folder.file("none.tif"),
                                     folder.file("b.asc"),
                                     "--out-dir",
                                     out(),
                                     "--filter",
                                     "box"};
  const Outcome outcome = fettle(ask);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(written(), (Names{"a.tif", "b.asc"}));
  const std::size_t bad = outcome.err.find("fettle: error: ");
  const std::size_t none = outcome.err.find("fettle: error: ", bad + 1);
  ASSERT_NE(none, std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("bad.tif", bad), std::string::npos);
  EXPECT_NE(outcome.err.find("none.tif", none), std::string::npos);
  EXPECT_EQ(outcome.err.find("fettle: error: ", none + 1), std::string::npos) << outcome.err;
  EXPECT_TRUE(outcome.out.ends_with("2 done, 2 failed\n")) << outcome.out;

  std::vector<std::string> as_json = ask;
  as_json.emplace_back("--json");
  const Outcome json = fettle(as_json);
  EXPECT_EQ(json.status, 1);
  const auto report = nlohmann::json::parse(json.out);
  EXPECT_EQ(report["done"], 2);
  EXPECT_EQ(report["failed"], 2);
  ASSERT_EQ(report["files"].size(), 4U);
  EXPECT_FALSE(report["files"][0].contains("error"));
  EXPECT_EQ(report["files"][1]["in"], folder.file("bad.tif"));
  EXPECT_TRUE(report["files"][2]["error"].get<std::string>().find("No such file") != std::string::npos);
}

TEST_F(Batch, AMarkOfAnotherSizeFailsThatScanAlone) {
  ASSERT_EQ(
      fettle({"synth", folder.file("big.tif"), "--size", "70x50", "--edges", folder.file("m.png")}).status,
      0);
  const Outcome outcome = fettle({"filter", folder.file("a.tif"), folder.file("big.tif"), "--out-dir", out(),
                                  "--filter", "box", "--keep", folder.file("m.png")});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("a.tif"), std::string::npos) << outcome.err;
  EXPECT_EQ(written(), Names{"big.tif"});
}

TEST_F(Batch, RefusesBeforeAnythingIsReadWhatWouldEndInOneFile) {
  std::filesystem::create_directory(folder.path() / "other");
  std::filesystem::copy(folder.file("a.tif"), folder.path() / "other" / "a.tif");
  const Outcome same = fettle({"filter", folder.file("a.tif"), (folder.path() / "other" / "a.tif").string(),
                               "--out-dir", out(), "--filter", "box"});
  expectRefused(same, "would be written to the same file");
  // b.asc and b.tif are two names until both become b.tif.
  std::filesystem::copy(folder.file("a.tif"), folder.file("b.tif"));
  expectRefused(
      fettle({"convert", folder.file("b.asc"), folder.file("b.tif"), "--out-dir", out(), "--to", "tif"}),
      "would be written to the same file");
  expectRefused(
      fettle({"filter", folder.file("a.tif"), "--out-dir", folder.path().string(), "--filter", "box"}),
      "replace an input");
  expectRefused(
      fettle({"filter", folder.file("a.tif"), "--out-dir", folder.file("b.asc"), "--filter", "box"}),
      "a file, not a folder");
  expectRefused(
      fettle({"filter", folder.file("a.tif"), folder.file("b.asc"), folder.file("c.x3p"), "--filter", "box"}),
      "--out-dir");
  expectRefused(fettle({"filter", folder.file("a.tif"), "--filter", "box"}), "IN OUT");
  expectRefused(fettle({"convert", folder.file("a.tif"), out("x.asc"), "--to", "asc"}), "--out-dir");
  expectRefused(fettle({"convert", folder.file("a.tif"), "--out-dir", out(), "--to", "docx"}), "docx");
  EXPECT_EQ(written(), Names{});
}

TEST_F(Batch, MakesTheFolderAndRemovesItWhenNothingWasWritten) {
  const std::string made = folder.file("new/er");
  EXPECT_EQ(fettleJson({"convert", folder.file("a.tif"), "--out-dir", made, "--to", "asc"})["done"], 1);
  EXPECT_EQ(fettle({"info", made + "/a.asc"}).status, 0);
  const std::string in_vain = folder.file("vain");
  EXPECT_EQ(fettle({"convert", folder.file("none.tif"), "--out-dir", in_vain, "--to", "asc"}).status, 1);
  EXPECT_EQ(fettle({"convert", folder.file("a.tif"), "--out-dir", in_vain, "--to", "docx"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(in_vain));
}

TEST_F(Batch, InfoReportsEachOfSeveralScans) {
  std::ofstream(folder.file("bad.tif")) << "no picture";
  const Outcome outcome =
      fettle({"info", folder.file("a.tif"), folder.file("bad.tif"), folder.file("b.asc"), "--json"});
  EXPECT_EQ(outcome.status, 1);
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["done"], 2);
  EXPECT_EQ(report["failed"], 1);
  EXPECT_EQ(report["files"][0]["width"], 64);
  EXPECT_TRUE(report["files"][1].contains("error"));
  EXPECT_EQ(report["files"][2]["in"], folder.file("b.asc"));
  EXPECT_EQ(report["files"][2]["format"], "AAIGrid");
  // One scan has the report without a list; options may stand before and behind the names.
  EXPECT_EQ(fettleJson({"info", "--spacing", "0.5", folder.file("b.asc"), "--bins", "3"})["spacing_x"], 0.5);
  const Outcome printed = fettle({"info", folder.file("a.tif"), folder.file("c.x3p")});
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_NE(printed.out.find(folder.file("c.x3p")), std::string::npos) << printed.out;
  EXPECT_TRUE(printed.out.ends_with("2 read, 0 failed\n")) << printed.out;
  expectRefused(fettle({"info", folder.file("a.tif"), folder.file("b.asc"), "--picture", out("p.png")}),
                "--picture");
}

TEST_F(Batch, ConvertsEveryScanToTheFormatThatIsAsked) {
  const auto report =
      fettleJson({"convert", folder.file("a.tif"), folder.file("b.asc"), "--out-dir", out(), "--to", "exr"});
  EXPECT_EQ(report["done"], 2);
  EXPECT_EQ(report["files"][0]["format"], "EXR");
  EXPECT_EQ(written(), (Names{"a.exr", "b.exr"}));
}

TEST_F(Batch, WhatCannotBeWrittenBecomesATiff) {
  std::ofstream(folder.file("p.pcd")) << "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                                         "WIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n"
                                         "0 0 1\n1 0 2\n0 1 3\n1 1 4\n";
  EXPECT_EQ(fettleJson({"filter", folder.file("p.pcd"), "--out-dir", out(), "--filter", "box"})["done"], 1);
  EXPECT_EQ(written(), Names{"p.tif"});
}

TEST_F(Batch, CtrlCLeavesWholeFilesAlone) {
  for (const char* name : {"big1.tif", "big2.tif"})
    ASSERT_EQ(fettle({"synth", folder.file(name), "--size", "1500x1500"}).status, 0);
  const std::string first = out("a.tif");
  ProcessOptions options;
  // The small scan is done when its file is there, renamed into place; the next would take minutes.
  options.while_running = [&](int pid) {
    if (!std::filesystem::exists(first)) return false;
    kill(pid, SIGINT);
    return true;
  };
  const Outcome outcome =
      fettle({"filter", folder.file("a.tif"), folder.file("big1.tif"), folder.file("big2.tif"), "--out-dir",
              out(), "--filter", "median", "--window", "31", "--passes", "300"},
             options);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("cancelled after 1 of 3 scans, the written files are complete"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(written(), Names{"a.tif"});
  EXPECT_EQ(fettle({"info", first}).status, 0);
}

TEST_F(Batch, WithoutToConvertKeepsAFormatThatCanBeWrittenAndNeverReplacesAScan) {
  std::ofstream(folder.file("d.pcd")) << "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                                         "WIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n"
                                         "0 0 1\n1 0 2\n0 1 3\n1 1 4\n";
  const auto report = fettleJson(
      {"convert", folder.file("a.tif"), folder.file("b.asc"), folder.file("d.pcd"), "--out-dir", out()});
  EXPECT_EQ(report["done"], 3);
  EXPECT_EQ(written(), (Names{"a.tif", "b.asc", "d.tif"}));
  expectRefused(fettle({"convert", folder.file("a.tif"), "--out-dir", folder.path().string()}),
                "would replace an input");
  const std::string help = fettle({"convert", "--help"}).out;
  EXPECT_NE(help.find("the scan's own, or tif"), std::string::npos) << help;
}

}  // namespace
}  // namespace fettle::tests
