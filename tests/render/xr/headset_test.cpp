// A headset on the test runtime (tests/xr_runtime), watched by the validation layers of OpenXR and Vulkan.
#include "render/xr/headset.h"

#include <array>
#include <cstring>

#include <gtest/gtest.h>

#include "render/live/live_picture.h"
#include "render/png/png.h"
#include "render/xr/xr_calls.h"
#include "tests/render/support/fields.h"
#include "tests/xr_runtime/xr_stage.h"

namespace fettle::render {
namespace {

using tests::XrStage;

// Draws a field of 100 mm on a table at a tenth of a metre before the eyes' place, until the session ends or fails.
struct Ran {
  engine::Status end;
  bool ended = false;
  std::uint64_t drawn = 0;
  std::vector<RoomHands> hands;
  std::vector<std::string> vulkan;
};

// The scene's millimetres, z up, as places in the room: true size, its middle 0.5 m ahead of the room's origin.
EyeView inScene(const RoomEye& eye) {
  const auto direction = [](const glm::dvec3& d) { return glm::dvec3(d.x, -d.z, d.y); };
  EyeView view;
  view.position = 1000.0 * direction(eye.pose.position_m - glm::dvec3(0.0, 0.0, -0.5));
  view.axes = {direction(eye.pose.turn * glm::dvec3(1, 0, 0)), direction(eye.pose.turn * glm::dvec3(0, 1, 0)),
               direction(eye.pose.turn * glm::dvec3(0, 0, 1))};
  view.left = eye.left;
  view.right = eye.right;
  view.down = eye.down;
  view.up = eye.up;
  return view;
}

Ran show(const engine::Version& field, Stereo::Passes passes, const std::optional<Image>& panel = {}) {
  Ran shown;
  auto headset = Headset::create({Validation::kOn});
  if (!headset) {
    shown.end = tl::unexpected(headset.error());
    return shown;
  }
  {
    auto picture = LivePicture::create((*headset)->context(), (*headset)->colourFormat());
    if (!picture || !(*picture)->update(field)) {
      ADD_FAILURE() << "no picture";
      return shown;
    }
    if (panel) {
      EXPECT_TRUE((*headset)->setPanel(*panel));
    }
    FrameInput input;
    input.view.width = (*headset)->width();
    input.view.height = (*headset)->height();
    input.view.projection = Projection::kPerspective;
    input.view.vertical_exaggeration = 1.0;
    input.decoration = Decoration::kNone;
    input.stereo.passes = passes;
    input.eyes = [&](const Framing&) {
      const auto eyes = (*headset)->eyes();
      return std::array<EyeView, 2>{inScene(eyes[0]), inScene(eyes[1])};
    };
    HeadsetFrame frame;
    frame.hands = [&](const RoomHands& hands) { shown.hands.push_back(hands); };
    frame.draw = [&](LiveTarget& target) -> engine::Status {
      const auto drew = (*picture)->draw(input, target);
      if (!drew) return tl::unexpected(drew.error());
      return {};
    };
    if (panel) frame.panel = RoomPanel{{{0.0, 0.4, -0.7}, {}}, 0.3, 0.2};
    while (!(*headset)->ended()) {
      shown.end = (*headset)->frame(frame);
      if (!shown.end) break;
    }
    (*picture)->finish();
  }
  shown.ended = (*headset)->ended();
  shown.drawn = (*headset)->framesDrawn();
  shown.vulkan = (*headset)->validationMessages();
  return shown;
}

// A field 100 mm wide with a wall of 20 mm in its middle.
engine::Version wall() {
  return fieldOf(gridOf(101, 101), [](int column, int) { return column < 50 ? 0.0 : 20.0; });
}

// The first column of a picture that shows something other than its upper left corner.
int firstColumn(const Image& image) {
  for (int x = 0; x < image.width; ++x)
    for (int y = 0; y < image.height; ++y)
      for (int c = 0; c < 3; ++c)
        if (image.rgba[4 * static_cast<std::size_t>(y * image.width + x) + c] != image.rgba[c]) return x;
  return image.width;
}

constexpr const char* kBefore = "size 240 260\nrate 60\n0 head 0 0.3 -0.2 0 -45\n";

TEST(Headset, shows_both_eyes_and_ends_when_asked) {
  const XrStage stage(std::string(kBefore) + "10 keep\n20 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  EXPECT_TRUE(shown.end) << shown.end.error().line();
  EXPECT_TRUE(shown.ended);
  EXPECT_GT(shown.drawn, 10U);
  EXPECT_TRUE(shown.vulkan.empty()) << shown.vulkan.front();
  for (const char* state : {"READY", "SYNCHRONIZED", "VISIBLE", "FOCUSED", "STOPPING", "EXITING"})
    EXPECT_GE(stage.count(std::string("state ") + state + "\n"), 1) << state << '\n' << stage.log();
  EXPECT_EQ(stage.count("instance destroyed"), 1) << stage.log();
  stage.expectSilence();
  const auto left = readPng(stage.file("frame10.left.png")), right = readPng(stage.file("frame10.right.png"));
  ASSERT_TRUE(left && right) << stage.log();
  EXPECT_NE(left->rgba, right->rgba);
  // The near wall is seen further to the right by the left eye: the same corner of the block, in pixels.
  EXPECT_GT(firstColumn(*left), firstColumn(*right) + 5);
}

// Silence means nothing where nobody would speak.
TEST(Headset, the_layer_and_the_runtime_speak_about_wrong_calls) {
  const XrStage stage(kBefore);
  stage.set();
  XrCalls xr;
  ASSERT_TRUE(xr.load());
  const char* const extension = XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME;
  auto create = typed<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  std::strcpy(create.applicationInfo.applicationName, "test");
  create.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  create.enabledExtensionCount = 1;
  create.enabledExtensionNames = &extension;
  XrInstance instance = XR_NULL_HANDLE;
  ASSERT_EQ(xr.CreateInstance(&create, &instance), XR_SUCCESS);
  ASSERT_TRUE(xr.find(instance));
  XrSystemId system = 0;
  const auto of_wrong_type = typed<XrSystemGetInfo>(XR_TYPE_SYSTEM_PROPERTIES);
  EXPECT_EQ(xr.GetSystem(instance, &of_wrong_type, &system), XR_ERROR_VALIDATION_FAILURE);
  EXPECT_NE(stage.validation().find("VUID-XrSystemGetInfo-type-type"), std::string::npos)
      << stage.validation();
  // The requirements were not asked for.
  const vk::InstanceCreateInfo vulkan;
  auto info = typed<XrVulkanInstanceCreateInfoKHR>(XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR);
  info.systemId = 1;
  info.pfnGetInstanceProcAddr = &vkGetInstanceProcAddr;
  info.vulkanCreateInfo = &static_cast<const VkInstanceCreateInfo&>(vulkan);
  VkInstance made = VK_NULL_HANDLE;
  VkResult result = VK_SUCCESS;
  EXPECT_EQ(xr.CreateVulkanInstanceKHR(instance, &info, &made, &result),
            XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING);
  EXPECT_EQ(stage.count("wrong: a Vulkan instance before the requirements were asked for"), 1) << stage.log();
  EXPECT_EQ(xr.DestroyInstance(instance), XR_SUCCESS);
}

TEST(Headset, no_runtime_is_an_error_that_says_so) {
  setenv("XR_RUNTIME_JSON", "/nowhere/runtime.json", 1);
  const auto headset = Headset::create();
  ASSERT_FALSE(headset);
  EXPECT_NE(headset.error().line().find("no headset can be used"), std::string::npos)
      << headset.error().line();
}

TEST(Headset, one_pass_and_two_give_the_eyes_the_same_pictures) {
  // The block is in the middle: what is cut at the edge of a picture llvmpipe draws wrongly in one pass (Context::multiviewWorks).
  std::array<Image, 2> left, right;
  for (const auto passes : {Stereo::Passes::kOne, Stereo::Passes::kTwo}) {
    const XrStage stage(std::string(kBefore) + "10 keep\n12 stop\n");
    stage.set();
    const Ran ran = show(wall(), passes);
    EXPECT_TRUE(ran.end) << ran.end.error().line();
    EXPECT_TRUE(ran.vulkan.empty()) << ran.vulkan.front();
    stage.expectSilence();
    const auto i = passes == Stereo::Passes::kOne ? 0U : 1U;
    const auto l = readPng(stage.file("frame10.left.png")), r = readPng(stage.file("frame10.right.png"));
    ASSERT_TRUE(l && r) << stage.log();
    left[i] = *l;
    right[i] = *r;
  }
  EXPECT_EQ(left[0].rgba, left[1].rgba);
  EXPECT_EQ(right[0].rgba, right[1].rgba);
}

TEST(Headset, a_lost_session_is_an_error_that_says_so) {
  const XrStage stage(std::string(kBefore) + "15 lose\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  ASSERT_FALSE(shown.end);
  EXPECT_NE(shown.end.error().line().find("the runtime ended or the headset was unplugged"),
            std::string::npos)
      << shown.end.error().line();
  EXPECT_GT(shown.drawn, 5U);
  EXPECT_EQ(stage.count("session destroyed"), 1);
  stage.expectSilence();
}

TEST(Headset, a_hidden_session_is_not_drawn) {
  const XrStage stage(std::string(kBefore) + "10 hide\n30 show\n40 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  EXPECT_TRUE(shown.end) << shown.end.error().line();
  EXPECT_LT(shown.drawn, 35U);
  EXPECT_GE(stage.count("state VISIBLE"), 3) << stage.log();
  EXPECT_GT(shown.hands.size(), 35U);
  stage.expectSilence();
}

TEST(Headset, hands_are_where_the_script_has_them) {
  const XrStage stage(std::string(kBefore) +
                      "5 right 0.1 0.2 -0.3 0 0\n25 right 0.3 0.2 -0.3 0 0\n"
                      "10 right trigger 0.75\n12 right squeeze 0.5\n14 right button 1\n30 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  ASSERT_GT(shown.hands.size(), 20U);
  const RoomHand& hand = shown.hands[19][1];  // frame 20
  ASSERT_TRUE(hand.tracked);
  EXPECT_NEAR(hand.aim.position_m.x, 0.25, 1e-6);
  EXPECT_NEAR(hand.trigger, 0.75, 1e-6);
  EXPECT_NEAR(hand.squeeze, 0.5, 1e-6);
  EXPECT_TRUE(hand.button);
  EXPECT_FALSE(shown.hands[19][0].tracked);
  EXPECT_FALSE(shown.hands[1][1].tracked);
  stage.expectSilence();
}

TEST(Headset, a_panel_hangs_in_the_room_with_its_own_picture) {
  const XrStage stage(std::string(kBefore) + "10 keep\n12 stop\n");
  stage.set();
  Image panel{3, 2, {}};
  for (int i = 0; i < 6; ++i)
    for (const int value : {40 * i, 10, 200, 255}) panel.rgba.push_back(static_cast<std::uint8_t>(value));
  const Ran shown = show(wall(), Stereo::Passes::kBest, panel);
  EXPECT_TRUE(shown.end) << shown.end.error().line();
  EXPECT_EQ(stage.count("frame 10 projection quad"), 1) << stage.log();
  const auto kept = readPng(stage.file("frame10.quad0.png"));
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->rgba, panel.rgba);
  stage.expectSilence();
}

}  // namespace
}  // namespace fettle::render
