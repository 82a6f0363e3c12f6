#include "render/window/ui_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include <imgui.h>

namespace fettle::render {
namespace {

// Corners of a letter's square in the font's image, exact: the same floats go into the vertices.
std::uint64_t cornerKey(float u, float v) {
  // The image has fewer than 2^16 texels a side.
  return static_cast<std::uint64_t>(std::lround(static_cast<double>(u) * (1 << 20))) << 32U |
         static_cast<std::uint32_t>(std::lround(static_cast<double>(v) * (1 << 20)));
}

struct Letter {
  const ImFont* font = nullptr;
  const ImFontGlyph* glyph = nullptr;
};
using Letters = std::unordered_map<std::uint64_t, Letter>;

Letters lettersOf(const ImFontAtlas& atlas) {
  Letters letters;
  for (const ImFont* font : atlas.Fonts)
    for (const ImFontGlyph& glyph : font->Glyphs)
      if (glyph.Visible != 0) letters.emplace(cornerKey(glyph.U0, glyph.V0), Letter{font, &glyph});
  return letters;
}

void append(std::string& text, unsigned int code) {
  const auto byte = [&](unsigned int b) { text += static_cast<char>(b); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xc0U | code >> 6U);
    byte(0x80U | (code & 0x3fU));
  } else {
    byte(0xe0U | code >> 12U);
    byte(0x80U | (code >> 6U & 0x3fU));
    byte(0x80U | (code & 0x3fU));
  }
}

// Joins consecutive letters to pieces of text.
class Reader {
 public:
  explicit Reader(std::vector<PanelText>& texts) : texts_(texts) {}

  void letter(const Letter& letter, const ImDrawVert& corner, float drawn_to, const ImVec4& clip) {
    const ImFont& font = *letter.font;
    const ImFontGlyph& g = *letter.glyph;
    const float x = corner.pos.x - g.X0, y = corner.pos.y - g.Y0, right = x + g.X1;
    const float space = font.FindGlyph(' ')->AdvanceX;
    const float gap = x - pen_;
    const bool follows = open_ && std::abs(y - line_) < 0.5F && gap > -1.0F && gap < space + 1.5F;
    // Letters completely outside are submitted but not visible.
    const bool hidden =
        corner.pos.x >= clip.z || right <= clip.x || y + font.FontSize <= clip.y || y >= clip.w;
    if (!follows) {
      end();
      open_ = true;
      line_ = y;
    } else if (gap > 1.5F) {
      append(text_.text, ' ');
    }
    pen_ = x + g.AdvanceX;
    // ImGui clips some letters itself before the device does.
    if (corner.pos.x < clip.x - 1.0F || std::min(drawn_to, clip.z) < right - 1.0F) text_.cut = true;
    if (hidden) return;
    if (text_.width <= 0.0F) {
      text_.x = std::max(corner.pos.x, clip.x);
      text_.y = std::max(y, clip.y);
    }
    append(text_.text, g.Codepoint);
    text_.width = std::max(text_.width, std::min(right, clip.z) - text_.x);
    text_.height = std::min(y + font.FontSize, clip.w) - text_.y;
  }
  void end() {
    while (!text_.text.empty() && text_.text.back() == ' ') text_.text.pop_back();
    if (text_.width > 0.0F) texts_.push_back(std::move(text_));
    text_ = {};
    open_ = false;
  }

 private:
  std::vector<PanelText>& texts_;
  PanelText text_;
  bool open_ = false;
  float pen_ = 0.0F, line_ = 0.0F;
};

}  // namespace

std::vector<PanelText> textsOf(const ImDrawData& drawn) {
  std::vector<PanelText> texts;
  const Letters letters = lettersOf(*ImGui::GetIO().Fonts);
  Reader reader(texts);
  for (int n = 0; n < drawn.CmdListsCount; ++n) {
    const ImDrawList& list = *drawn.CmdLists[n];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback != nullptr) continue;
      const ImDrawIdx* index = list.IdxBuffer.Data + command.IdxOffset;
      for (unsigned int i = 0; i + 6 <= command.ElemCount;) {
        // A square: two triangles of four vertices in a row (ImDrawList::PrimRectUV).
        const unsigned int a = index[i];
        const bool square = index[i + 1] == a + 1 && index[i + 2] == a + 2 && index[i + 3] == a &&
                            index[i + 4] == a + 2 && index[i + 5] == a + 3;
        const ImDrawVert& corner = list.VtxBuffer[static_cast<int>(a + command.VtxOffset)];
        const auto found = square ? letters.find(cornerKey(corner.uv.x, corner.uv.y)) : letters.end();
        if (found != letters.end()) {
          const ImDrawVert& opposite = list.VtxBuffer[static_cast<int>(a + 2 + command.VtxOffset)];
          reader.letter(found->second, corner, opposite.pos.x, command.ClipRect);
        } else {
          reader.end();  // not a letter: a border or a line
        }
        i += square ? 6 : 3;
      }
    }
    reader.end();
  }
  return texts;
}

}  // namespace fettle::render
