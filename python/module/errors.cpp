/// verisq.Error: the library's exception, with the line that the command line prints.
#include <pybind11/pybind11.h>

#include <exception>
#include <utility>
#include <verisq/error.hpp>

#include "python/module/declarations.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

constexpr const char* explanation =
    "What verisq refuses or fails at: one line, that of the command line.\n\n"
    "kind: \"input\" for a file, value or option that the caller can correct; \"failure\" where the program, a device\n"
    "or the file system failed.";

const char* word(ErrorKind kind) {
  return kind == ErrorKind::input ? "input" : "failure";
}

/// Translators are plain functions: the class is found where the module keeps it.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const Error& error) {
    const py::object type = py::module_::import("verisq._verisq").attr("Error");
    const py::object value = type(error.what());
    value.attr("kind") = word(error.kind());
    PyErr_SetObject(type.ptr(), value.ptr());
  }
}

}  // namespace

void declare_errors(py::module_& module) {
  const auto type =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc("verisq.Error", explanation, nullptr, nullptr));
  if (!type) throw py::error_already_set();
  type.attr("kind") = word(ErrorKind::input);
  module.attr("Error") = type;
  py::register_exception_translator(translate);
}

}  // namespace verisq::python
