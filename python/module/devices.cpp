/// Which devices there are.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <string>
#include <vector>
#include <verisq/device.hpp>

#include "python/module/declarations.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<DeviceReport> = 7;

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
