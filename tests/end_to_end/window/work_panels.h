#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/end_to_end/window/user.h"
#include "tests/end_to_end/window/view_program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {

/// The next start of the window with the settings in `folder` has only these panels open.
void openPanels(const TempFolder& folder, const std::vector<std::string>& names);

/// The state once the window rests and `is` holds of it.
User::State settledWith(ViewProgram& program, const char* what,
                        const std::function<bool(const User::State&)>& is);

/// What a command of the program reports with --json; an empty object, and a failed test, where it fails.
User::State jsonOf(const std::vector<std::string>& arguments);

/// Lays the scan of a file on a ball four times as wide, whose top is at `from` of its width.
void layOnABall(const std::string& scan, double from);

/// Two balls as `form_figures` of fettle info has them, to `within` mm.
void expectSameBall(const User::State& a, const User::State& b, double within);

}  // namespace fettle::tests
