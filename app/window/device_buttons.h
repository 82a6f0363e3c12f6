#pragma once

#include "app/window/parts.h"

namespace fettle::app {

/// Makes the choices that buttons of the device asked for since the last frame (haptic::StylusButtons), as keys and lists
/// make them: the next tool in the order of the tools, the next tip, the tools around
/// the tip. The status line names it. Behind a dialog nothing is chosen.
/// `parts` has an open document. Threading: main.
void followButtons(Parts& parts);

}  // namespace fettle::app
