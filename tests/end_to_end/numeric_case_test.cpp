// The smallest case of a broken numerical property, as the numeric suite writes it, played by the built
// program.
#include <sstream>

#include <gtest/gtest.h>

#include "haptic/tick/tick.h"
#include "tests/end_to_end/program.h"
#include "tests/numeric/support/touch_case.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

TEST(NumericCase, TheCommandThatABrokenPropertyPrintsReplaysIt) {
  const TempFolder folder;
  const auto broken = findBroken(
      "no hand is ever in contact", Choice::kCertified,
      [](const TouchCase& touch) -> std::optional<std::string> {
        const engine::Version field = touch.field();
        engine::LiveField live(field, engine::Growth::kAllowed);
        haptic::Tick tick(touch.scene(), live, field);
        for (const haptic::StrokeSample& row : touch.strokes())
          if (tick.run(row).contact) return "contact";
        return std::nullopt;
      },
      folder.file("case"));
  ASSERT_TRUE(broken);
  std::istringstream words(broken->command);
  std::vector<std::string> arguments;
  for (std::string word; words >> word;) arguments.push_back(word);
  ASSERT_EQ(arguments.front(), "fettle");
  arguments.erase(arguments.begin());
  const nlohmann::json report = fettleJson(arguments);
  EXPECT_EQ(report["ticks"], broken->touch.moves.size());
  EXPECT_EQ(report["contact_ticks"], 1);
}

}  // namespace
}  // namespace fettle::tests
