#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/base/rows.h"

namespace fettle::haptic {

/// What the stylus does while it is in contact.
enum class Tool : std::uint8_t {
  kFeel,    ///< nothing but forces
  kSmooth,  ///< local smoothing by force, if the scene lists that effect
  kMark,    ///< adds samples to the keep mask
  kUnmark,  ///< takes samples out of the keep mask
  kCount
};

/// What a tool changes; it decides which brush it uses (brushRadiusOf in scene.h) and the kind of its step in
/// the history.
enum class ToolEdits : std::uint8_t { kNothing, kHeights, kMarks };

/// All that is known of a tool apart from its step in the tick (EffectList::tools).
struct ToolRow {
  Tool tool;
  std::string_view word;   ///< in strokes files and on the command line
  std::string_view title;  ///< of its button, and of its steps in the history
  std::string_view hint;   ///< in menus and in the list of keys
  ToolEdits edits;
  Tool opposite;  ///< used instead while Ctrl is held
  char key;       ///< of `fettle record`; a, c, d and q are taken
};

inline constexpr std::array kToolRows = {
    ToolRow{Tool::kFeel, "feel", "Feel", "Feel", ToolEdits::kNothing, Tool::kSmooth, 'f'},
    ToolRow{Tool::kSmooth, "smooth", "Smooth", "Smooth", ToolEdits::kHeights, Tool::kFeel, 's'},
    ToolRow{Tool::kMark, "mark", "Mark", "Mark: keep from filters", ToolEdits::kMarks, Tool::kUnmark, 'm'},
    ToolRow{Tool::kUnmark, "unmark", "Unmark", "Unmark", ToolEdits::kMarks, Tool::kMark, 'u'},
};
inline constexpr int kTools = static_cast<int>(Tool::kCount);

/// The words, in the order of Tool.
inline constexpr auto kToolWords = [] {
  std::array<std::string_view, kToolRows.size()> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = kToolRows[i].word;
  return words;
}();

[[nodiscard]] constexpr const ToolRow& rowOf(Tool tool) noexcept {
  return kToolRows[static_cast<std::size_t>(tool)];
}
[[nodiscard]] constexpr std::string_view toolName(Tool tool) noexcept {
  return rowOf(tool).word;
}
[[nodiscard]] constexpr bool isMarkTool(Tool tool) noexcept {
  return rowOf(tool).edits == ToolEdits::kMarks;
}

/// Nothing where no tool has the word.
[[nodiscard]] constexpr std::optional<Tool> toolNamed(std::string_view word) noexcept {
  for (const ToolRow& row : kToolRows)
    if (row.word == word) return row.tool;
  return std::nullopt;
}

static_assert(engine::inOrder(kToolRows, &ToolRow::tool, Tool::kCount));

}  // namespace fettle::haptic
