// What a picture's device gets ready, since another picture drew with it.
#include <thread>
#include <vector>

#include "tests/render/support/live_frames.h"

namespace fettle::render {
namespace {

FrameInput withContours() {
  FrameInput input = bare();
  input.contours = Contours::kShow;
  return input;
}

TEST(Prepare, NothingIsLeftToPrepareOfAPictureThatDrewTheSame) {
  const auto rehearsed = makePicture(), drawn = makePicture();
  ASSERT_TRUE(rehearsed->update(partField()));
  ASSERT_TRUE(drawn->update(partField()));
  EXPECT_FALSE(drawn->prepareNextOf(*rehearsed)) << "nothing was drawn yet";
  const Shot there = drawComplete(*rehearsed, withContours());
  int made = 0;
  while (drawn->prepareNextOf(*rehearsed)) ++made;
  EXPECT_GT(made, 2) << "depth, colours, decorations";
  const Shot here = drawComplete(*drawn, withContours());
  EXPECT_EQ(differing(there.image, here.image), 0U);
  EXPECT_FALSE(rehearsed->prepareNextOf(*drawn)) << "it drew the same";
}

TEST(Prepare, APictureBesideAnotherSharesItsPrograms) {
  const auto drawn = makePicture();
  ASSERT_TRUE(drawn->update(partField()));
  const Shot plain = drawComplete(*drawn, bare());
  Shot contours;
  {
    const auto beside = LivePicture::createBeside(*drawn);
    ASSERT_TRUE(beside) << beside.error().line();
    ASSERT_TRUE((*beside)->update(partField()));
    contours = drawComplete(**beside, withContours());
    EXPECT_FALSE(drawn->prepareNextOf(**beside)) << "what it drew with is there";
  }
  EXPECT_GT(differing(contours.image, plain.image), 100U);
  EXPECT_EQ(differing(drawComplete(*drawn, bare()).image, plain.image), 0U) << "it is gone";
  EXPECT_EQ(differing(drawComplete(*drawn, withContours()).image, contours.image), 0U);
}

// Both may find that something is missing at the same time.
TEST(Prepare, AnotherThreadPreparesWhileThePictureIsDrawn) {
  const auto rehearsed = makePicture();
  ASSERT_TRUE(rehearsed->update(partField()));
  std::vector<Shot> expected;
  for (const FrameInput& input : views()) {
    expected.push_back(drawComplete(*rehearsed, input));
    FrameInput contours = input;
    contours.contours = Contours::kShow;
    expected.push_back(drawComplete(*rehearsed, contours));
  }
  for (int round = 0; round < 3; ++round) {
    const auto picture = makePicture();
    ASSERT_TRUE(picture->update(partField()));
    std::jthread other([&] {
      while (picture->prepareNextOf(*rehearsed)) {
      }
    });
    std::size_t i = 0;
    for (const FrameInput& input : views()) {
      EXPECT_EQ(differing(drawComplete(*picture, input).image, expected[i++].image), 0U);
      FrameInput contours = input;
      contours.contours = Contours::kShow;
      EXPECT_EQ(differing(drawComplete(*picture, contours).image, expected[i++].image), 0U);
    }
  }
}

}  // namespace
}  // namespace fettle::render
