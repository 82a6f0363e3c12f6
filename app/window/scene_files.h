#pragma once

#include <optional>
#include <string>
#include <utility>

#include "app/window/questions.h"
#include "app/work/loop_client.h"

namespace fettle::app {

/// The scene as a file of the user: opened into the loop that runs, saved, and asked for at the end where what is felt was changed.
/// Threading: main.
class SceneFiles {
 public:
  /// How scene files end.
  static constexpr const char* kExtension = ".toml";

  /// A document was opened with its scene. `path`: of the file that the scene is from; empty: of none.
  void begin(const LoopClient& client, std::string path);
  /// Reads a scene and lets it be felt. False, with nothing changed and the dialog of its path, which says why: it cannot be read, has
  /// a problem in a line, or is more than the device holds.
  bool open(const std::string& path, LoopClient& client, Feedback& feedback);
  /// Saves to the path of `from`, a question for one, after a question where a file would be replaced. True: it is saved.
  bool askToSave(Question from, const LoopClient& client, Feedback& feedback);
  /// Writes the scene, whole or not at all, in place of a file that is there. False, with a message: it could not be written.
  bool save(const std::string& path, const LoopClient& client, Feedback& feedback);
  /// Whoever asked whether to save was told not to.
  void leave(const LoopClient& client) { begin(client, std::move(path_)); }

  /// Of the file; empty without one.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// "listen.toml", "listen.toml, changed", "no file".
  [[nodiscard]] std::string title(const LoopClient& client) const;
  /// Whether effects, their numbers or the force are others than in the file, or than at the beginning. Brushes and tips belong
  /// to the tools, which everybody changes; what was fitted again to another device was changed by nobody.
  [[nodiscard]] bool changed(const LoopClient& client) const;

 private:
  std::string path_;
  haptic::Scene saved_;
  std::optional<SceneFit> saved_fit_;  // in force then
};

}  // namespace fettle::app
