#include "app/pages/page_text.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include <ft2build.h>
#include FT_FREETYPE_H

#include "app/pages/cairo_calls.h"
#include "render/plan/font_data.h"
#include "render/plan/glyphs.h"

namespace fettle::app {

namespace {

// The library lives as long as cairo keeps a face of it, which may be longer than this object.
struct FaceKeeper {
  std::shared_ptr<FT_LibraryRec_> library;
  FT_Face face = nullptr;
  ~FaceKeeper() {
    if (face != nullptr) FT_Done_Face(face);
  }
  FaceKeeper& operator=(FaceKeeper&&) = delete;
};
constexpr cairo_user_data_key_t kFaceKey{};

cairo_font_face_t* faceOf(const CairoCalls& cairo, const std::shared_ptr<FT_LibraryRec_>& library,
                          std::span<const std::uint8_t> file) {
  auto keeper = std::make_unique<FaceKeeper>();
  keeper->library = library;
  if (FT_New_Memory_Face(library.get(), file.data(), static_cast<FT_Long>(file.size()), 0, &keeper->face) !=
      0)
    return nullptr;
  cairo_font_face_t* face = cairo.ft_font_face_create_for_ft_face(keeper->face, FT_LOAD_NO_HINTING);
  if (cairo.font_face_set_user_data(face, &kFaceKey, keeper.get(), [](void* kept) {
        delete static_cast<FaceKeeper*>(kept);
      }) != CAIRO_STATUS_SUCCESS) {
    cairo.font_face_destroy(face);
    return nullptr;
  }
  (void)keeper.release();  // cairo's now
  return face;
}

constexpr double kMeasured = 1000.0;  // size at which texts are measured

// Without control characters and malformed bytes.
std::string utf8Of(std::u32string_view characters) {
  std::string out;
  const auto add = [&out](char32_t byte) { out += static_cast<char>(byte); };
  for (const char32_t c : characters) {
    if (c < 0x80U) {
      add(c);
    } else if (c < 0x800U) {
      add(0xC0U | (c >> 6U));
      add(0x80U | (c & 0x3FU));
    } else if (c < 0x10000U) {
      add(0xE0U | (c >> 12U));
      add(0x80U | ((c >> 6U) & 0x3FU));
      add(0x80U | (c & 0x3FU));
    } else {
      add(0xF0U | (c >> 18U));
      add(0x80U | ((c >> 12U) & 0x3FU));
      add(0x80U | ((c >> 6U) & 0x3FU));
      add(0x80U | (c & 0x3FU));
    }
  }
  return out;
}

std::vector<std::u32string> wordsOf(const std::string& text) {
  std::vector<std::u32string> words(1);
  for (const char32_t c : render::charactersOf(text))
    if (c == U' ')
      words.emplace_back();
    else
      words.back() += c;
  return words;
}

}  // namespace

struct PageText::Faces {
  const CairoCalls& cairo;
  cairo_font_face_t* face[2] = {};
  cairo_scaled_font_t* measured[2] = {};

  explicit Faces(const CairoCalls& calls) : cairo(calls) {}
  Faces& operator=(Faces&&) = delete;
  ~Faces() {
    for (int i = 0; i < 2; ++i) {
      if (measured[i] != nullptr) cairo.scaled_font_destroy(measured[i]);
      if (face[i] != nullptr) cairo.font_face_destroy(face[i]);
    }
  }

  [[nodiscard]] double widthOf(const std::string& text, double size, FaceWeight weight) const {
    cairo_text_extents_t extents;
    cairo.scaled_font_text_extents(measured[static_cast<int>(weight)], text.c_str(), &extents);
    return extents.x_advance * size / kMeasured;
  }
};

engine::Result<PageText> PageText::create() {
  const auto loaded = cairoCalls();
  if (!loaded) return tl::unexpected(loaded.error());
  const CairoCalls& cairo = **loaded;
  const tl::unexpected<engine::Error> none = engine::failure("memory is exhausted", "the page's font");
  FT_Library opened = nullptr;
  if (FT_Init_FreeType(&opened) != 0) return none;
  const std::shared_ptr<FT_LibraryRec_> library(opened, [](FT_Library l) { FT_Done_FreeType(l); });
  auto faces = std::make_shared<Faces>(cairo);
  const std::span<const std::uint8_t> files[] = {render::regularFont(), render::boldFont()};
  cairo_font_options_t* options = cairo.font_options_create();
  cairo.font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo.font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_matrix_t size, plain;
  cairo.matrix_init_scale(&size, kMeasured, kMeasured);
  cairo.matrix_init_identity(&plain);
  bool made = true;
  for (int i = 0; i < 2 && made; ++i) {
    faces->face[i] = faceOf(cairo, library, files[i]);
    if (faces->face[i] != nullptr)
      faces->measured[i] = cairo.scaled_font_create(faces->face[i], &size, &plain, options);
    made =
        faces->measured[i] != nullptr && cairo.scaled_font_status(faces->measured[i]) == CAIRO_STATUS_SUCCESS;
  }
  cairo.font_options_destroy(options);
  if (!made) return none;
  return PageText(std::move(faces));
}

double PageText::widthOf(const std::string& text, double size, FaceWeight weight) const {
  return faces_->widthOf(utf8Of(render::charactersOf(text)), size, weight);
}

double PageText::longestWordOf(const std::string& text, double size, FaceWeight weight) const {
  double longest = 0.0;
  for (const std::u32string& word : wordsOf(text))
    longest = std::max(longest, faces_->widthOf(utf8Of(word), size, weight));
  return longest;
}

std::vector<std::string> PageText::linesOf(const std::string& text, double size, FaceWeight weight,
                                           double width) const {
  // What a sum of the same lengths in another order is off.
  const double room = width * (1.0 + 1e-9);
  const auto fits = [&](std::u32string_view line) {
    return faces_->widthOf(utf8Of(line), size, weight) <= room;
  };
  std::vector<std::string> lines;
  std::u32string line;
  bool begun = false;
  for (std::u32string word : wordsOf(text)) {
    std::u32string longer = line;
    if (begun) longer += U' ';
    longer += word;
    if (fits(longer)) {
      line = std::move(longer);
      begun = true;
      continue;
    }
    if (begun) lines.push_back(utf8Of(line));
    while (word.size() > 1 && !fits(word)) {
      std::size_t most = 1;
      while (most < word.size() && fits(std::u32string_view(word).substr(0, most + 1))) ++most;
      lines.push_back(utf8Of(std::u32string_view(word).substr(0, most)));
      word.erase(0, most);
    }
    line = std::move(word);
    begun = true;
  }
  lines.push_back(utf8Of(line));
  return lines;
}

void PageText::draw(cairo_t* page, const std::string& text, double x, double y, double size,
                    FaceWeight weight) const {
  const CairoCalls& cairo = faces_->cairo;
  cairo.set_font_face(page, faces_->face[static_cast<int>(weight)]);
  cairo.set_font_size(page, size);
  cairo.move_to(page, x, y);
  cairo.show_text(page, utf8Of(render::charactersOf(text)).c_str());
}

}  // namespace fettle::app
