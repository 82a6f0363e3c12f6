#include "tests/end_to_end/program.h"

#include <algorithm>

#include <gtest/gtest.h>

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
  return nlohmann::json::parse(outcome.out);
}

void expectRefused(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.rfind("fettle: error: ", 0), 0U) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

}  // namespace fettle::tests
