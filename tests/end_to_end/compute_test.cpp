// fettle filter --compute: which processor filters, what the report says of it, and a device that is not there or is
// lost: a Vulkan layer between program and driver takes it away (tests/end_to_end/window/lose_device_layer.cpp).
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class ComputeOption : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(fettle({"synth", scan, "--part", "steps", "--size", "96x64"}).status, 0);
  }
  void TearDown() override {
    for (const char* name : set_) unsetenv(name);
  }
  // For the programs that the case starts.
  void set(const char* name, const std::string& value) {
    setenv(name, value.c_str(), 1);
    set_.push_back(name);
  }
  // Puts the layer between program and driver.
  void order(const std::string& orders) {
    set("VK_ADD_LAYER_PATH", FETTLE_LAYER_FOLDER);
    set("VK_INSTANCE_LAYERS", "VK_LAYER_FETTLE_lose_device");
    const std::string path = folder.file("orders.txt");
    std::ofstream(path) << orders;
    set("FETTLE_LOSE_DEVICE", path);
  }
  [[nodiscard]] std::vector<std::string> tgv(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"filter", scan, out, "--filter", "tgv"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  TempFolder folder;
  std::string scan = folder.file("scan.tif"), out = folder.file("out.tif");

 private:
  std::vector<const char*> set_;
};

TEST_F(ComputeOption, NamesTheProcessorThatFiltered) {
  const auto here = fettleJson(tgv({"--compute", "cpu"}));
  EXPECT_EQ(here["compute"], "cpu");
  EXPECT_FALSE(here.contains("device"));
  const auto there = fettleJson(tgv({"--compute", "gpu"}));
  EXPECT_EQ(there["compute"], "gpu");
  EXPECT_FALSE(there["device"].get<std::string>().empty());
  EXPECT_FALSE(there.contains("warnings"));
  EXPECT_EQ(there["range_sigma"], here["range_sigma"]);
  const Outcome text = fettle(tgv({"--compute", "gpu"}));
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("compute"), std::string::npos);
  EXPECT_EQ(text.err, "");
}

TEST_F(ComputeOption, GivesTheSameBitsForAnyThreadsAndScansOneAfterTheOther) {
  const auto alone = fettleJson(tgv({"--compute", "gpu", "--threads", "1"}));
  const std::string copy = folder.file("copy.tif"), many = (folder.path() / "many").string();
  std::filesystem::copy_file(scan, copy);
  const auto both = fettleJson(
      {"filter", scan, copy, "--out-dir", many, "--filter", "tgv", "--compute", "gpu", "--threads", "2"});
  ASSERT_EQ(both["done"], 2);
  for (const auto& file : both["files"]) {
    EXPECT_EQ(file["hash"], alone["hash"]);
    EXPECT_EQ(file["device"], alone["device"]);
  }
}

TEST_F(ComputeOption, RefusesFiltersThatRunOnTheProcessorAlone) {
  expectRefused(fettle({"filter", scan, out, "--filter", "median", "--compute", "gpu"}), "tgv");
  EXPECT_EQ(fettleJson({"filter", scan, out, "--filter", "median"})["compute"], "cpu");
  expectRefused(fettle(tgv({"--compute", "card"})), "--compute");
}

TEST_F(ComputeOption, WithoutADriverIsAnErrorOnRequestAndTheProcessorByItself) {
  set("VK_ICD_FILENAMES", folder.file("none.json"));
  set("VK_DRIVER_FILES", folder.file("none.json"));
  expectFailed(fettle(tgv({"--compute", "gpu"})), "Vulkan");
  const Outcome by_itself = fettle(tgv({}));
  EXPECT_EQ(by_itself.status, 0);
  EXPECT_EQ(by_itself.err, "");
}

TEST_F(ComputeOption, ByItselfTakesAGraphicsCard) {
  const auto here = fettleJson(tgv({"--compute", "cpu"}));
  const auto requested = fettleJson(tgv({"--compute", "gpu"}));
  order("");
  set("FETTLE_AS_HARDWARE", "1");
  const auto card = fettleJson(tgv({}));
  EXPECT_EQ(card["compute"], "gpu");
  EXPECT_EQ(card["hash"], requested["hash"]);
  EXPECT_EQ(fettleJson(tgv({"--compute", "cpu"}))["hash"], here["hash"]);
}

TEST_F(ComputeOption, ByItselfGoesOnWithTheProcessorWhenTheCardIsLost) {
  const auto here = fettleJson(tgv({"--compute", "cpu"}));
  set("FETTLE_AS_HARDWARE", "1");
  for (const std::string orders :
       {"lose compute\n", "pass compute\npass compute\nlose compute\n", "memory\n", "refuse\n"}) {
    order(orders);
    const auto fallen = fettleJson(tgv({}));
    EXPECT_EQ(fallen["compute"], "cpu") << orders;
    EXPECT_EQ(fallen["hash"], here["hash"]) << orders;
    // A device that does not start is as none.
    const bool none = orders == "refuse\n";
    ASSERT_EQ(fallen.contains("warnings"), !none) << orders;
    if (none) continue;
    ASSERT_EQ(fallen["warnings"].size(), 1U);
    EXPECT_NE(fallen["warnings"][0].get<std::string>().find("the processor filters"), std::string::npos);
  }
}

TEST_F(ComputeOption, OnRequestIsAnErrorWhenTheDeviceIsLostAndWritesNothing) {
  for (const char* orders : {"lose compute\n", "pass compute\npass compute\nlose compute\n", "memory\n"}) {
    order(orders);
    expectFailed(fettle(tgv({"--compute", "gpu"})), "use --compute cpu");
    EXPECT_FALSE(std::filesystem::exists(out)) << orders;
  }
}

}  // namespace
}  // namespace fettle::tests
