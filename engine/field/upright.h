#pragma once

#include "engine/field/version.h"

namespace fettle::engine {

/// The same field without its sign: no sample is touched.
[[nodiscard]] inline Version upright(const Version& version) {
  return version.reader().sign() < 0.0F ? version.inverted() : version;
}

}  // namespace fettle::engine
