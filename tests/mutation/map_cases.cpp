// Linked into every test program of a build with planted errors: after each case the plants that it came past, so that one
// run of a program maps all its cases.
#include <gtest/gtest.h>

#include <string>

#include "tests/mutation/planted.h"

namespace {

class CaseMap : public testing::EmptyTestEventListener {
  // What came before, as a fixture shared by cases does, belongs to all of them.
  void OnTestStart(const testing::TestInfo& /*info*/) override { fettle_planted::tell("*"); }

  // "= SUITE.CASE MILLISECONDS PASSED": what processes that it started have told stands above it.
  void OnTestEnd(const testing::TestInfo& info) override {
    const auto& result = *info.result();
    const std::string name = "= " + std::string(info.test_suite_name()) + "." + info.name() + " " +
                             std::to_string(result.elapsed_time()) + " " + (result.Failed() ? "0" : "1");
    fettle_planted::tell(name.c_str());
  }
};

const bool kListens = [] {
  if (fettle_planted::mapPath == nullptr) return false;
  fettle_planted::caseByCase = true;
  testing::UnitTest::GetInstance()->listeners().Append(new CaseMap);
  return true;
}();

}  // namespace
