#include "app/window/mouse_presets.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using enum Habits;
using enum render::MouseButton;

constexpr render::Modifiers kPlain{}, kControl{true, false, false}, kShift{false, true, false},
    kAlt{false, false, true};

// As in the programs' own manuals and sources (Blender 3.4, CloudCompare 2.12, MeshLab 2022, MeshLib 2).
TEST(MousePresets, move_the_view_as_in_the_programs_they_are_named_after) {
  EXPECT_EQ(dragOf(kMiddle, kPlain, kBlender, false), Drag::kTurn);
  EXPECT_EQ(dragOf(kMiddle, kShift, kBlender, false), Drag::kPan);
  EXPECT_EQ(dragOf(kMiddle, kControl, kBlender, false), Drag::kZoom);
  EXPECT_EQ(dragOf(kRight, kPlain, kBlender, false), Drag::kNone);

  EXPECT_EQ(dragOf(kLeft, kPlain, kCloudCompare, false), Drag::kTurn);
  EXPECT_EQ(dragOf(kRight, kPlain, kCloudCompare, false), Drag::kPan);
  EXPECT_EQ(dragOf(kMiddle, kPlain, kCloudCompare, false), Drag::kZoom);

  EXPECT_EQ(dragOf(kLeft, kPlain, kMeshLab, false), Drag::kTurn);
  EXPECT_EQ(dragOf(kLeft, kControl, kMeshLab, false), Drag::kPan);
  EXPECT_EQ(dragOf(kLeft, kShift, kMeshLab, false), Drag::kZoom);
  EXPECT_EQ(dragOf(kMiddle, kPlain, kMeshLab, false), Drag::kPan);
  EXPECT_EQ(dragOf(kMiddle, kAlt, kMeshLab, false), Drag::kTurn);
  EXPECT_EQ(dragOf(kRight, kPlain, kMeshLab, false), Drag::kNone);

  EXPECT_EQ(dragOf(kMiddle, kPlain, kMeshLib, false), Drag::kTurn);
  EXPECT_EQ(dragOf(kRight, kPlain, kMeshLib, false), Drag::kPan);
}

TEST(MousePresets, leave_the_left_button_to_the_stylus_and_turn_with_alt) {
  for (const MousePreset& preset : kMousePresets) {
    for (const render::Modifiers& m : {kPlain, kControl, kShift})
      EXPECT_EQ(dragOf(kLeft, m, preset.habits, true), Drag::kNone) << preset.word;
    EXPECT_EQ(dragOf(kLeft, kAlt, preset.habits, true), Drag::kTurn) << preset.word;
    EXPECT_EQ(dragOf(kLeft, kPlain, preset.habits, false), Drag::kTurn) << preset.word;
    EXPECT_EQ(dragOf(kOther, kPlain, preset.habits, false), Drag::kNone) << preset.word;
  }
}

TEST(MousePresets, differ_from_each_other) {
  for (const MousePreset& a : kMousePresets)
    for (const MousePreset& b : kMousePresets) {
      if (a.habits == b.habits) continue;
      bool differ = false;
      for (const render::MouseButton button : {kLeft, kMiddle, kRight})
        for (const render::Modifiers& m : {kPlain, kControl, kShift})
          differ = differ || dragOf(button, m, a.habits, false) != dragOf(button, m, b.habits, false);
      EXPECT_TRUE(differ) << a.word << " and " << b.word;
    }
}

}  // namespace
}  // namespace fettle::app
