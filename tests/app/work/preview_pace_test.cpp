#include "app/work/preview_pace.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using std::chrono::milliseconds;

constexpr PreviewPace::Clock::time_point at(int ms) {
  return PreviewPace::Clock::time_point(milliseconds(ms));
}

TEST(PreviewPace, is_soon_where_the_last_one_was) {
  PreviewPace pace;
  EXPECT_FALSE(pace.isSoon(10)) << "none was seen yet";
  pace.begin(at(0), 10);
  EXPECT_FALSE(pace.isSoon(10)) << "nor now";
  pace.see(at(300));
  EXPECT_TRUE(pace.isSoon(10));
  pace.see(at(9000));
  EXPECT_TRUE(pace.isSoon(10)) << "the first time counts";
  pace.begin(at(10000), 10);
  pace.see(at(10500));
  EXPECT_FALSE(pace.isSoon(10));
  EXPECT_FALSE(pace.isSoon(1)) << "half a second is no less of a part";
  pace.begin(at(20000), 10);
  pace.see(at(20010));
  EXPECT_TRUE(pace.isSoon(10));
}

TEST(PreviewPace, expects_more_in_view_to_take_longer) {
  PreviewPace pace;
  pace.begin(at(0), 10);
  pace.see(at(100));
  EXPECT_TRUE(pace.isSoon(49));
  EXPECT_FALSE(pace.isSoon(51));
  EXPECT_TRUE(pace.isSoon(1));
}

TEST(RestingFields, rest_after_the_last_of_their_changes) {
  RestingFields<int> fields;
  EXPECT_FALSE(fields.look(3, at(0))) << "the first look is no change";
  EXPECT_FALSE(fields.changed());
  EXPECT_TRUE(fields.look(4, at(1000)));
  EXPECT_FALSE(fields.rest(at(1149)));
  EXPECT_TRUE(fields.rest(at(1150)));
  EXPECT_TRUE(fields.look(5, at(1100)));
  EXPECT_FALSE(fields.rest(at(1249))) << "another change";
  EXPECT_FALSE(fields.look(5, at(1250)));
  EXPECT_TRUE(fields.rest(at(1250)));
  fields.settle();
  EXPECT_FALSE(fields.rest(at(9000)));
  EXPECT_FALSE(fields.look(5, at(9000)));
  EXPECT_FALSE(fields.changed());
  fields.settle(6);
  EXPECT_FALSE(fields.look(6, at(9001)))
      << "what was asked for in the frame of the change is no change any more";
}

}  // namespace
}  // namespace fettle::app
