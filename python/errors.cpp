#include "python/errors.h"

namespace fettle::python {

namespace py = pybind11;

py::str textOf(const std::string& text) {
  PyObject* decoded = PyUnicode_DecodeFSDefaultAndSize(text.data(), static_cast<Py_ssize_t>(text.size()));
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

py::list textsOf(const std::vector<std::string>& texts) {
  py::list all;
  for (const std::string& text : texts) all.append(textOf(text));
  return all;
}

void raise(const engine::Error& error) {
  // The classes are written in Python, where they have their documentation.
  const char* name = error.kind == engine::ErrorKind::kInput ? "InputError" : "Error";
  const py::object kind = py::module_::import("fettle._errors").attr(name);
  const py::object raised = kind(textOf(error.what), textOf(error.where), textOf(error.remedy));
  PyErr_SetObject(kind.ptr(), raised.ptr());
  throw py::error_already_set();
}

}  // namespace fettle::python
