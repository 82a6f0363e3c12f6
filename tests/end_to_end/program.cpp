#include "tests/end_to_end/program.h"

#include <sstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/report_check.h"

namespace fettle::tests {

Outcome fettle(std::vector<std::string> arguments, const ProcessOptions& options) {
  arguments.insert(arguments.begin(), FETTLE_PROGRAM);
  return runProcess(arguments, options);
}

nlohmann::json fettleJson(std::vector<std::string> arguments) {
  arguments.push_back("--json");
  const Outcome outcome = fettle(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  if (outcome.status != 0) return nlohmann::json::object();
  auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(problemOf(report), "");
  return report;
}

namespace {

void expectError(const Outcome& outcome, int status, const std::string& part) {
  EXPECT_EQ(outcome.status, status) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  // What an importer had to guess is said before; the refusal itself is one line, the last.
  std::istringstream lines(outcome.err);
  std::vector<std::string> said;
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("fettle: warning: ", 0) != 0) said.push_back(line);
  ASSERT_EQ(said.size(), 1U) << outcome.err;
  EXPECT_EQ(said[0].rfind("fettle: error: ", 0), 0U) << outcome.err;
  EXPECT_NE(said[0].find(part), std::string::npos) << outcome.err;
}

}  // namespace

void expectRefused(const Outcome& outcome, const std::string& part) {
  expectError(outcome, 2, part);
}

void expectFailed(const Outcome& outcome, const std::string& part) {
  expectError(outcome, 1, part);
}

}  // namespace fettle::tests
