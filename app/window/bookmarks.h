#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "render/plan/picture.h"

namespace fettle::app {

/// Views of a scan that were kept to come back to, each under a number. They belong to the scan and are stored
/// with its session as a note. Threading: main.
class Bookmarks {
 public:
  static constexpr std::size_t kCount = 4;
  static constexpr const char* kNote = "views";

  /// `number`: below kCount. The size of the picture is not kept.
  void set(std::size_t number, const render::View& view);
  [[nodiscard]] const std::optional<render::View>& at(std::size_t number) const { return views_[number]; }
  [[nodiscard]] std::size_t count() const noexcept;
  void clear() noexcept { views_ = {}; }

  /// As JSON: an array with a camera (viewText) or null for each number, and back. What is no camera is left out.
  [[nodiscard]] std::string text() const;
  void restore(const std::string& text);

 private:
  std::array<std::optional<render::View>, kCount> views_;
};

}  // namespace fettle::app
