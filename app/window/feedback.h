#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/window/questions.h"

namespace fettle::app {

/// Messages and dialogs for the user: the notices over the panels, the line of the status bar, the dialogs.
/// The parts of the window report here. Threading: main.
struct Feedback {
  static constexpr std::size_t kMostNotices = 6;

  std::vector<Notice> notices;  ///< oldest first
  std::string status;
  Questions questions;

  void note(const engine::Error& error) { notices.push_back({error.what, error.remedy}); }
  /// Shows a message dialog.
  void message(std::string what, std::string remedy) {
    questions.ask({.kind = Question::Kind::kMessage, .said = {std::move(what), std::move(remedy)}});
  }
};

}  // namespace fettle::app
