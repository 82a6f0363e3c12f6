#include "app/files/file_browser.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

class FileBrowserTest : public ::testing::Test {
 protected:
  FileBrowserTest() {
    std::filesystem::create_directory(folder.path() / "deep");
    for (const char* name : {"a.tif", "b.tif", "c.png", "deep/d.tif"})
      std::ofstream(folder.file(name)) << "x";
  }
  void arrive() {
    while (browser.busy()) {
      (void)browser.poll();
      std::this_thread::yield();
    }
  }
  [[nodiscard]] std::string chosenName() const {
    return browser.chosen() ? browser.entry(*browser.chosen()).name : "";
  }
  tests::TempFolder folder;
  FileBrowser browser;
};

TEST_F(FileBrowserTest, moves_through_a_folder_and_stops_at_its_ends) {
  browser.move(1);
  EXPECT_FALSE(browser.chosen()) << "nothing is listed yet";
  browser.goTo(folder.path().string(), "b.tif");
  arrive();
  ASSERT_EQ(browser.count(), 4U);
  EXPECT_EQ(chosenName(), "b.tif");
  EXPECT_EQ(browser.pathOf(*browser.chosen()), folder.file("b.tif"));
  browser.move(1);
  EXPECT_EQ(chosenName(), "c.png");
  browser.move(100);
  EXPECT_EQ(chosenName(), "c.png");
  browser.move(-100);
  EXPECT_EQ(chosenName(), "deep");
}

TEST_F(FileBrowserTest, what_was_typed_in_one_dialog_does_not_narrow_the_list_of_the_next) {
  browser.goTo(folder.path().string());
  arrive();
  browser.narrow("a.tif");
  EXPECT_EQ(browser.count(), 1U);
  browser.begin(folder.path().string(), "b.tif");
  arrive();
  EXPECT_EQ(browser.view().typed, "");
  EXPECT_EQ(browser.count(), 4U);
  EXPECT_EQ(chosenName(), "b.tif");
}

TEST_F(FileBrowserTest, goes_down_and_up_again_to_where_it_came_from) {
  browser.goTo(folder.file("deep"));
  arrive();
  EXPECT_FALSE(browser.chosen());
  browser.goUp();
  EXPECT_EQ(browser.folder(), folder.file("deep")) << "on the screen until the other is listed";
  arrive();
  EXPECT_EQ(browser.folder(), folder.path().string());
  EXPECT_EQ(chosenName(), "deep");
}

TEST_F(FileBrowserTest, narrows_to_what_is_typed_and_goes_on_with_it_as_far_as_names_agree) {
  for (const char* name : {"tray_one.tif", "tray_two.tif"}) std::ofstream(folder.file(name)) << "x";
  browser.goTo(folder.path().string(), "", "tray");
  arrive();
  EXPECT_EQ(browser.count(), 2U) << "typed for the folder that is gone to";
  EXPECT_EQ(browser.completion("t"), "tray_");
  EXPECT_EQ(browser.completion("tray_t"), "tray_two.tif");
  EXPECT_EQ(browser.completion("x"), "x");
  browser.narrow("tray_one.tif");
  EXPECT_EQ(chosenName(), "tray_one.tif");
  browser.narrow("de");
  EXPECT_EQ(browser.completion("de"), "deep/");
}

TEST_F(FileBrowserTest, keeps_the_choice_while_the_view_changes_as_long_as_it_is_shown) {
  browser.goTo(folder.path().string(), "b.tif");
  arrive();
  browser.setView({.order = FolderOrder::kName, .descending = true});
  EXPECT_EQ(chosenName(), "b.tif");
  browser.setView({.typed = "a"});
  EXPECT_EQ(browser.count(), 1U);
  EXPECT_FALSE(browser.chosen());
}

TEST_F(FileBrowserTest, stays_where_it_is_when_a_folder_cannot_be_listed) {
  browser.goTo(folder.path().string());
  arrive();
  browser.goTo(folder.file("gone"));
  arrive();
  ASSERT_NE(browser.problem(), nullptr);
  EXPECT_EQ(browser.problem()->where, folder.file("gone"));
  EXPECT_EQ(browser.folder(), folder.path().string());
  EXPECT_EQ(browser.count(), 4U);
  browser.refresh();
  arrive();
  EXPECT_EQ(browser.problem(), nullptr);
}

}  // namespace
}  // namespace fettle::app
