#pragma once

// The options for Vulkan's C++ headers in this room.
#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#include <vulkan/vulkan_raii.hpp>
