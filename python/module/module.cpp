/// This file implements module.hpp.
#include "python/module/module.hpp"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <exception>
#include <string>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/error.hpp>
#include <verisq/version.hpp>

#include "python/module/pickling.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

constexpr const char* explanation =
    "A refusal or failure of verisq: one line, that of the command line. It is a ValueError and an OSError, too.\n\n"
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
  const py::tuple bases =
      py::make_tuple(py::handle(PyExc_ValueError), py::handle(PyExc_OSError));  // as io.UnsupportedOperation
  const auto type =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc("verisq.Error", explanation, bases.ptr(), nullptr));
  if (!type) throw py::error_already_set();
  type.attr("kind") = word(ErrorKind::input);
  module.attr("Error") = type;
  py::register_exception_translator(translate);
}

namespace {

namespace py = pybind11;

std::vector<DeviceReport> devices() {
  const py::gil_scoped_release released;
  return test_devices();
}

std::string representation(const DeviceReport& self) {
  return fmt::format("<verisq.Device {}: {}, {}>", self.index, self.name, self.passed ? "passed" : "failed");
}

}  // namespace

void declare_devices(py::module_& module) {
  py::class_<DeviceReport>(module, "Device", "An OpenCL device, and what the self-test of its arithmetic says.")
      .def_readonly("index", &DeviceReport::index, "Its text is what `device` accepts.")
      .def_readonly("name", &DeviceReport::name)
      .def_readonly("platform", &DeviceReport::platform)
      .def_readonly("driver", &DeviceReport::driver)
      .def_readonly("vector_width", &DeviceReport::vector_width, "Points a work-item.")
      .def_readonly("passed", &DeviceReport::passed, "The self-test: others are never used.")
      .def_readonly("failure", &DeviceReport::failure, "The failing operation; empty when passed.")
      .def("__repr__", representation)
      .def(pickled<DeviceReport>());
  module.def(
      "devices", devices,
      "devices() -> list of Device\n\nAll OpenCL devices, each tested, or as tested before (a cache on the disk).");
}

}  // namespace verisq::python

PYBIND11_MODULE(_verisq, module) {
  // Docstrings begin with signatures in the package's own words; _verisq.pyi has the types.
  pybind11::options options;
  options.disable_function_signatures();
  module.doc() = "The compiled part of the package verisq.";
  module.attr("__version__") = VERISQ_VERSION;
  verisq::leave_compilations_at_exit();  // which comes after Python's own end
  verisq::python::declare_errors(module);
  verisq::python::declare_enclosures(module);
  verisq::python::declare_models(module);
  verisq::python::declare_signed_distance(module);
  verisq::python::declare_meshes(module);
  verisq::python::declare_class_of_maps(module);
  verisq::python::declare_maps(module);
  verisq::python::declare_certificates(module);
  verisq::python::declare_closest_points(module);
  verisq::python::declare_closest_pairs(module);
  verisq::python::declare_answers(module);
  verisq::python::declare_pairs(module);
  verisq::python::declare_paths(module);
  verisq::python::declare_deviations(module);
  verisq::python::declare_recoveries(module);
  verisq::python::declare_features(module);
  verisq::python::declare_octrees(module);
  verisq::python::declare_clearances(module);
  verisq::python::declare_insertions(module);
  verisq::python::declare_fits(module);
  verisq::python::declare_stances(module);
  verisq::python::declare_devices(module);
}
