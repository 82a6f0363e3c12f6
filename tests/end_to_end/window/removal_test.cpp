// Samples that are removed: by height, by mark.
#include <string>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

// How many would go is read before anything is done; what is marked goes when it is named, and undo brings all back.
TEST_F(WindowTest, samples_are_removed_by_height_and_by_mark) {
  openPanels(folder, {"Remove samples"});
  const std::string work = folder.file("work.fettle"), removed = folder.file("removed.tif");
  const engine::Version field = load(scan);
  const engine::HeightBounds bounds = field.reader().bounds();
  const double limit = 0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max));
  const std::string typed = fmt::format("{:.4f} mm", limit * field.grid().height_unit.mm);
  const State by_command = jsonOf({"remove", scan, removed, "--below", typed});
  const auto program = start({scan});
  User user(display, *program, "remove");
  (void)opened(*program);
  user.at({20, 790});
  const Screen alone = user.look("scan");
  EXPECT_EQ(user.enter("lower than", typed)["would_remove"], by_command["removed"]);
  EXPECT_TRUE(user.reads("would go"));
  EXPECT_EQ(program->now()["steps"], 0);
  const State shown = user.click("Preview");
  EXPECT_EQ(shown["heights_preview"],
            fmt::format("Remove unmarked samples below {:.6g} mm", std::stod(typed)))
      << shown["notices"].dump();
  user.at({20, 790});
  const Screen holes = user.changed("without them, beside the scan", alone);
  // The preview follows.
  EXPECT_NE(user.enter("lower than", fmt::format("{} mm", bounds.min))["would_remove"],
            by_command["removed"]);
  user.at({20, 790});
  (void)user.changed("another limit", holes);
  (void)user.enter("lower than", typed);
  const State after = user.click("Remove");
  EXPECT_EQ(after["steps"], 1) << after["notices"].dump();
  EXPECT_NE(after["heights_found"].get<std::string>().find(" samples removed"), std::string::npos)
      << "it is done: " << after["heights_found"];
  EXPECT_EQ(user.key("ctrl+z")["steps"], 0);
  user.at({20, 790});
  (void)user.same("undone", alone);
  EXPECT_EQ(user.key("ctrl+shift+z")["steps"], 1);
  // By mark: nothing is marked yet.
  EXPECT_NE(user.key("ctrl+Delete")["notices"].dump().find("nothing is marked"), std::string::npos);
  EXPECT_EQ(program->now()["steps"], 1);
  EXPECT_EQ(user.key("ctrl+i")["steps"], 2) << "all is marked";
  EXPECT_EQ(program->now()["would_remove"], 0) << "and stays unless it is named";
  (void)user.key("alt+m");
  saveAs(user, work);
  (void)quit(user);
  (void)jsonOf({"replay", work, folder.file("again.tif")});
  EXPECT_EQ(compare(load(folder.file("again.tif")), load(removed)).changed, 0);
  EXPECT_EQ(jsonOf({"info", folder.file("again.tif")})["no_data"], by_command["no_data"]);
  // Its recipe has the step, with the bits of the command.
  const Outcome recipe = runProcess({FETTLE_PROGRAM, "recipe", work});
  EXPECT_NE(recipe.out.find("do = \"remove\""), std::string::npos) << recipe.out;
}

TEST_F(WindowTest, what_is_marked_is_removed_by_a_key_and_comes_back) {
  openPanels(folder, {});
  const auto program = start({scan});
  User user(display, *program, "remove marked");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("b");
  (void)user.drag(1, {240, 300}, {340, 400}, 6);
  user.at({20, 790});
  const Screen marked = user.look("marked");
  EXPECT_EQ(program->now()["steps"], 1);
  const State gone = user.key("ctrl+Delete");
  EXPECT_EQ(gone["steps"], 2) << gone["notices"].dump();
  (void)user.changed("a hole", marked, 2000);
  EXPECT_EQ(user.key("ctrl+z")["steps"], 1);
  (void)user.same("marked again", marked);
  // The panel is where one looks for it: the menu opens it.
  EXPECT_FALSE(user.reads("would go"));
  (void)user.key("alt+x");
  EXPECT_TRUE(user.reads("Limits of the colours"));
  (void)user.look("panel");
  (void)quitWithoutSaving(user);
}

}  // namespace
}  // namespace fettle::tests
