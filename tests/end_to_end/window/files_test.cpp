// A scan found and read: the start page, the dialog of files, the page on which its reading is chosen.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "engine/formats/formats.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;
namespace fs = std::filesystem;

bool opens(const State& s) {
  return s["dialog"] == "open" && s["settled"] == true;
}

bool says(const State& s, const std::string& what) {
  for (const State& text : s["texts"])
    if (text["text"].get<std::string>().find(what) != std::string::npos) return true;
  return false;
}

// A raster of counts without a unit, with an undeclared number for its holes.
std::string writeCounts(const std::string& path) {
  std::ofstream file(path);
  file << "ncols 96\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  for (int r = 0; r < 64; ++r) {
    for (int c = 0; c < 96; ++c) file << (c < 10 ? 9999 : 100 + (7 * c + 13 * r) % 29) << " ";
    file << "\n";
  }
  return path;
}

TEST_F(WindowTest, a_scan_is_found_with_the_arrow_keys_and_in_another_folder) {
  const fs::path scans = folder.path() / "scans";
  fs::create_directories(scans / "deeper");
  for (const char* name : {"part2.tif", "part10.tif", "deeper/last.tif"}) fs::copy_file(scan, scans / name);
  const std::string first = (scans / "part2.tif").string();
  const auto program = start({first});
  User user(display, *program, "find");
  (void)opened(*program);
  (void)user.press("ctrl+o");
  const State begun = program->until("the dialog", opens);
  EXPECT_EQ(begun["dialog_path"], first);
  EXPECT_TRUE(says(begun, "part10.tif"));
  EXPECT_TRUE(says(begun, "samples")) << "the chosen one is shown with its size";
  (void)user.look("the dialog");
  for (const auto& [key, name] : {std::pair{"Down", "part10.tif"}, {"Up", "part2.tif"}, {"Up", "deeper"}}) {
    (void)user.press(key);
    (void)user.look(key);
    program->until(key, [&](const State& s) { return s["dialog_path"] == (scans / name).string(); });
  }
  // Enter goes into a folder, and opens nothing.
  (void)user.press("Return");
  const State deeper =
      program->until("in it", [](const State& s) { return opens(s) && says(s, "last.tif"); });
  (void)user.click("last.tif", 2);
  program->until("the scan", [&](const State& s) {
    return s["path"] == (scans / "deeper" / "last.tif").string() && s["settled"] == true;
  });
  quit(user);
}

TEST_F(WindowTest, the_page_of_a_scan_to_be_read_is_whole_with_large_letters) {
  const auto program = start({scan, "--ui-scale", "2"});
  User user(display, *program, "large import");
  (void)opened(*program);
  (void)user.press("ctrl+shift+o");
  const State page = program->until(
      "the page", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  (void)user.look("the page");
  int buttons = 0;
  for (const State& text : page["texts"]) {
    const State& at = text["at"];
    if (text["text"] != "Open (Enter)" && text["text"] != "Go back (Esc)") continue;
    ++buttons;
    EXPECT_LE(at[1].get<int>() + at[3].get<int>(), height_) << text.dump();
    EXPECT_EQ(text["cut"], false) << text.dump();
  }
  EXPECT_EQ(buttons, 2) << page["texts"].dump();
  (void)user.key("Escape");
  quit(user);
}

TEST_F(WindowTest, a_scan_is_found_and_what_is_asked_about_it_is_read_with_large_letters) {
  const std::string counts = writeCounts(folder.file("a_plate_of_counts.asc"));
  const auto program = start({scan, "--ui-scale", "2"});
  User user(display, *program, "large dialog");
  (void)opened(*program);
  (void)user.press("ctrl+o");
  program->until("the dialog", opens);
  user.type(folder.path().string() + "/");
  const auto whole = [](const State& s, const std::string& what) {
    return std::ranges::any_of(s["texts"], [&](const State& text) {
      return text["text"].get<std::string>().find(what) != std::string::npos && text["cut"] == false;
    });
  };
  const State listed =
      program->until("the names of files", [](const State& s) { return opens(s) && says(s, "a_plate"); });
  (void)user.look("names");
  // The column of the dates has gone, and not the names.
  EXPECT_TRUE(whole(listed, "a_plate_of_counts.asc")) << listed["texts"].dump();
  EXPECT_TRUE(says(listed, "name"));
  EXPECT_FALSE(says(listed, "changed"));
  user.write("a_plate_of_counts.asc");
  program->until("its path", [&](const State& s) { return s["dialog_path"] == counts && opens(s); });
  (void)user.press("Return");
  const State page = program->until(
      "what is asked", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  (void)user.look("asked");
  EXPECT_TRUE(whole(page, "It does not say all about its numbers.")) << page["texts"].dump();
  EXPECT_TRUE(whole(page, "read below.")) << page["texts"].dump();
  EXPECT_TRUE(whole(page, "Open (Enter)"));
  (void)user.press("Escape");
  program->until("the dialog again", opens);
  (void)user.key("Escape");
  quit(user);
}

TEST_F(WindowTest, a_scan_without_units_is_read_as_a_person_says_and_read_anew) {
  const std::string counts = writeCounts(folder.file("counts.asc"));
  const auto program = start({});
  User user(display, *program, "import");
  program->until("an empty window", [](const State& s) { return says(s, "Drop a scan here"); });
  (void)user.press("ctrl+o");
  program->until("the dialog", opens);
  user.type(counts);
  EXPECT_TRUE(says(user.rest("the preview"), "guessed; set by")) << "where the guesses are set";
  (void)user.click("Read as ...");
  const State page = program->until(
      "the page", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  EXPECT_TRUE(says(page, "96 x 64 samples"));
  EXPECT_TRUE(says(page, "9999 are holes"));
  (void)user.look("the page");
  user.writeOver("as in the file, else 1", "0.001");
  user.writeOver("1 in the file", "0");
  (void)user.press("Return");
  program->until("a spacing of 0 is refused",
                 [](const State& s) { return s["dialog"] == "import" && says(s, "give a number above 0"); });
  user.writeOver("0", "0.05");
  (void)user.click("9999 are holes");
  (void)user.look("read as said");
  (void)user.key("Return");
  const State read =
      program->until("the scan", [&](const State& s) { return s["path"] == counts && s["settled"] == true; });
  EXPECT_TRUE(says(read, "0.05")) << read["status"];
  ASSERT_FALSE(read["notices"].empty());
  for (const State& notice : read["notices"])
    EXPECT_TRUE(notice.get<std::string>().starts_with("counts.asc")) << notice;
  EXPECT_GE(read["colours"][0].get<double>(), 0.09) << "the holes are holes, the counts are thousandths";
  EXPECT_LE(read["colours"][1].get<double>(), 0.14);
  // Another unit later, without looking for the file again; what was said before stands there.
  (void)user.press("ctrl+shift+o");
  program->until("the page", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  user.writeOver("0.001", "0.002");
  (void)user.key("Return");
  const State again = program->until("twice as high", [&](const State& s) {
    return s["settled"] == true && s["dialog"] == "none" && s["colours"][1].get<double>() > 0.2;
  });
  EXPECT_EQ(again["path"], counts);
  EXPECT_EQ(again["notices"].size(), read["notices"].size())
      << "those of before went with what they were about";
  quit(user);
  // It is read so from now on.
  const auto next = start({counts});
  User later(display, *next, "import again");
  const State remembered = opened(*next);
  EXPECT_EQ(remembered["colours"], again["colours"]);
  quit(later);
}

TEST_F(WindowTest, a_depth_camera_is_said_by_one_number) {
  const std::string depth = folder.file("depth.png");
  const Outcome made = runProcess({FETTLE_PROGRAM, "convert", scan, depth});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({});
  User user(display, *program, "camera");
  program->until("an empty window", [](const State& s) { return says(s, "Drop a scan here"); });
  (void)user.press("ctrl+o");
  program->until("the dialog", opens);
  user.type(depth);
  (void)user.rest();
  (void)user.click("Read as ...");
  program->until("the page", [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; });
  (void)user.click("distances from a depth camera");
  user.writeOver("fx", "525");
  const State said = program->until("the spacing", [](const State& s) { return says(s, "by the camera"); });
  EXPECT_TRUE(says(said, "cx: middle")) << said["texts"].dump();
  (void)user.rest();
  (void)user.look("one number");
  (void)user.key("Return");
  const State read =
      program->until("the scan", [&](const State& s) { return s["path"] == depth && s["settled"] == true; });
  EXPECT_NE(read["notices"].dump().find("perspective"), std::string::npos) << read["notices"].dump();
  EXPECT_EQ(read["inverted"], true) << "what is near to the camera is high";
  (void)user.look("near is high");
  quit(user);
}

TEST_F(WindowTest, what_had_to_be_guessed_is_asked_before_a_scan_is_opened_and_once) {
  const auto asked = [](const State& s) { return s["dialog"] == "import" && s["settled"] == true; };
  const std::string counts = writeCounts(folder.file("counts.asc"));
  const std::string other_counts = writeCounts(folder.file("other.asc"));
  const auto program = start({});
  User user(display, *program, "guessed");
  program->until("an empty window", [](const State& s) { return says(s, "Drop a scan here"); });
  (void)user.press("ctrl+o");
  program->until("the dialog", opens);
  user.type(counts);
  (void)user.rest();
  (void)user.press("Return");
  const State page = program->until("the page by itself", asked);
  (void)user.look("the page by itself");
  EXPECT_EQ(page["path"], "") << "nothing is open before";
  EXPECT_TRUE(says(page, "mm, guessed"));
  EXPECT_TRUE(says(page, "from the file: spacing"));
  EXPECT_TRUE(says(page, "to 9999 mm")) << "the true highest";
  EXPECT_FALSE(says(page, "--")) << "no words of the command line";
  EXPECT_FALSE(says(page, "cell size")) << "it is no cloud of points";
  EXPECT_FALSE(says(page, "depth camera"));
  // Who goes back has opened nothing, and is where the file was chosen.
  (void)user.press("Escape");
  const State back = program->until(
      "the dialog again", [](const State& s) { return s["dialog"] == "open" && s["settled"] == true; });
  EXPECT_EQ(back["dialog_path"], counts);
  EXPECT_EQ(back["path"], "");
  (void)user.press("Escape");
  program->until("the start page",
                 [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  EXPECT_EQ(program->now()["path"], "");
  (void)user.press("ctrl+o");
  program->until("the dialog", opens);
  user.type(counts);
  (void)user.rest();
  (void)user.press("Return");
  program->until("the page again", asked);
  (void)user.click("9999 are holes");
  const State said = user.rest();
  EXPECT_TRUE(says(said, "as you say: no data 9999")) << said["texts"].dump();
  EXPECT_TRUE(says(said, "guessed:")) << "the unit still is";
  (void)user.press("Return");
  const State read =
      program->until("the scan", [&](const State& s) { return s["path"] == counts && s["settled"] == true; });
  EXPECT_TRUE(says(read, "is read as you said: no data 9999"));
  EXPECT_FALSE(says(read, "--"));
  // Its button leads to the page, and going back from there to the scan.
  (void)user.click("Read as ...");
  program->until("the page from the notice", asked);
  (void)user.press("Escape");
  program->until("the scan again",
                 [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  // It asks for nothing, and goes by itself.
  program->until("its notice gone", [](const State& s) {
    return s["notices"].dump().find("is read as you said") == std::string::npos;
  });
  // As it was guessed, by Enter; it is not asked a second time.
  const std::uint32_t window = other.windowOf("fettle");
  EXPECT_EQ(other.drop(window, {other_counts}), "");
  program->until("the page of the other", asked);
  (void)user.press("Return");
  program->until("the other",
                 [&](const State& s) { return s["path"] == other_counts && s["settled"] == true; });
  for (const std::string& path : {counts, other_counts}) {
    EXPECT_EQ(other.drop(window, {path}), "");
    program->until("opened at once", [&](const State& s) {
      EXPECT_NE(s["dialog"], "import") << path;
      return s["path"] == path && s["settled"] == true;
    });
  }
  quit(user);
}

TEST_F(WindowTest, a_scan_of_the_command_line_is_opened_at_once_and_says_what_was_guessed) {
  const std::string counts = writeCounts(folder.file("counts.asc"));
  const auto program = start({counts});
  User user(display, *program, "command line");
  const State read = opened(*program);
  const std::string notices = read["notices"].dump();
  EXPECT_NE(notices.find("mm is assumed: set"), std::string::npos) << notices;
  EXPECT_NE(notices.find("to 9999\""), std::string::npos) << notices;
  EXPECT_TRUE(says(read, "Read as ...")) << "a button for the page";
  EXPECT_FALSE(says(read, "--"));
  (void)user.look("opened");
  quit(user);
}

TEST_F(WindowTest, the_start_page_shows_what_was_opened_last_and_has_a_sample) {
  {
    const auto program = start({});
    User user(display, *program, "sample");
    program->until("an empty window", [](const State& s) { return says(s, "A sample part"); });
    (void)user.click("A sample part");
    const State sample =
        program->until("the sample", [](const State& s) { return s["path"] != "" && s["settled"] == true; });
    EXPECT_TRUE(sample["path"].get<std::string>().ends_with("sample part.tif"));
    quit(user);
  }
  const auto program = start({});
  User user(display, *program, "recent");
  program->until("a window", [](const State& s) { return says(s, "A sample part"); });
  (void)user.look("at first");
  program->until("the start page",
                 [](const State& s) { return says(s, "sample part.tif (Ctrl+1)") && s["settled"] == true; });
  const Screen page = user.look("the start page");
  (void)user.press("ctrl+1");
  EXPECT_TRUE(opened(*program)["path"].get<std::string>().ends_with("sample part.tif"));
  quit(user);
}

TEST_F(WindowTest, the_format_of_what_is_exported_is_chosen_from_a_list) {
  const auto program = start({scan});
  User user(display, *program, "format");
  (void)opened(*program);
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  // The folder as it is, not narrowed by a name that was typed elsewhere.
  EXPECT_TRUE(user.reads("names with"));
  const std::string path = folder.file("out.tif");
  user.type(path);
  (void)user.rest();
  (void)user.look("export");
  (void)user.click("GeoTIFF and TIFF");
  (void)user.look("formats");
  (void)user.click("16-bit grey PNG (.png)");
  program->until("its extension", [&](const State& s) { return s["dialog_path"] == folder.file("out.png"); });
  (void)user.press("Return");
  program->until("written",
                 [&](const State& s) { return s["status"] == "written: " + folder.file("out.png"); });
  EXPECT_TRUE(fs::exists(folder.file("out.png")));
  quit(user);
}

TEST_F(WindowTest, a_scan_of_a_relative_path_is_exported_beside_itself) {
  const fs::path before = fs::current_path();
  fs::create_directories(folder.path() / "parts");
  fs::copy_file(scan, folder.path() / "parts" / "one.tif");
  fs::current_path(folder.path());
  const auto program = start({"parts/one.tif"});
  User user(display, *program, "relative");
  (void)opened(*program);
  fs::current_path(before);
  (void)user.press("ctrl+e");
  const State asked = program->until(
      "where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  const std::string beside = folder.file("parts/one_fettled.tif");
  EXPECT_EQ(asked["dialog_path"], beside);
  (void)user.press("Return");
  program->until("written", [&](const State& s) { return s["status"] == "written: " + beside; });
  EXPECT_TRUE(fs::exists(beside));
  quit(user);
}

TEST_F(WindowTest, a_mesh_for_cad_is_in_mm_unless_the_unit_of_the_scan_is_chosen) {
  const std::string in_um = folder.file("um.tif"), by_command = folder.file("command.stl");
  engine::JobControl job;
  engine::Version field = load(scan);
  engine::Grid grid = field.grid();
  grid.lateral_unit = grid.height_unit = {"um", 1e-3};
  ASSERT_TRUE(engine::exportField(field.withGrid(grid), in_um, {}, job));
  const auto program = start({in_um});
  User user(display, *program, "mesh");
  (void)opened(*program);
  const auto written = [&](const std::string& path) {
    return program->until(
        "written", [&](const State& s) { return s["status"] == "written: " + path && s["settled"] == true; });
  };
  const auto bytesOf = [](const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  };
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  user.type(folder.file("cad.stl"));
  (void)user.rest();
  EXPECT_TRUE(user.reads("mm, as CAD programs take them"));
  (void)user.look("in mm");
  (void)user.press("Return");
  const State cad = written(folder.file("cad.stl"));
  EXPECT_NE(cad["notices"].dump().find("all lengths are in mm"), std::string::npos) << cad["notices"];
  EXPECT_TRUE(bytesOf(folder.file("cad.stl")).starts_with("field, units mm"));
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "convert", in_um, by_command, "--mesh-unit", "mm"}).status, 0);
  EXPECT_EQ(bytesOf(folder.file("cad.stl")), bytesOf(by_command));
  // In the scan's own unit, with every bit.
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  user.type(folder.file("own.stl"));
  (void)user.rest();
  (void)user.click("mm, as CAD programs take them");
  (void)user.click("\u00b5m, as the scan");
  (void)user.look("in um");
  (void)user.press("Return");
  EXPECT_NE(written(folder.file("own.stl"))["notices"].dump().find("all lengths are in um"),
            std::string::npos);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "convert", in_um, by_command, "--force"}).status, 0);
  EXPECT_EQ(bytesOf(folder.file("own.stl")), bytesOf(by_command));
  quit(user);
}

// Who writes a PNG sees which names are taken.
TEST_F(WindowTest, a_dialog_that_writes_lists_the_files_of_its_format) {
  std::ofstream(folder.file("taken.png")) << "no picture";
  const auto program = start({scan});
  User user(display, *program, "by format");
  (void)opened(*program);
  const auto lists = [](const State& s, const char* name) {
    return std::any_of(s["texts"].begin(), s["texts"].end(),
                       [&](const State& text) { return text["text"] == name; });
  };
  (void)user.press("ctrl+e");
  program->until("those of a TIFF", [&](const State& s) {
    return s["dialog"] == "export" && s["text_field"] == true && lists(s, "part.tif") &&
           !lists(s, "taken.png");
  });
  user.type(folder.file("new.png"));
  program->until("those of a PNG", [&](const State& s) {
    return s["settled"] == true && lists(s, "taken.png") && !lists(s, "part.tif");
  });
  (void)user.look("by format");
  (void)user.press("Escape");
  program->until("the scan", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  quit(user);
}

TEST_F(WindowTest, a_dialog_stays_with_what_is_wrong_with_its_file) {
  const std::string broken = folder.file("broken.tif");
  std::ofstream(broken) << "II*";  // and nothing behind it
  const auto program = start({scan});
  User user(display, *program, "unreadable");
  (void)opened(*program);
  // It is written in the frame after the one in which it is found.
  const auto wrong = [](const char* name, const State& s) {
    return s["dialog"] == "open" && s["settled"] == true && s["message"] != "" && says(s, name);
  };
  (void)user.press("ctrl+o");
  program->until("the dialog", opens);
  user.type(folder.file("nothing.tif"));
  (void)user.press("Return");
  const State missing = program->until(
      "no such file", [&](const State& s) { return wrong("there is no file nothing.tif", s); });
  EXPECT_NE(missing["message"].get<std::string>().find("there is no file nothing.tif"), std::string::npos);
  (void)user.look("no such file");
  user.type(broken);
  const State another = program->until("another name", [&](const State& s) {
    return opens(s) && s["dialog_path"] == broken && s["message"] == "";
  });
  EXPECT_FALSE(says(another, "there is no file"));
  (void)user.press("Return");
  const State unread = program->until("a broken one", [&](const State& s) { return wrong("broken.tif", s); });
  EXPECT_EQ(unread["dialog_path"], broken);
  EXPECT_EQ(unread["path"], scan) << "the scan stays open";
  (void)user.look("a broken one");
  (void)user.press("Escape");
  program->until("the scan", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  // Nor is what was typed lost where nothing can be written.
  (void)user.press("ctrl+e");
  program->until("where to",
                 [](const State& s) { return s["dialog"] == "export" && s["text_field"] == true; });
  const std::string nowhere = folder.file("nowhere/out.tif"), out = folder.file("out.tif");
  user.type(nowhere);
  (void)user.press("Return");
  const State refused_place = program->until("no such folder", [](const State& s) {
    return s["dialog"] == "export" && s["settled"] == true && says(s, "there is no such folder");
  });
  EXPECT_EQ(refused_place["dialog_path"], nowhere);
  (void)user.look("no such folder");
  user.type(out);
  (void)user.press("Return");
  program->until("written", [&](const State& s) { return s["status"] == "written: " + out; });
  // Neither is another scan taken that is none.
  for (const auto& [key, dialog] : {std::pair("alt+b", "compare"), {"alt+j", "join"}}) {
    (void)user.press(key);
    program->until("the dialog", [&, dialog = dialog](const State& s) {
      return s["dialog"] == dialog && s["settled"] == true && s["text_field"] == true;
    });
    user.type(broken);
    (void)user.press("Return");
    const State refused = program->until("a broken one", [&, dialog = dialog](const State& s) {
      return s["dialog"] == dialog && s["settled"] == true && s["message"] != "" && says(s, "broken.tif");
    });
    EXPECT_EQ(refused["notices"], State::array()) << dialog;
    (void)user.look(dialog);
    (void)user.press("Escape");
    program->until("the scan", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  }
  quit(user);
}

}  // namespace
}  // namespace fettle::tests
