/// verisq.Enclosure, what every single query returns, and the host's own proof of a point.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <string>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/signed_distance.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/python_model.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

double end(const Enclosure& enclosure, py::ssize_t index) {
  if (index == 0 || index == -2) return enclosure.lo;
  if (index == 1 || index == -1) return enclosure.hi;
  throw py::index_error("an enclosure has two ends");
}

std::string representation(const Enclosure& enclosure) {
  return fmt::format("Enclosure(lo={}, hi={})", enclosure.lo, enclosure.hi);
}

}  // namespace

void declare_enclosures(py::module_& module) {
  py::class_<Enclosure>(module, "Enclosure",
                        "Enclosure(lo, hi)\n\nAn interval of binary64 numbers that contains the exact real result; an\n"
                        "infinite end is one on whose side nothing is proven. lo, hi = enclosure takes it apart.")
      .def(py::init([](double lo, double hi) {
             return Enclosure{lo, hi};
           }),
           py::arg("lo"), py::arg("hi"))
      .def_readonly("lo", &Enclosure::lo, "Lower end.")
      .def_readonly("hi", &Enclosure::hi, "Upper end.")
      .def_property_readonly("width", &Enclosure::width, "hi - lo, to nearest.")
      .def("__contains__", &Enclosure::contains)
      .def("__len__", [](const Enclosure&) { return 2; })
      .def("__getitem__", end)
      .def(
          "__eq__", [](const Enclosure& self, const Enclosure& other) { return self == other; }, py::is_operator())
      .def("__hash__", [](const Enclosure& self) { return py::hash(py::make_tuple(self.lo, self.hi)); })
      .def("__repr__", representation)
      .def(py::pickle([](const Enclosure& self) { return py::make_tuple(self.lo, self.hi); },
                      [](const py::tuple& ends) {
                        return Enclosure{ends[0].cast<double>(), ends[1].cast<double>()};
                      }));
}

void declare_signed_distance(py::module_& module) {
  py::class_<SignedDistance>(module, "SignedDistance",
                             "SignedDistance(model)\n\nThe host's own proof of the signed distance of single points:\n"
                             "no OpenCL, slow, the last word. Called with a point. Safe to call from many threads.\n"
                             "Raises Error for models with intervals.")
      .def(py::init([](const PythonModel& model) {
             return std::make_unique<SignedDistance>(model.exact("SignedDistance"));
           }),
           py::arg("model"))
      .def(
          "__call__",
          [](const SignedDistance& self, const py::handle& object, double tolerance) {
            const Point at = point(object);
            if (!std::isfinite(at[0]) || !std::isfinite(at[1]) || !std::isfinite(at[2]))
              throw Error(ErrorKind::input, fmt::format("point ({}, {}, {}) is not finite", at[0], at[1], at[2]));
            check_length(tolerance, "tolerance");
            Interruption interruption;
            return without_lock(interruption, [&] { return self(at, tolerance, interruption.poll()); });
          },
          py::arg("point"), py::arg("tolerance") = 0.0,
          "__call__(point, tolerance=0.0) -> Enclosure\n\nOf a point [x, y, z] in model units: positive outside, the\n"
          "Euclidean distance; negative inside, minus the distance to the boundary. Works until the enclosure is at\n"
          "most the tolerance wide or the method's limit is reached; 0 asks for the tightest.");
}

}  // namespace verisq::python
