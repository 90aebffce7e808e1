/// verisq.closest_pairs: the closest points of two models in many poses, as arrays.
#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>
#include <verisq/closest_points.hpp>
#include <verisq/model_distance.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

struct PythonClosestPairs {
  std::vector<ClosestPoints> rows;
  ClosestPointSummary summary;

  static constexpr std::size_t members = 2;
};

PythonClosestPairs closest_pairs_of(const PythonModel& a, const PythonModel& b, const py::handle& object) {
  check_units(a, b);
  const std::vector<Pose> queries = poses(object, "poses");
  const PairDistance distance(a.exact("closest_pairs"), b.exact("closest_pairs"));
  PythonClosestPairs found{std::vector<ClosestPoints>(queries.size()), {}};
  Interruption interruption;
  found.summary =
      without_lock(interruption, [&] { return closest_points(distance, queries, found.rows, interruption.poll()); });
  return found;
}

/// The boxes of one of the models: an array (rows, 3, 2).
auto boxes(EnclosedPoint ClosestPoints::*member) {
  return [member](const PythonClosestPairs& self) {
    py::array_t<double> result({self.rows.size(), std::size_t{3}, std::size_t{2}});
    double* to = result.mutable_data();
    for (const ClosestPoints& row : self.rows) {
      for (const Enclosure& coordinate : row.*member) {
        *to++ = coordinate.lo;
        *to++ = coordinate.hi;
      }
    }
    return result;
  };
}

py::array_t<bool> unique(const PythonClosestPairs& self) {
  py::array_t<bool> result(static_cast<py::ssize_t>(self.rows.size()));
  bool* to = result.mutable_data();
  for (const ClosestPoints& row : self.rows) *to++ = row.unique;
  return result;
}

std::string representation(const PythonClosestPairs& self) {
  return fmt::format("<verisq.ClosestPairMap: {} rows, {} unique>", self.rows.size(), self.summary.unique);
}

}  // namespace

void declare_closest_pairs(py::module_& module) {
  py::class_<PythonClosestPairs>(
      module, "ClosestPairMap",
      "What closest_pairs() returns: row i of each array is that of pose i. Boxes are arrays whose last axis is lo, "
      "hi,\n"
      "in the frame of model a. They contain every pair of closest points; infinite where the models are not proven to "
      "be\napart.")
      .def_property_readonly("on_a", boxes(&ClosestPoints::on_a), "float64 (N, 3, 2): of the points of model a.")
      .def_property_readonly("on_b", boxes(&ClosestPoints::on_b), "float64 (N, 3, 2): of the points of model b.")
      .def_property_readonly("unique", unique, "bool (N,): proven that there is exactly one pair of closest points.")
      .def("__len__", [](const PythonClosestPairs& self) { return self.rows.size(); })
      .def("__repr__", representation)
      .def(pickled<PythonClosestPairs>());
  module.def(
      "closest_pairs", closest_pairs_of, py::arg("a"), py::arg("b"), py::arg("poses"),
      "closest_pairs(a, b, poses) -> ClosestPairMap\n\nWhere model a and model b, moved by each pose of an array "
      "(N, 7), are closest: boxes that are proven\nto contain the closest points, by the host's processors; some "
      "milliseconds a pose. Distances: map_poses().\nRaises Error for models with intervals, bends or set "
      "operations, and units that differ.");
}

}  // namespace verisq::python
