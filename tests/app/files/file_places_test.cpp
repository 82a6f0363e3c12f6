#include "app/files/file_places.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

std::vector<std::string> foldersOf(const std::vector<FilePlace>& places) {
  std::vector<std::string> folders;
  for (const FilePlace& place : places) folders.push_back(place.folder);
  return folders;
}

TEST(FilePlaces, are_own_home_desktop_and_recent_each_once_and_only_where_they_exist) {
  const tests::TempFolder home;
  const auto make = [&](const char* name) {
    std::filesystem::create_directories(home.path() / name);
    return home.file(name);
  };
  const std::string scans = make("big scans"), archive = make("archive"), own = make("own");
  make("gtk-3.0");
  std::ofstream(home.file("gtk-3.0/bookmarks"))
      << "file://" << home.path().string() << "/big%20scans Scans of today\n"
      << "sftp://host/there\nfile:///no/such/folder\n";
  setenv("HOME", home.path().c_str(), 1);
  setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  FilePlaces places(home.file("bookmarks.txt"));
  places.toggle(own);
  places.toggle("/gone/meanwhile");
  const auto all =
      places.places({archive + "/a.tif", archive + "/b.tif", scans + "/c.tif", "/no/such/d.tif"});
  EXPECT_EQ(foldersOf(all), (std::vector<std::string>{own, home.path().string(), scans, archive}));
  EXPECT_TRUE(all[0].own);
  EXPECT_EQ(all[2].name, "Scans of today");
  EXPECT_EQ(all[3].name, "archive");
}

TEST(FilePlaces, bookmarks_stay_for_the_next_run_until_they_are_taken_back) {
  const tests::TempFolder folder;
  const std::string file = folder.file("bookmarks.txt");
  FilePlaces(file).toggle(folder.path().string());
  EXPECT_TRUE(FilePlaces(file).has(folder.path().string()));
  FilePlaces(file).toggle("a\nb");
  EXPECT_FALSE(FilePlaces(file).has("a"));
  FilePlaces(file).toggle(folder.path().string());
  EXPECT_FALSE(FilePlaces(file).has(folder.path().string()));
}

TEST(PathOfUri, decodes_what_is_encoded_and_leaves_the_rest) {
  EXPECT_EQ(pathOfUri("file:///a%20b/%C3%A4"), "/a b/\xC3\xA4");
  EXPECT_EQ(pathOfUri("file:///100%"), "/100%");
  EXPECT_EQ(pathOfUri("file:///%zz"), "/%zz");
  EXPECT_EQ(pathOfUri("http://a"), "");
}

}  // namespace
}  // namespace fettle::app
