// fettle devices, and the refusals of fettle record that need no session.
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "haptic/devices/enumerate.h"
#include "tests/end_to_end/live/session.h"

namespace fettle::tests {
namespace {

nlohmann::json devicesIn(const TempFolder& folder) {
  LiveProgram program({"devices", "--json"}, folder.path().string());
  EXPECT_EQ(program.wait(), 0) << program.err();
  return program.report()["devices"];
}

nlohmann::json find(const nlohmann::json& devices, const std::string& kind) {
  for (const auto& d : devices)
    if (d["kind"] == kind) return d;
  return nullptr;
}

TEST(LiveDevices, PluggedInOnesComeAndGoWithEachCallAndBuiltInOnesAreAlwaysThere) {
  const TempFolder folder;
  fake::FakeWoody woody(folder.path().string(), "woody", Firmware::kP14, "SN7");
  nlohmann::json devices = devicesIn(folder);
  EXPECT_EQ(devices.size(), 3U);
  EXPECT_EQ(std::count_if(devices.begin(), devices.end(), [](auto& d) { return d["kind"] == "built in"; }),
            3);
  EXPECT_EQ(devices[0]["state"], "needs a window");
  woody.plug();
  ASSERT_TRUE(eventually([&] { return !find(devicesIn(folder), "woodenhaptics").is_null(); }));
  devices = devicesIn(folder);
  const nlohmann::json found = find(devices, "woodenhaptics");
  EXPECT_EQ(found["name"], "WoodenHaptics");
  EXPECT_EQ(found["serial"], "SN7");
  EXPECT_EQ(found["usb_id"], "1234:0006");
  EXPECT_EQ(found["state"], "ready");
  EXPECT_TRUE(found["force"].get<bool>());
  EXPECT_EQ(found["max_force_n"], 5.0);
  EXPECT_EQ(found["max_stiffness_n_per_mm"], 1.0);
  EXPECT_EQ(found["workspace_radius_mm"], 100.0);
  EXPECT_FALSE(found["tested_on_hardware"].get<bool>());
  woody.unplug();
  EXPECT_TRUE(eventually([&] { return find(devicesIn(folder), "woodenhaptics").is_null(); }));
}

TEST(LiveDevices, MissingSoftwareOfMakersSaysWhatToInstallAndWhereItWasLookedFor) {
  const TempFolder folder;
  LiveProgram program({"devices", "--json"}, folder.path().string());
  EXPECT_EQ(program.wait(), 0) << program.err();
  const nlohmann::json makers = program.report()["makers"];
  ASSERT_EQ(makers.size(), 3U);
  const std::vector<std::string> states{"libHD.so is not installed", "libdhd.so is not installed",
                                        "Haply's service does not answer"};
  const std::vector<std::string> places{folder.file("libHD.so") + " (FETTLE_LIBHD)",
                                        folder.file("libdhd.so") + " (FETTLE_LIBDHD)", "ws://localhost:1"};
  for (std::size_t i = 0; i < makers.size(); ++i) {
    EXPECT_EQ(makers[i]["state"], states[i]);
    EXPECT_NE(makers[i]["remedy"].get<std::string>().find(places[i]), std::string::npos) << makers[i];
  }
}

TEST(LiveDevices, ALibraryIsFoundInTheFolderWhereItsArchiveWasUnpacked) {
  const TempFolder folder;
  // What the program is started with names folders here.
  const std::filesystem::path touch = folder.file("libHD.so"), omega = folder.file("libdhd.so");
  std::filesystem::create_directories(touch);
  std::filesystem::create_directories(omega / "lib" / "release");
  std::filesystem::create_symlink(FETTLE_FAKE_DHD, omega / "lib" / "release" / "libdhd.so.3.17.6");
  LiveProgram program({"devices", "--json"}, folder.path().string());
  EXPECT_EQ(program.wait(), 0) << program.err();
  const nlohmann::json makers = program.report()["makers"];
  EXPECT_EQ(makers[1]["state"], "ready") << makers[1];
  EXPECT_NE(makers[0]["remedy"].get<std::string>().find("libHD.so in " + touch.string() +
                                                        " and the folders in it (FETTLE_LIBHD)"),
            std::string::npos)
      << makers[0];
}

TEST(LiveDevices, ALibraryThatIsNoneSaysTheLoadersWords) {
  const TempFolder folder;
  std::ofstream(folder.file("libHD.so")) << "no library";
  LiveProgram program({"devices", "--json"}, folder.path().string());
  EXPECT_EQ(program.wait(), 0) << program.err();
  const std::string state = program.report()["makers"][0]["state"];
  EXPECT_EQ(state.find("libHD.so cannot be loaded: "), 0U) << state;
}

TEST(LiveDevices, ProblemsSayWhatToDo) {
  EXPECT_NE(haptic::deviceProblem(EACCES).remedy.find("70-fettle.rules"), std::string::npos);
  EXPECT_EQ(haptic::deviceProblem(EACCES).what, "no permission");
  EXPECT_EQ(haptic::deviceProblem(EBUSY).what, "busy");
  EXPECT_EQ(haptic::deviceProblem(0).what, "");
}

void expectRefused(const Session& plate, const TempFolder& folder, const std::vector<std::string>& arguments,
                   const std::string& part) {
  std::vector<std::string> all{"record", plate.scan, folder.file("s.csv"), folder.file("o.tif"), "--device"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  LiveProgram program(all, folder.path().string());
  EXPECT_EQ(program.wait(), 2) << program.err();
  EXPECT_NE(program.err().find(part), std::string::npos) << program.err();
  EXPECT_EQ(program.out(), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(LiveDevices, SessionsThatCannotBeAreRefusedBeforeAnythingMoves) {
  const TempFolder folder;
  Session plate(Firmware::kW8, {"--seconds", "0.1"});
  EXPECT_EQ(plate.program->wait(), 0) << plate.program->err();
  expectRefused(plate, folder, {"mouse"}, "needs a window");
  expectRefused(plate, folder, {"hand"}, "hand:STROKES");
  expectRefused(plate, folder, {"hand:/nowhere.csv"}, "/nowhere.csv");
  expectRefused(plate, folder, {"/dev/hidraw99"}, "no such device");
  expectRefused(plate, folder, {"touch"}, "libHD.so is not installed");
  expectRefused(plate, folder, {"forcedimension:0"}, "FETTLE_LIBDHD");
  expectRefused(plate, folder, {"woodenhaptics", "--arm", "auto"}, "armed by the person");
  expectRefused(plate, folder, {"woodenhaptics", "--scale", "3"}, "softer spring");
  expectRefused(plate, folder, {"woodenhaptics", "--rate", "50"}, "--rate");
}

}  // namespace
}  // namespace fettle::tests
