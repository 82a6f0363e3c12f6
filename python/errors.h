#pragma once

#include <utility>

#include "engine/base/error.h"

namespace fettle::python {

/// Raises fettle.InputError or fettle.Error with the three texts. Thread: holds the GIL.
[[noreturn]] void raise(const engine::Error& error);

/// The value, or the error as an exception of Python. Thread: holds the GIL.
template <class T>
[[nodiscard]] T valueOf(engine::Result<T> result) {
  if (!result) raise(result.error());
  return *std::move(result);
}

}  // namespace fettle::python
