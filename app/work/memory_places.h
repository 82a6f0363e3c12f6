#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/field/edge_line.h"
#include "engine/io/import.h"
#include "render/plan/picture.h"

namespace fettle::app {

/// What stands under a name in memory: what a command reads there, or what it wrote.
struct MemoryPlace {
  std::optional<engine::Imported> scan;  ///< a scan, or the marks of its field alone
  std::optional<std::vector<engine::EdgeLine>> lines;
  std::optional<render::Image> picture;
  std::optional<std::string> page;  ///< of fettle report
};

/// Names that commands read from and write to in memory instead of files, for a program that calls commands (python/): no
/// file is written to pass a scan from one command to the next. A name is "<" TEXT ">". It counts while this object
/// exists, on the thread that made the object: other threads have names of their own, and the program `fettle` none.
///
/// Threading: the thread that made it, which has one of them at a time.
class MemoryPlaces {
 public:
  MemoryPlaces();
  ~MemoryPlaces();
  MemoryPlaces& operator=(MemoryPlaces&&) = delete;

  /// The place of that name, made on demand.
  [[nodiscard]] MemoryPlace& at(const std::string& name) { return places_[name]; }

  /// Null where there is none of that name.
  [[nodiscard]] MemoryPlace* find(const std::string& name);

 private:
  std::map<std::string, MemoryPlace> places_;
};

/// The place in memory that a path of a command names on this thread; null for the path of a file.
[[nodiscard]] MemoryPlace* memoryPlace(const std::string& path);

}  // namespace fettle::app
