#pragma once

#include <string>
#include <vector>

namespace fettle::tests {

/// What a program that draws nothing takes to follow a hand on a display: from a movement of the cursor until the server has
/// copied a frame of this size from memory that it shares with the program, which has filled it in between [ms], so many times.
/// Nothing that draws on this display can be quicker. Empty where the display shares no memory. One thread.
[[nodiscard]] std::vector<double> leastFrames(const std::string& display, int width, int height, int frames);

}  // namespace fettle::tests
