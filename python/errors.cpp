#include "python/errors.h"

#include <pybind11/pybind11.h>

namespace fettle::python {

namespace py = pybind11;

void raise(const engine::Error& error) {
  // The classes are written in Python, where they have their documentation.
  const char* name = error.kind == engine::ErrorKind::kInput ? "InputError" : "Error";
  const py::object kind = py::module_::import("fettle._errors").attr(name);
  const py::object raised = kind(error.what, error.where, error.remedy);
  PyErr_SetObject(kind.ptr(), raised.ptr());
  throw py::error_already_set();
}

}  // namespace fettle::python
