// Panels drawn only where they changed look as if all had been drawn: each frame of a sequence is drawn both ways, by a
// rasteriser of the test's own, and compared byte by byte.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <imgui.h>

#include "render/plan/font_data.h"
#include "render/window/panel_damage.h"

namespace fettle::render {
namespace {

constexpr int kWidth = 320, kHeight = 240;
using Pixels = std::vector<std::array<float, 3>>;

// Dear ImGui without a window system.
class Panels {
 public:
  Panels() {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {kWidth, kHeight};
    ImFontConfig font;
    font.FontDataOwnedByAtlas = false;
    const std::span<const std::uint8_t> regular = regularFont();
    io.Fonts->AddFontFromMemoryTTF(const_cast<std::uint8_t*>(regular.data()),
                                   static_cast<int>(regular.size()), 13.0F, &font);
    io.Fonts->GetTexDataAsRGBA32(&texture_, &texture_width_, &texture_height_);
  }
  ~Panels() { ImGui::DestroyContext(); }
  Panels& operator=(Panels&&) = delete;

  // Draws into pixels, as a graphics device does: triangles in their order, cut to their commands' rectangles.
  void draw(const ImDrawList& list, const ImVector<ImDrawCmd>& commands, Pixels& to) const {
    for (const ImDrawCmd& c : commands)
      for (unsigned int i = 0; i + 3 <= c.ElemCount; i += 3) {
        const ImDrawIdx* const at = list.IdxBuffer.Data + c.IdxOffset + i;
        const ImDrawVert* const first = list.VtxBuffer.Data + c.VtxOffset;
        triangle({first[at[0]], first[at[1]], first[at[2]]}, c.ClipRect, to);
      }
  }

 private:
  void triangle(const std::array<ImDrawVert, 3>& v, const ImVec4& clip, Pixels& to) const {
    const auto cross = [](ImVec2 a, ImVec2 b, ImVec2 p) {
      return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    };
    const float whole = cross(v[0].pos, v[1].pos, v[2].pos);
    if (whole == 0.0F) return;
    const auto [x0, x1] = std::minmax({v[0].pos.x, v[1].pos.x, v[2].pos.x});
    const auto [y0, y1] = std::minmax({v[0].pos.y, v[1].pos.y, v[2].pos.y});
    const int left = static_cast<int>(std::max({0.0F, clip.x, std::floor(x0)}));
    const int right = static_cast<int>(std::min({1.0F * kWidth, clip.z, std::ceil(x1)}));
    const int top = static_cast<int>(std::max({0.0F, clip.y, std::floor(y0)}));
    const int bottom = static_cast<int>(std::min({1.0F * kHeight, clip.w, std::ceil(y1)}));
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const ImVec2 p(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        const float a = cross(v[1].pos, v[2].pos, p) / whole, b = cross(v[2].pos, v[0].pos, p) / whole;
        const float c = 1.0F - a - b;
        if (a < 0.0F || b < 0.0F || c < 0.0F) continue;
        const float u = a * v[0].uv.x + b * v[1].uv.x + c * v[2].uv.x;
        const float w = a * v[0].uv.y + b * v[1].uv.y + c * v[2].uv.y;
        const int texel_x =
            std::clamp(static_cast<int>(u * static_cast<float>(texture_width_)), 0, texture_width_ - 1);
        const int texel_y =
            std::clamp(static_cast<int>(w * static_cast<float>(texture_height_)), 0, texture_height_ - 1);
        const unsigned char* const texel = texture_ + 4 * (texel_y * texture_width_ + texel_x);
        std::array<float, 4> colour{};
        for (std::size_t k = 0; k < 4; ++k) {
          const auto of = [&](const ImDrawVert& corner) {
            return static_cast<float>((corner.col >> (8 * k)) & 255U) / 255.0F;
          };
          colour[k] = (a * of(v[0]) + b * of(v[1]) + c * of(v[2])) * static_cast<float>(texel[k]) / 255.0F;
        }
        std::array<float, 3>& pixel = to[static_cast<std::size_t>(y * kWidth + x)];
        for (std::size_t k = 0; k < 3; ++k) pixel[k] = colour[k] * colour[3] + pixel[k] * (1.0F - colour[3]);
      }
  }

  unsigned char* texture_ = nullptr;
  int texture_width_ = 0, texture_height_ = 0;
};

// What one could see in a window: values that change, parts that open, windows that move over each other, tips.
struct Look {
  std::string number = "1.25 mm";
  float share = 0.3F;
  bool open = true, tip = false, second = false;
  float x = 90.0F, y = 80.0F;
  int rows = 3;
};

void layOut(const Look& look) {
  ImGui::NewFrame();
  ImGui::SetNextWindowPos({150.0F, 0.0F});
  ImGui::SetNextWindowSize({170.0F, 240.0F});
  ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoSavedSettings);
  ImGui::TextUnformatted("height under the cursor");
  ImGui::TextUnformatted(look.number.c_str());
  ImGui::SetNextItemOpen(look.open);
  if (ImGui::CollapsingHeader("filters"))
    for (int i = 0; i < look.rows; ++i) ImGui::Button(("row " + std::to_string(i)).c_str());
  ImGui::ProgressBar(look.share);
  ImGui::End();
  if (look.second) {
    ImGui::SetNextWindowPos({look.x, look.y});
    ImGui::SetNextWindowSize({120.0F, 60.0F});
    ImGui::SetNextWindowBgAlpha(0.5F);
    ImGui::Begin("over it", nullptr, ImGuiWindowFlags_NoSavedSettings);
    ImGui::TextUnformatted("shines through");
    ImGui::End();
  }
  if (look.tip) {
    ImGui::BeginTooltip();
    ImGui::TextUnformatted("a tip");
    ImGui::EndTooltip();
  }
  ImGui::Render();
}

void fill(Pixels& pixels, const Rectangle& place) {
  const Rectangle part = cut(place, {0, 0, kWidth, kHeight});
  for (int y = part.y; y < part.y + part.height; ++y)
    for (int x = part.x; x < part.x + part.width; ++x)
      pixels[static_cast<std::size_t>(y * kWidth + x)] = {0.1F, 0.2F, 0.3F};
}

double area(const std::vector<Rectangle>& places) {
  double sum = 0.0;
  for (const Rectangle& place : places) sum += static_cast<double>(place.width) * place.height;
  return sum;
}

class PanelDamageTest : public testing::Test {
 protected:
  // Draws this look over what was there, and says where; the whole frame the first time.
  std::vector<Rectangle> draw(const Look& look) {
    layOut(look);
    ImDrawData& drawn = *ImGui::GetDrawData();
    Places changed;
    const bool known = damage_.next(drawn, changed);
    std::vector<Rectangle> places = changed.take();
    if (!known) places = {{0, 0, kWidth, kHeight}};
    for (const Rectangle& place : places) fill(kept_, place);
    Pixels whole(kept_.size());
    fill(whole, {0, 0, kWidth, kHeight});
    for (int i = 0; i < drawn.CmdListsCount; ++i) {
      const ImDrawList& list = *drawn.CmdLists[i];
      panels_.draw(list, cutTo(list.CmdBuffer, places), kept_);
      panels_.draw(list, list.CmdBuffer, whole);
    }
    EXPECT_TRUE(kept_ == whole);
    return places;
  }

  Panels panels_;
  PanelDamage damage_;
  Pixels kept_ = Pixels(static_cast<std::size_t>(kWidth) * kHeight);
};

TEST_F(PanelDamageTest, WhatChangesIsDrawnAsIfAllWere) {
  std::mt19937 random(5);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  Look look;
  double drawn = 0.0;
  constexpr int kFrames = 400;
  for (int frame = 0; frame < kFrames; ++frame) {
    ImGui::GetIO().MousePos = {static_cast<float>(below(kWidth)), static_cast<float>(below(kHeight))};
    if (below(2) == 0) look.number = std::to_string(below(100000)) + (below(2) == 0 ? " mm" : " um, a hole");
    if (below(3) == 0) look.share = 0.01F * static_cast<float>(below(101));
    if (below(8) == 0) look.open = !look.open;
    if (below(8) == 0) look.rows = below(6);
    if (below(6) == 0) look.tip = !look.tip;
    if (below(6) == 0) look.second = !look.second;
    if (below(3) == 0) look.x = static_cast<float>(below(220));
    if (below(3) == 0) look.y = static_cast<float>(below(200));
    drawn += area(draw(look));
    if (HasFailure()) FAIL() << "frame " << frame;
  }
  EXPECT_LT(drawn, 0.8 * kFrames * kWidth * kHeight);
}

TEST_F(PanelDamageTest, NothingIsDrawnWhereNothingChanges) {
  Look look;
  for (int i = 0; i < 3; ++i) (void)draw(look);  // the first frames find out how large the windows are
  EXPECT_TRUE(draw(look).empty());
}

TEST_F(PanelDamageTest, ANumberTakesItsOwnPlaceAlone) {
  Look look;
  for (int i = 0; i < 3; ++i) (void)draw(look);
  look.number = "1.26 mm";
  const std::vector<Rectangle> same_length = draw(look);
  ASSERT_EQ(same_length.size(), 1U);
  EXPECT_LT(area(same_length), 20 * 20);
  look.number = "12.6 mm and a hole";
  const std::vector<Rectangle> longer = draw(look);
  ASSERT_EQ(longer.size(), 1U);
  EXPECT_LT(area(longer), 170 * 20);
}

TEST_F(PanelDamageTest, AForgottenFrameIsTheFirstOne) {
  const Look look;
  for (int i = 0; i < 3; ++i) (void)draw(look);
  damage_.forget();
  EXPECT_EQ(area(draw(look)), 1.0 * kWidth * kHeight);
}

TEST(PlacesTest, CoverWhatWasAddedAndDoNotOverlap) {
  std::mt19937 random(9);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int trial = 0; trial < 200; ++trial) {
    Places places;
    std::vector<Rectangle> added;
    const int count = below(40);
    for (int i = 0; i < count; ++i) {
      added.push_back({below(1000), below(1000), below(trial % 2 == 0 ? 30 : 300), below(60)});
      places.add(added.back());
    }
    const std::vector<Rectangle> all = places.take();
    EXPECT_LE(all.size(), Places::kMost);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = i + 1; j < all.size(); ++j) EXPECT_TRUE(empty(cut(all[i], all[j])));
    for (const Rectangle& one : added)
      EXPECT_TRUE(empty(one) ||
                  std::ranges::any_of(all, [&](const Rectangle& r) { return cut(one, r) == one; }));
    EXPECT_TRUE(places.take().empty());
  }
}

}  // namespace
}  // namespace fettle::render
