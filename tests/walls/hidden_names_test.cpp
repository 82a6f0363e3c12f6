// A function of one source does not take the place of another's: sources that are compiled together.

#include "tests/walls/hidden_names.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/support/source_tree.h"

namespace fettle::tests {
namespace {

namespace fs = std::filesystem;

std::string sourceAt(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(HiddenNames, AreFoundBehindAnUnnamedFunctionOfAnotherSource) {
  const std::map<std::string, std::string> tree{
      {"a.h", "namespace f { struct S { int mixed(int); };\n[[nodiscard]] int mixed(int column, int row); }"},
      {"b.cpp",
       "#include \"b.h\"\nnamespace f { namespace {\n// not( here\nlong mixed(long hash, double by) { return "
       "call(hash); } } }"},
      {"c.cpp", "#include \"a.h\"\nnamespace f { namespace { bool holds() { return mixed(1, 2) == 0; } } }"},
      {"d.cpp", "#include \"a.h\"\nnamespace f { namespace { int own(S s) { return s.mixed(1); } } }"}};
  EXPECT_EQ(freeFunctions(tree.at("a.h")).shared, std::set<std::string>{"mixed"});
  EXPECT_EQ(freeFunctions(tree.at("b.cpp")).unnamed, std::set<std::string>{"mixed"});
  const auto found = hiddenFunctions({"b.cpp", "c.cpp", "d.cpp"}, tree);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], "c.cpp calls mixed(), which one in b.cpp hides");
  EXPECT_TRUE(hiddenFunctions({"c.cpp", "b.cpp"}, tree).empty()) << "what comes later hides nothing";
}

TEST(HiddenNames, AreNoneInTheTree) {
  const fs::path top = inSourceTree("");
  std::map<std::string, std::string> tree;
  for (const char* folder : {"engine", "haptic", "render", "bench", "app", "python", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(top / folder))
      if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
        tree[fs::relative(entry.path(), top).generic_string()] = sourceAt(entry.path());
  std::size_t units = 0;
  for (const auto& entry : fs::recursive_directory_iterator(FETTLE_BINARY_DIR)) {
    if (entry.path().extension() != ".cpp" || entry.path().parent_path().filename() != "together") continue;
    std::vector<std::string> together;
    std::ifstream unit(entry.path());
    for (std::string line; std::getline(unit, line);)
      if (line.starts_with("#include \"")) together.push_back(line.substr(10, line.size() - 11));
    ++units;
    for (const std::string& wrong : hiddenFunctions(together, tree)) ADD_FAILURE() << wrong;
  }
  if (units == 0) GTEST_SKIP() << "each file is compiled alone";
}

}  // namespace
}  // namespace fettle::tests
