#pragma once

#include <cstdint>
#include <string>

#include "app/reference/command_table.h"

namespace fettle::app {

enum class Shell : std::uint8_t { kBash, kZsh, kFish };

/// A script with which a shell completes the commands of `root`, their options, and the words, files and
/// folders that these take. Bash 4 or later; zsh and fish use their own completion systems.
[[nodiscard]] std::string completionScript(const CommandTable& root, Shell shell);

}  // namespace fettle::app
