/// verisq.closest_points and verisq.closest_pairs: boxes of closest points and normals as arrays.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/distance.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

/// One number for each row.
template <class Number, class Get>
py::array_t<Number> column(const PythonClosestPoints& self, const Get& get) {
  py::array_t<Number> result(static_cast<py::ssize_t>(self.rows.size()));
  Number* to = result.mutable_data();
  for (const ClosestPoint& row : self.rows) *to++ = get(row);
  return result;
}

/// N enclosures for each row: an array (rows, N, 2).
template <std::size_t N, class Get>
py::array_t<double> enclosures(const PythonClosestPoints& self, const Get& get) {
  py::array_t<double> result({self.rows.size(), N, std::size_t{2}});
  double* to = result.mutable_data();
  for (std::size_t i = 0; i < self.rows.size(); ++i) {
    const std::array<Enclosure, N> all = get(i);
    for (const Enclosure& enclosure : all) {
      *to++ = enclosure.lo;
      *to++ = enclosure.hi;
    }
  }
  return result;
}

py::array_t<double> gradient_by_motion_of_points(const PythonClosestPoints& self, const py::handle& object) {
  const Point centre = point(object);
  const PointColumns points = columns(self.points);
  return enclosures<6>(self, [&](std::size_t i) { return gradient_by_motion(self.rows[i], points[i], centre); });
}

PythonClosestPoints closest_points_once(const PythonModel& model, const py::handle& object,
                                        const std::optional<double>& tolerance) {
  const double absolute = tolerance_or_default(tolerance, model.bounding_radius());
  return closest_points_of(SignedDistance(model.exact("closest_points")), object, absolute);
}

std::string representation_of_points(const PythonClosestPoints& self) {
  return fmt::format("<verisq.ClosestPointMap: {} rows, {} unique>", self.rows.size(), self.summary.unique);
}

}  // namespace

PythonClosestPoints closest_points_of(const SignedDistance& distance, const py::handle& object, double tolerance) {
  PythonClosestPoints found{numbers(object, "points", {-1, 3}), {}, {}};
  const PointColumns points = columns(found.points);
  without_lock([&](const Interrupted& interrupted) {
    found.rows.resize(points.size());
    found.summary = closest_points(distance, points, found.rows, {.tolerance = tolerance, .interrupted = interrupted});
    return true;
  });
  return found;
}

void declare_closest_points(py::module_& module) {
  py::class_<PythonClosestPoints>(
      module, "ClosestPointMap",
      "What closest_points() returns: row i of each array is that of point i. Boxes are arrays whose last axis is\n"
      "lo, hi. They contain every closest point, and where `unique` the gradient of the signed distance.")
      .def_property_readonly(
          "lo",
          [](const PythonClosestPoints& self) {
            return column<double>(self, [](const auto& r) { return r.distance.lo; });
          },
          "float64 (N,): lower ends of the signed distances.")
      .def_property_readonly(
          "hi",
          [](const PythonClosestPoints& self) {
            return column<double>(self, [](const auto& r) { return r.distance.hi; });
          },
          "float64 (N,): upper ends of the signed distances.")
      .def_property_readonly(
          "unique",
          [](const PythonClosestPoints& self) { return column<bool>(self, [](const auto& r) { return r.unique; }); },
          "bool (N,): proven that there is one closest point, and that the signed distance is differentiable.")
      .def_property_readonly(
          "point",
          [](const PythonClosestPoints& self) {
            return enclosures<3>(self, [&](std::size_t i) { return self.rows[i].point; });
          },
          "float64 (N, 3, 2): boxes that contain every closest point of the model's surface.")
      .def_property_readonly(
          "normal",
          [](const PythonClosestPoints& self) {
            return enclosures<3>(self, [&](std::size_t i) { return self.rows[i].normal; });
          },
          "float64 (N, 3, 2): boxes of the outward unit normals there: of the gradient of the signed distance by\n"
          "position. [-1, 1] where nothing is proven.")
      .def_property_readonly(
          "primitive",
          [](const PythonClosestPoints& self) {
            return column<std::int32_t>(
                self, [](const auto& r) { return r.primitive ? static_cast<std::int32_t>(*r.primitive) : -1; });
          },
          "int32 (N,): index in Model.names of the primitive whose surface has the closest point; -1 where it is not\n"
          "proven.")
      .def("gradient_by_motion", gradient_by_motion_of_points, py::arg("centre"),
           "gradient_by_motion(centre) -> float64 (N, 6, 2)\n\nBoxes of the derivatives of the signed distances when\n"
           "the points are moved: by a translation (three numbers, per model unit), and by a rotation about `centre`\n"
           "(three, per radian about x, y, z). Where the model is moved instead, their negatives.")
      .def("__len__", [](const PythonClosestPoints& self) { return self.rows.size(); })
      .def("__repr__", representation_of_points)
      .def(pickled<PythonClosestPoints>());

  module.def("closest_points", closest_points_once, py::arg("model"), py::arg("points"), py::kw_only(),
             py::arg("tolerance") = py::none(),
             "closest_points(model, points, *, tolerance=None) -> ClosestPointMap\n\nFor each point of an array (N, 3) "
             "where the model's surface is closest, the normal there and which primitive decides,\nas boxes that are "
             "proven to contain them, with the host's processors. The tolerance is that of map(), for distances of\n"
             "points whose closest point is not proven. Raises Error for models with intervals and points that are "
             "not finite.");
}

namespace {

namespace py = pybind11;

struct PythonClosestPairs {
  std::vector<ClosestPoints> rows;
  ClosestPointSummary summary;
};

PythonClosestPairs closest_pairs_of(const PythonModel& a, const PythonModel& b, const py::handle& object) {
  check_units(a, b);
  const std::vector<Pose> queries = poses(object, "poses");
  const PairDistance distance(a.exact("closest_pairs"), b.exact("closest_pairs"));
  PythonClosestPairs found{std::vector<ClosestPoints>(queries.size()), {}};
  found.summary = without_lock(
      [&](const Interrupted& interrupted) { return closest_points(distance, queries, found.rows, interrupted); });
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

std::string representation_of_pairs(const PythonClosestPairs& self) {
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
      .def("__repr__", representation_of_pairs)
      .def(pickled<PythonClosestPairs>());
  module.def(
      "closest_pairs", closest_pairs_of, py::arg("a"), py::arg("b"), py::arg("poses"),
      "closest_pairs(a, b, poses) -> ClosestPairMap\n\nWhere model a and model b, moved by each pose of an array "
      "(N, 7), are closest: boxes that are proven\nto contain the closest points, by the host's processors; some "
      "milliseconds a pose. Distances: map_poses().\nRaises Error for models with intervals, bends or set "
      "operations, and units that differ.");
}

}  // namespace verisq::python
