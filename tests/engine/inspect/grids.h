#pragma once

#include "engine/field/builder.h"

namespace fettle::engine {

inline Grid gridOf(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

}  // namespace fettle::engine
