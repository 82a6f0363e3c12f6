#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "render/config.h"

namespace fettle::render {

/// Glyphs of DejaVu Sans (embedded at build time), rasterised by FreeType into one grey image on demand:
/// light hinting keeps horizontal stems on pixel rows, so that small text is crisp.
///
/// Threading: one thread at a time.
class Glyphs {
 public:
  struct Glyph {
    int x = 0, y = 0;           ///< position in the image [texels]
    int width = 0, height = 0;  ///< size [texels = pixels]
    int left = 0, top = 0;      ///< from the pen to the left edge, from the baseline up to the top edge [px]
    double advance = 0.0;       ///< pen to pen [px]
  };
  enum class Weight { kRegular, kBold };

  [[nodiscard]] static engine::Result<Glyphs> create();
  Glyphs(Glyphs&&) noexcept;
  Glyphs& operator=(Glyphs&&) noexcept;
  ~Glyphs();

  static constexpr int kSide = kGlyphImageSide;  ///< the image is kSide x kSide, one byte of coverage each

  /// One character at a font size [px]; a box for a character that the font lacks, empty when the image is
  /// full (counted by lost()).
  [[nodiscard]] const Glyph& glyph(char32_t character, int size_px, Weight weight);

  /// Advance of the text [px]. Malformed UTF-8 shows as U+FFFD.
  [[nodiscard]] double width(const std::string& text, int size_px, Weight weight);

  [[nodiscard]] const std::vector<std::uint8_t>& image() const noexcept { return image_; }
  /// Increases whenever the image changes.
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }
  [[nodiscard]] std::int64_t lost() const noexcept { return lost_; }
  /// Removes every glyph: sizes no longer in use would eventually fill the image.
  void clear();
  /// Rows of the image in use.
  [[nodiscard]] int used() const noexcept { return row_y_ + row_height_; }

 private:
  struct Library;
  Glyphs();
  std::unique_ptr<Library> library_;
  std::map<std::uint64_t, Glyph> known_;
  std::vector<std::uint8_t> image_;
  int row_x_ = 0, row_y_ = 0, row_height_ = 0;  // shelf being filled
  std::uint64_t generation_ = 1;
  std::int64_t lost_ = 0;
};

/// The characters of a UTF-8 text; invalid bytes become U+FFFD, control characters spaces.
[[nodiscard]] std::u32string charactersOf(const std::string& text);

}  // namespace fettle::render
