#include "render/plan/glyphs.h"

#include <algorithm>

#include <ft2build.h>
#include FT_FREETYPE_H

#include "render/plan/font_data.h"

namespace fettle::render {

struct Glyphs::Library {
  FT_Library library = nullptr;
  FT_Face faces[2] = {nullptr, nullptr};
  ~Library() {
    for (FT_Face face : faces)
      if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }
};

Glyphs::Glyphs() : library_(std::make_unique<Library>()), image_(std::size_t{kSide} * kSide, 0) {}
Glyphs::Glyphs(Glyphs&&) noexcept = default;
Glyphs& Glyphs::operator=(Glyphs&&) noexcept = default;
Glyphs::~Glyphs() = default;

engine::Result<Glyphs> Glyphs::create() {
  Glyphs glyphs;
  Library& lib = *glyphs.library_;
  const auto load = [&lib](std::span<const std::uint8_t> file, FT_Face& face) {
    return FT_New_Memory_Face(lib.library, file.data(), static_cast<FT_Long>(file.size()), 0, &face) == 0;
  };
  if (FT_Init_FreeType(&lib.library) != 0 || !load(regularFont(), lib.faces[0]) ||
      !load(boldFont(), lib.faces[1]))
    return engine::failure("the font built into the program cannot be read", "DejaVu Sans",
                           "build again with fonts-dejavu-core and libfreetype-dev as Debian 12 has them");
  return glyphs;
}

void Glyphs::clear() {
  known_.clear();
  std::fill(image_.begin(), image_.end(), std::uint8_t{0});
  row_x_ = row_y_ = row_height_ = 0;
  ++generation_;
}

const Glyphs::Glyph& Glyphs::glyph(char32_t character, int size_px, Weight weight) {
  const std::uint64_t key = std::uint64_t{character} | static_cast<std::uint64_t>(size_px) << 32 |
                            static_cast<std::uint64_t>(weight == Weight::kBold) << 63;
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  Glyph g;
  FT_Face face = library_->faces[weight == Weight::kBold ? 1 : 0];
  if (FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(size_px)) == 0 &&
      FT_Load_Char(face, character, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) == 0) {
    const FT_GlyphSlot slot = face->glyph;
    g.advance = static_cast<double>(slot->advance.x) / 64.0;
    const int width = static_cast<int>(slot->bitmap.width), height = static_cast<int>(slot->bitmap.rows);
    // An empty texel around each glyph separates neighbours.
    if (row_x_ + width + 1 > kSide) {
      row_y_ += row_height_;
      row_x_ = row_height_ = 0;
    }
    if (width <= kSide && row_y_ + height + 1 <= kSide) {
      g.x = row_x_;
      g.y = row_y_;
      g.width = width;
      g.height = height;
      g.left = slot->bitmap_left;
      g.top = slot->bitmap_top;
      for (int y = 0; y < height; ++y)
        std::copy_n(slot->bitmap.buffer + std::ptrdiff_t{y} * slot->bitmap.pitch, width,
                    image_.data() + std::ptrdiff_t{g.y + y} * kSide + g.x);
      row_x_ += width + 1;
      row_height_ = std::max(row_height_, height + 1);
      ++generation_;
    } else {
      ++lost_;
    }
  }
  return known_.emplace(key, g).first->second;
}

double Glyphs::width(const std::string& text, int size_px, Weight weight) {
  double sum = 0.0;
  for (const char32_t c : charactersOf(text)) sum += glyph(c, size_px, weight).advance;
  return sum;
}

std::u32string charactersOf(const std::string& text) {
  std::u32string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) {
      return k < text.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(text[k])) : 0U;
    };
    const std::uint32_t first = byte(i);
    const std::size_t more = first < 0x80       ? 0
                             : first >> 5 == 6  ? 1
                             : first >> 4 == 14 ? 2
                             : first >> 3 == 30 ? 3
                                                : 9;
    char32_t c = more == 0 ? first : more == 9 ? 0xFFFD : first & (0x3FU >> more);
    std::size_t used = 1;
    for (; more != 9 && used <= more; ++used) {
      if ((byte(i + used) & 0xC0U) != 0x80U) {
        c = 0xFFFD;
        break;
      }
      c = c << 6 | (byte(i + used) & 0x3FU);
    }
    out.push_back(c < 0x20 || c == 0x7F ? U' ' : c);
    i += used;
  }
  return out;
}

}  // namespace fettle::render
