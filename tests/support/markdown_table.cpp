#include "tests/support/markdown_table.h"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/source_tree.h"

namespace fettle::tests {
namespace {

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) {
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? ""
                                               : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

}  // namespace

std::vector<std::vector<std::string>> markdownTable(const std::string& document, const std::string& head) {
  std::ifstream lines(inSourceTree(document));
  std::string line;
  while (std::getline(lines, line) && !line.starts_with(head)) continue;
  if (!line.starts_with(head)) return {};
  const std::size_t columns = cellsOf(line).size();
  std::getline(lines, line);  // the rule
  std::vector<std::vector<std::string>> rows;
  while (std::getline(lines, line) && line.starts_with("|")) {
    rows.push_back(cellsOf(line));
    EXPECT_EQ(rows.back().size(), columns) << line;
    rows.back().resize(columns);
  }
  return rows;
}

}  // namespace fettle::tests
