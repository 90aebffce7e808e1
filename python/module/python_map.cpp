/// Arrays of rows, and what Python sees of them.
#include "python/module/python_map.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <string>

#include "python/module/declarations.hpp"
#include "python/module/pickling.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

/// The bytes of the array, which are values of the enumeration.
Status* statuses(py::array_t<std::uint8_t>& array) {
  return reinterpret_cast<Status*>(array.mutable_data());
}

py::object smallest(const PythonMap& self) {
  if (self.summary.points == 0) return py::none();
  return py::cast(Enclosure{self.summary.minimum_lo, self.summary.minimum_hi});
}

std::string representation(const PythonMap& self) {
  return fmt::format("<verisq.Map: {} rows, {} wide, by {}>", self.summary.points, self.summary.wide,
                     self.summary.device);
}

py::object verified_rows(const PythonMap& self) {
  return self.status.attr("__ne__")(static_cast<int>(Status::wide));
}

}  // namespace

PythonMap empty_map(std::size_t size, double tolerance) {
  const auto length = static_cast<py::ssize_t>(size);
  return {py::array_t<double>(length),
          py::array_t<double>(length),
          py::array_t<std::uint8_t>(length),
          nullptr,
          {},
          tolerance};
}

ResultColumns columns(PythonMap& map) {
  return {static_cast<std::size_t>(map.lo.size()),
          {map.lo.mutable_data()},
          {map.hi.mutable_data()},
          {statuses(map.status)}};
}

PythonMap map_of_rows(std::span<const MapResult> rows, const MapSummary& summary, double tolerance) {
  PythonMap map = empty_map(rows.size(), tolerance);
  const ResultColumns into = columns(map);
  for (std::size_t i = 0; i < rows.size(); ++i) into.set(i, rows[i]);
  map.summary = summary;
  return map;
}

void declare_class_of_maps(py::module_& module) {
  const auto summary = [](auto MapSummary::*member) {
    return [member](const PythonMap& self) { return self.summary.*member; };
  };
  py::class_<PythonMap>(
      module, "Map",
      "What a map returns: row i of the arrays lo, hi and status is that of query i. The exact value\n"
      "is at least lo[i] and at most hi[i]. lo, hi, status = map takes it apart.")
      .def_readonly("lo", &PythonMap::lo, "float64 (N,): lower ends, in model units.")
      .def_readonly("hi", &PythonMap::hi, "float64 (N,): upper ends, in model units; infinite where none is proven.")
      .def_readonly("status", &PythonMap::status, "uint8 (N,): values of Status.")
      .def_property_readonly("verified", verified_rows,
                             "bool (N,): which rows are at most the tolerance wide. The others are valid, too.")
      .def_property_readonly(
          "certificates", [](const PythonMap& self) { return self.certificates; },
          "What proves each row again (Certificates), where it was asked for; else None.")
      .def_readonly("tolerance", &PythonMap::tolerance, "In model units.")
      .def_property_readonly("smallest", smallest, "Enclosure of the smallest distance of all rows; None without rows.")
      .def_property_readonly("largest_width", summary(&MapSummary::largest_width), "Of all rows.")
      .def_property_readonly("device", summary(&MapSummary::device), "The device's name, or \"host\".")
      .def_property_readonly("device_verified", summary(&MapSummary::device_verified), "How many rows.")
      .def_property_readonly("host_verified", summary(&MapSummary::host_verified), "How many rows.")
      .def_property_readonly("wide", summary(&MapSummary::wide), "How many rows are wider than the tolerance.")
      .def_property_readonly("wide_inside", summary(&MapSummary::wide_inside),
                             "How many of those have a lower end below 0.")
      .def_property_readonly("device_seconds", summary(&MapSummary::device_seconds), "During which kernels ran.")
      .def_property_readonly("host_seconds", summary(&MapSummary::host_seconds), "Wall time of the host's proofs.")
      .def_property_readonly("out_of_time", summary(&MapSummary::out_of_time),
                             "Whether the time limit came while rows were wide.")
      .def_property_readonly("notice", summary(&MapSummary::notice),
                             "Why a device was passed over; empty when nothing is to be said.")
      .def("__len__", [](const PythonMap& self) { return self.lo.size(); })
      .def("__iter__", [](const PythonMap& self) { return py::iter(py::make_tuple(self.lo, self.hi, self.status)); })
      .def("__repr__", representation)
      .def(pickled<PythonMap>());
}

}  // namespace verisq::python
