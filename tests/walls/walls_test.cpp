// What a room may include: docs/rooms.txt against every #include of the product.

#include "tests/walls/walls.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/support/source_tree.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

const Walls& walls() {
  static const Walls read = readWalls(contentOf(inSourceTree("docs/rooms.txt")));
  return read;
}

// Path from the top of the tree -> what stands in it.
const std::map<std::string, std::string>& product() {
  static const std::map<std::string, std::string> files = [] {
    std::map<std::string, std::string> found;
    const fs::path top = inSourceTree("");
    for (const char* folder : {"engine", "haptic", "shaders", "render", "bench", "app", "python"})
      for (const auto& entry : fs::recursive_directory_iterator(top / folder))
        if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
          found[fs::relative(entry.path(), top).generic_string()] = contentOf(entry.path());
    return found;
  }();
  return files;
}

TEST(Walls, NoFileIncludesWhatItsRoomMayNot) {
  ASSERT_GT(product().size(), 500U);
  for (const auto& [path, text] : product())
    for (const std::string& wrong : wrongIncludes(walls(), path, text)) ADD_FAILURE() << wrong;
}

TEST(Walls, RoomsIncludeOnlyRoomsAboveThemInTheTableSoThereIsNoCircle) {
  std::set<std::string> above;
  for (const Walls::Room& room : walls().rooms) {
    for (const std::string& other : room.rooms)
      EXPECT_TRUE(above.contains(other))
          << room.name << " may include " << other << ", which is not above it";
    EXPECT_TRUE(above.insert(room.name).second) << room.name << " stands there twice";
  }
}

TEST(Walls, TheTableAllowsNothingThatNobodyUses) {
  std::map<std::string, Named> used;
  for (const auto& [path, text] : product()) {
    const Walls::Room* room = walls().roomOf(path);
    if (room == nullptr) continue;  // said by the first test
    Named named = namedBy(walls(), path, text);
    used[room->name].rooms.merge(named.rooms);
    used[room->name].libraries.merge(named.libraries);
  }
  for (const Walls::Room& room : walls().rooms) {
    ASSERT_TRUE(used.contains(room.name)) << room.name << " has no file";
    EXPECT_EQ(room.rooms, used[room.name].rooms) << room.name;
    EXPECT_EQ(room.libraries, used[room.name].libraries) << room.name;
  }
}

TEST(Walls, AWrongIncludePlantedInAnyRoomIsFound) {
  for (const Walls::Room& room : walls().rooms) {
    const std::string path = room.name + "/planted.cpp";
    for (const Walls::Room& other : walls().rooms) {
      const auto found = wrongIncludes(walls(), path, "#include \"" + other.name + "/planted.h\"\n");
      EXPECT_EQ(found.empty(), &other == &room || room.rooms.contains(other.name))
          << room.name << " and " << other.name;
    }
    for (const Walls::Library& library : walls().libraries) {
      const auto found =
          wrongIncludes(walls(), path, "#include <" + library.beginnings.front() + "planted.h>\n");
      EXPECT_EQ(found.empty(), library.anywhere || room.libraries.contains(library.name))
          << room.name << " and " << library.name;
    }
    EXPECT_FALSE(wrongIncludes(walls(), path, "  #  include <unheard/of.h>\n").empty()) << room.name;
    EXPECT_TRUE(wrongIncludes(walls(), path, "#include <vector>\n").empty()) << room.name;
  }
}

}  // namespace
}  // namespace fettle::tests
