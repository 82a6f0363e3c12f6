#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"

// cairo's own name: who lays pages out needs no header of it.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
typedef struct _cairo cairo_t;

namespace fettle::app {

enum class FaceWeight : std::uint8_t { kRegular, kBold };

/// The program's font for pages: its measures without any rounding to pixels, so that a text is as wide at every size and on
/// every machine. One thread at a time.
class PageText {
 public:
  /// Errors (kFailed): no memory; cairo is not installed (cairoCalls).
  [[nodiscard]] static engine::Result<PageText> create();

  /// Length of a line [unit of the size].
  [[nodiscard]] double widthOf(const std::string& text, double size, FaceWeight weight) const;
  /// Length of the longest word.
  [[nodiscard]] double longestWordOf(const std::string& text, double size, FaceWeight weight) const;
  /// A text in lines of at most that length, broken at spaces, a word that is longer within it; at least one line.
  [[nodiscard]] std::vector<std::string> linesOf(const std::string& text, double size, FaceWeight weight,
                                                 double width) const;
  /// Draws a line from (x, y) on its base line, as characters.
  void draw(cairo_t* page, const std::string& text, double x, double y, double size, FaceWeight weight) const;

 private:
  struct Faces;
  explicit PageText(std::shared_ptr<const Faces> faces) : faces_(std::move(faces)) {}
  std::shared_ptr<const Faces> faces_;
};

}  // namespace fettle::app
