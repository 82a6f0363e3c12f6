#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::tests {

/// The table of rooms (docs/rooms.txt).
struct Walls {
  struct Room {
    std::string name;
    std::set<std::string> rooms;      ///< that it may include
    std::set<std::string> libraries;  ///< in addition to those for all
  };
  struct Library {
    std::string name;
    std::vector<std::string> beginnings;  ///< of its headers' names
    bool anywhere = false;
  };
  std::vector<Room> rooms;  ///< as they stand in the table, the lowest first
  std::vector<Library> libraries;

  /// The room of a file by the longest name that its path begins with; nothing outside the product.
  [[nodiscard]] const Room* roomOf(std::string_view path) const;
  /// The library of a header in angle brackets; nothing for the standard library's own (no dot, no slash) and
  /// for those that the table does not know.
  [[nodiscard]] const Library* libraryOf(std::string_view header) const;
};

/// Throws std::runtime_error for a line that cannot be read.
[[nodiscard]] Walls readWalls(const std::string& text);

/// One #include that a file may not have, in words.
/// `path` from the top of the source tree; `text` is what stands in the file.
[[nodiscard]] std::vector<std::string> wrongIncludes(const Walls& walls, const std::string& path,
                                                     const std::string& text);

/// Rooms and libraries that the includes of a file name, its own left out.
struct Named {
  std::set<std::string> rooms, libraries;
};
[[nodiscard]] Named namedBy(const Walls& walls, const std::string& path, const std::string& text);

}  // namespace fettle::tests
