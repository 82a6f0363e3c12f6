// A headset on the test runtime (tests/xr_runtime), watched by the validation layers of OpenXR and Vulkan.
#include "render/xr/headset.h"

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "render/live/live_picture.h"
#include "render/png/png.h"
#include "render/xr/xr_calls.h"
#include "render/xr/xr_runtime.h"
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

// To a head that looks down at 45 degrees: turned about x.
const glm::dquat kFaces(std::cos(-0.125 * std::numbers::pi), std::sin(-0.125 * std::numbers::pi), 0.0, 0.0);

Ran show(const engine::Version& field, Stereo::Passes passes, const std::optional<Image>& panel = {},
         double vibration = 0.0) {
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
    bool set = false;
    frame.draw = [&](LiveTarget& target) -> engine::Status {
      if (panel && !std::exchange(set, true)) {
        EXPECT_TRUE((*headset)->setPicture(RoomPicture::kSpot, *panel));
      }
      const auto drew = (*picture)->draw(input, target);
      if (!drew) return tl::unexpected(drew.error());
      return {};
    };
    frame.panels = [&] {
      // One without a picture is left out.
      return std::vector<RoomPanel>{{RoomPicture::kSpot, {{0.0, 0.1, -0.6}, glm::dquat(kFaces)}, 0.3, 0.2},
                                    {RoomPicture::kRay, {{0.0, 0.1, -0.6}, {}}, 0.3, 0.2}};
    };
    if (vibration > 0.0)
      frame.hands = [&](const RoomHands& hands) {
        shown.hands.push_back(hands);
        (*headset)->vibrate(0, 0.0);
        (*headset)->vibrate(1, hands[1].trigger * vibration);
      };
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
  stage.expectLeftInOrder(XrStage::Session::kEnded);
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
  EXPECT_NE(headset.error().line().find("no headset can be used: no runtime is installed"), std::string::npos)
      << headset.error().line();
  EXPECT_NE(headset.error().remedy.find("/nowhere/runtime.json"), std::string::npos)
      << "where it was looked for: " << headset.error().remedy;
}

TEST(Headset, a_runtime_is_looked_for_where_the_loader_looks) {
  setenv("XR_RUNTIME_JSON", "/a/b.json", 1);
  EXPECT_EQ(runtimePlaces(), std::vector<std::string>{"/a/b.json"});
  unsetenv("XR_RUNTIME_JSON");
  setenv("XDG_CONFIG_HOME", "/own", 1);
  setenv("XDG_CONFIG_DIRS", "/one:/two", 1);
  EXPECT_EQ(runtimePlaces(), (std::vector<std::string>{
                                 "/own/openxr/1/active_runtime.json", "/one/openxr/1/active_runtime.json",
                                 "/two/openxr/1/active_runtime.json", "/etc/openxr/1/active_runtime.json"}));
  unsetenv("XDG_CONFIG_HOME");
  unsetenv("XDG_CONFIG_DIRS");
  setenv("HOME", "/home/x", 1);
  EXPECT_EQ(runtimePlaces(), (std::vector<std::string>{"/home/x/.config/openxr/1/active_runtime.json",
                                                       "/etc/xdg/openxr/1/active_runtime.json",
                                                       "/etc/openxr/1/active_runtime.json"}));
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
  stage.expectLeftInOrder(XrStage::Session::kLost);
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
  const XrStage stage(
      std::string(kBefore) +
      "5 right 0.1 0.2 -0.3 0 0\n25 right 0.3 0.2 -0.3 0 0\n"
      "10 right trigger 0.75\n12 right squeeze 0.5\n14 right button 1\n16 right scroll -0.5\n30 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  ASSERT_GT(shown.hands.size(), 20U);
  const RoomHand& hand = shown.hands[19][1];  // frame 20
  ASSERT_TRUE(hand.tracked);
  EXPECT_NEAR(hand.aim.position_m.x, 0.25, 1e-6);
  EXPECT_NEAR(hand.trigger, 0.75, 1e-6);
  EXPECT_NEAR(hand.squeeze, 0.5, 1e-6);
  EXPECT_TRUE(hand.button);
  EXPECT_NEAR(hand.scroll, -0.5, 1e-6);
  EXPECT_FALSE(shown.hands[19][0].tracked);
  EXPECT_FALSE(shown.hands[1][1].tracked);
  stage.expectSilence();
}

TEST(Headset, a_hand_whose_place_is_guessed_or_no_number_is_not_tracked) {
  const XrStage stage(std::string(kBefore) +
                      "5 right 0.1 0.2 -0.3 0 0\n10 right infer 1\n15 right infer 0\n"
                      "20 right broken 1\n25 right broken 0\n30 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  ASSERT_GT(shown.hands.size(), 28U);
  for (const auto& [frame, tracked] : {std::pair{8, true}, {12, false}, {17, true}, {22, false}, {27, true}})
    EXPECT_EQ(shown.hands[static_cast<std::size_t>(frame - 1)][1].tracked, tracked) << "frame " << frame;
  stage.expectSilence();
}

TEST(Headset, a_session_that_ends_at_once_leaves_no_hand) {
  const XrStage stage(std::string(kBefore) + "5 right 0.1 0.2 -0.3 0 0\n10 right trigger 1\n20 end\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  EXPECT_TRUE(shown.ended);
  ASSERT_EQ(shown.hands.size(), 21U);
  EXPECT_TRUE(shown.hands[19][1].tracked);
  EXPECT_FALSE(shown.hands[20][1].tracked);
  EXPECT_EQ(shown.hands[20][1].trigger, 0.0);
  stage.expectSilence();
}

TEST(Headset, a_room_that_moves_has_no_hand_for_a_frame) {
  const XrStage stage(std::string(kBefore) + "5 right 0.1 0.2 -0.3 0 0\n20 recentre\n30 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest);
  ASSERT_GT(shown.hands.size(), 28U);
  int without = 0;
  for (std::size_t frame = 10; frame < 28; ++frame) without += shown.hands[frame][1].tracked ? 0 : 1;
  EXPECT_EQ(without, 1);
  stage.expectSilence();
}

TEST(Headset, frames_whose_images_are_not_free_have_no_picture_and_the_next_ones_have) {
  const XrStage stage(std::string(kBefore) + "12 keep\n12 busy\n13 busy\n13 keep\n20 keep\n24 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest, Image{1, 1, {255, 0, 0, 255}});
  EXPECT_TRUE(shown.end) << shown.end.error().line();
  EXPECT_TRUE(shown.ended);
  for (const char* without : {"frame 12\n", "frame 13\n", "frame 20 projection quad\n"})
    EXPECT_EQ(stage.count(without), 1) << without << stage.log();
  EXPECT_TRUE(shown.vulkan.empty()) << shown.vulkan.front();
  stage.expectSilence();
}

// A program takes frames that stay away for a runtime that has stopped to make them.
TEST(Headset, the_test_runtime_makes_frames_while_it_writes_pictures) {
  const XrStage stage(std::string(kBefore) + "keep-takes 2\n10 keep\n11 recentre\n12 stop\n");
  stage.set();
  EXPECT_TRUE(show(wall(), Stereo::Passes::kBest).ended);
  EXPECT_LT(stage.log().find("room moved"), stage.log().find("frame 10 projection")) << stage.log();
  EXPECT_TRUE(readPng(stage.file("frame10.left.png"))) << "it is there at the end";
}

TEST(Headset, a_panel_hangs_in_the_room_with_its_own_picture) {
  const XrStage stage(std::string(kBefore) + "10 keep\n12 stop\n");
  stage.set();
  Image panel{3, 2, {}};
  for (int i = 0; i < 6; ++i)
    for (const int value : {40 * i, 10, 200, 255}) panel.rgba.push_back(static_cast<std::uint8_t>(value));
  const Ran shown = show(wall(), Stereo::Passes::kBest, panel);
  EXPECT_TRUE(shown.end) << shown.end.error().line();
  EXPECT_EQ(stage.count("frame 10 projection quad\n"), 1) << stage.log();
  const auto kept = readPng(stage.file("frame10.quad0.png"));
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->rgba, panel.rgba);
  stage.expectSilence();
  // Upright, its picture's left at the left, for both eyes.
  for (const char* eye : {"left", "right"}) {
    const auto seen = readPng(stage.file(std::string("frame10.") + eye + ".seen.png"));
    ASSERT_TRUE(seen) << stage.log();
    std::array<glm::dvec2, 2> middle{};  // of the darkest and of the reddest of its pixels
    std::array<int, 2> pixels{};
    for (int y = 0; y < seen->height; ++y)
      for (int x = 0; x < seen->width; ++x) {
        const std::uint8_t* at = &seen->rgba[4 * static_cast<std::size_t>(y * seen->width + x)];
        if (at[1] != 10 || at[2] != 200) continue;
        for (std::size_t i = 0; i < 2; ++i)
          if (at[0] == (i == 0 ? 0 : 200)) {
            middle[i] += glm::dvec2(x, y);
            ++pixels[i];
          }
      }
    ASSERT_GT(pixels[0], 20) << eye;
    ASSERT_GT(pixels[1], 20) << eye;
    EXPECT_LT(middle[0].x / pixels[0], middle[1].x / pixels[1]) << eye;
    EXPECT_LT(middle[0].y / pixels[0], middle[1].y / pixels[1]) << eye;
  }
}

TEST(Headset, what_is_clear_in_a_panel_shows_what_is_behind_it) {
  std::array<Image, 2> seen, plain;
  for (const std::uint8_t opacity : {std::uint8_t{0}, std::uint8_t{128}}) {
    const XrStage stage(std::string(kBefore) + "10 keep\n12 stop\n");
    stage.set();
    Image panel{1, 1, {255, 255, 255, opacity}};
    const Ran shown = show(wall(), Stereo::Passes::kBest, panel);
    EXPECT_TRUE(shown.end) << shown.end.error().line();
    const auto s = readPng(stage.file("frame10.left.seen.png")), p = readPng(stage.file("frame10.left.png"));
    ASSERT_TRUE(s && p) << stage.log();
    seen[opacity == 0 ? 0 : 1] = *s;
    plain[opacity == 0 ? 0 : 1] = *p;
    stage.expectSilence();
  }
  EXPECT_EQ(seen[0].rgba, plain[0].rgba);
  int lighter = 0, white = 0;
  for (std::size_t i = 0; i < seen[1].rgba.size(); i += 4) {
    lighter += seen[1].rgba[i] > plain[1].rgba[i] ? 1 : 0;
    white += seen[1].rgba[i] == 255 ? 1 : 0;
  }
  EXPECT_GT(lighter, 1000);
  EXPECT_LT(white, lighter / 10);
}

TEST(Headset, a_hand_is_told_by_vibration_and_not_after_the_focus_is_lost) {
  const XrStage stage(std::string(kBefore) +
                      "5 right 0.1 0.2 -0.3 0 0\n5 left -0.1 0.2 -0.3 0 0\n10 right trigger 0.8\n"
                      "20 right trigger 0\n30 right trigger 1\n40 hide\n50 stop\n");
  stage.set();
  const Ran shown = show(wall(), Stereo::Passes::kBest, {}, 0.5);
  EXPECT_TRUE(shown.end) << shown.end.error().line();
  EXPECT_EQ(stage.count("haptics right 0.400 in frame 15\n"), 1) << stage.log();
  EXPECT_EQ(stage.count("haptics right 0.400 in frame"), 10) << "renewed in each frame";
  EXPECT_EQ(stage.count("haptics right stopped in frame 20\n"), 1);
  EXPECT_EQ(stage.count("haptics right 0.500 in frame 30\n"), 1);
  EXPECT_EQ(stage.count("haptics right 0.500 in frame 45\n"), 0);
  EXPECT_GE(stage.count("haptics right stopped in frame"), 2);
  EXPECT_EQ(stage.count("haptics left"), 0) << "nothing is stopped that does not run";
  stage.expectSilence();
}

}  // namespace
}  // namespace fettle::render
