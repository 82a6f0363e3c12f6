#pragma once

#include <string>

namespace fettle::app {

/// Something the user should read.
struct Notice {
  std::string what;
  std::string remedy;
};

}  // namespace fettle::app
