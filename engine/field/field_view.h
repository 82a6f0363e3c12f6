#pragma once

#include <cstdint>

#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// What a picture shows of a field: these tiles, around this sample.
struct FieldView {
  TileRange tiles;
  std::int32_t column = 0, row = 0;
  friend bool operator==(const FieldView&, const FieldView&) = default;
};

}  // namespace fettle::engine
