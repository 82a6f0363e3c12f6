#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "engine/base/error.h"

namespace fettle::python {

/// A text that may name a file: its bytes as Python's os.fsdecode reads them. Thread: holds the GIL.
[[nodiscard]] pybind11::str textOf(const std::string& text);
[[nodiscard]] pybind11::list textsOf(const std::vector<std::string>& texts);

/// Raises fettle.InputError or fettle.Error with the three texts. Thread: holds the GIL.
[[noreturn]] void raise(const engine::Error& error);

/// The value, or the error as an exception of Python. Thread: holds the GIL.
template <class T>
[[nodiscard]] T valueOf(engine::Result<T> result) {
  if (!result) raise(result.error());
  return *std::move(result);
}

}  // namespace fettle::python
