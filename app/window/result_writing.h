#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "app/window/questions.h"
#include "app/work/background.h"

namespace fettle::app {

/// Writes a file of what was measured, in the background, one at a time. Threading: main.
class ResultWriting {
 public:
  /// Writes the file, whole or not at all. Called on a worker.
  using Work = std::function<engine::Status(const std::string& path, engine::JobControl& job)>;

  /// Whether the work reads the session, which then has to hold all steps first.
  enum class Reads : std::uint8_t { kNothing, kSession };

  /// `what`: "sections". None must be under way.
  void start(std::string path, const char* what, Reads reads, Work work);
  void cancel() noexcept;

  [[nodiscard]] bool busy() const noexcept { return writing_.busy() || waiting_.has_value(); }
  [[nodiscard]] WorkProgress progress() const { return writing_.progress(); }
  [[nodiscard]] const char* what() const noexcept { return what_; }
  /// Once per frame: the path that was written, once, with a notice; what failed is a dialog. `stored`: the session holds all steps.
  [[nodiscard]] std::optional<std::string> poll(bool stored, Feedback& feedback);

 private:
  struct Waiting {
    std::string path;
    Work work;
  };
  void begin(Waiting next);

  const char* what_ = "";
  std::optional<Waiting> waiting_;  // for the session
  Background<std::string> writing_;
};

}  // namespace fettle::app
