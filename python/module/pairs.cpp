/// The distance of two models.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <verisq/certified_distance.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/model_search.hpp>
#include <verisq/pair_checker.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

struct PythonPair {
  Enclosure distance;
  Proximity proximity;
  std::optional<ClosestPoints> closest;
  std::optional<Point> common;
  bool complete;

  static constexpr std::size_t members = 5;
};

std::string word(Proximity proximity) {
  switch (proximity) {
    case Proximity::separated: return "separated";
    case Proximity::overlapping: return "overlapping";
    case Proximity::undecided: break;
  }
  return "undecided";
}

/// By certificates of convex primitives.
PythonPair certified(const PythonModel& a, const PythonModel& b, const Pose& pose, const std::function<bool()>& stop) {
  const PairDistance pair(a.model(), b.model());
  const ModelDistance found = pair(pose, stop);
  return {found.distance, found.proximity, pair.closest_points(found, pose, stop), found.certificate.common,
          found.complete};
}

PythonPair searched(const PythonModel& a, const PythonModel& b, const Pose& pose, double tolerance,
                    const std::function<bool()>& stop) {
  constexpr const char* what = "pairs with bends or set operations";
  const SearchedDistance found =
      ModelSearch(a.exact(what), b.exact(what))(pose, {.tolerance = tolerance, .interrupted = stop});
  return {found.distance, found.proximity, std::nullopt, found.common, found.reached};
}

PythonPair distance(const PythonModel& a, const PythonModel& b, const py::handle& pose_of_b,
                    const std::optional<double>& tolerance, const std::optional<double>& time_limit) {
  check_units(a, b);
  check_time_limit(time_limit);
  const Pose moved = pose(pose_of_b);
  const double width = tolerance_or_default(tolerance, std::max(a.bounding_radius(), b.bounding_radius()));
  const bool convex = is_union_of_convex(a.largest()) && is_union_of_convex(b.largest());
  const auto start = std::chrono::steady_clock::now();
  Interruption interruption;
  const std::function<bool()> stop = [&, interrupted = interruption.poll()] {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    return interrupted() || (time_limit && passed.count() >= *time_limit);
  };
  return without_lock(interruption,
                      [&] { return convex ? certified(a, b, moved, stop) : searched(a, b, moved, width, stop); });
}

/// A distance with what proves it again.
struct CertifiedPair {
  Enclosure distance;
  PairCertificate certificate;

  static constexpr std::size_t members = 2;
};

CertifiedPair certified_distance(const PythonModel& a, const PythonModel& b, const py::handle& pose_of_b,
                                 const std::optional<double>& tolerance) {
  check_units(a, b);
  const Model& one = a.exact("certified_distance");
  const Model& other = b.exact("certified_distance");
  const Pose moved = pose(pose_of_b);
  const double width = tolerance_or_default(tolerance, std::max(a.bounding_radius(), b.bounding_radius()));
  Interruption interruption;
  auto [distance, certificate] =
      without_lock(interruption, [&] { return CertifiedDistances(one, other, width)(moved, interruption.poll()); });
  return {distance, std::move(certificate)};
}

bool is_proved(const CertifiedPair& self, const PythonModel& a, const PythonModel& b, const py::handle& pose_of_b) {
  const PairChecker checker(a.exact("is_proved"), b.exact("is_proved"));
  return checker(pose(pose_of_b), self.distance, self.certificate).verdict == Verdict::proved;
}

std::string representation(const PythonPair& self) {
  return fmt::format("<verisq.Pair: {}, [{}, {}]>", word(self.proximity), self.distance.lo, self.distance.hi);
}

}  // namespace

void declare_pairs(py::module_& module) {
  py::class_<ClosestPoints>(module, "ClosestPoints",
                            "Boxes, in the frame of model a, that contain every pair of closest points.")
      .def_readonly("on_a", &ClosestPoints::on_a, "Three Enclosures: x, y, z.")
      .def_readonly("on_b", &ClosestPoints::on_b, "Three Enclosures: x, y, z.")
      .def_readonly("unique", &ClosestPoints::unique, "Whether it is proven that there is exactly one pair.")
      .def(pickled<ClosestPoints>());
  py::class_<PythonPair>(module, "Pair", "What distance() returns.")
      .def_readonly("distance", &PythonPair::distance, "Enclosure of the distance, 0 where the models meet.")
      .def_property_readonly(
          "proximity", [](const PythonPair& self) { return word(self.proximity); },
          "\"separated\" or \"overlapping\" where that is proven, else \"undecided\".")
      .def_readonly("closest", &PythonPair::closest,
                    "ClosestPoints of separated exact unions of convex primitives, else None.")
      .def_readonly("common", &PythonPair::common, "A point proven to lie in both, in the frame of a, or None.")
      .def_readonly("complete", &PythonPair::complete,
                    "False where the time limit or a budget ended it early, or rounding errors: valid, and wide.")
      .def("__repr__", representation)
      .def(pickled<PythonPair>());
  module.def("distance", distance, py::arg("a"), py::arg("b"), py::arg("pose") = py::none(), py::kw_only(),
             py::arg("tolerance") = py::none(), py::arg("time_limit") = py::none(),
             "distance(a, b, pose=None, *, tolerance=None, time_limit=None) -> Pair\n\n"
             "Encloses the distance of model a and of model b moved by the pose: seven numbers, translation and\n"
             "quaternion [w, x, y, z]. Models with bends or set operations are searched until the enclosure is at\n"
             "most the tolerance wide, by default 1e-6 of the larger bounding_radius; all others are as tight as the\n"
             "method gives. Raises Error for units that differ, and as `verisq distance` does.");
  py::class_<CertifiedPair>(module, "CertifiedPair", "What certified_distance() proves.")
      .def_readonly("distance", &CertifiedPair::distance, "Enclosure of the distance: what the certificate proves.")
      .def("is_proved", is_proved, py::arg("a"), py::arg("b"), py::arg("pose") = py::none(),
           "is_proved(a, b, pose=None) -> bool\n\n"
           "Proves the enclosure again, of these models and this pose, by MPFR and the certificate alone.")
      .def("__repr__",
           [](const CertifiedPair& self) {
             return fmt::format("<verisq.CertifiedPair: [{}, {}]>", self.distance.lo, self.distance.hi);
           })
      .def(pickled<CertifiedPair>());
  module.def("certified_distance", certified_distance, py::arg("a"), py::arg("b"), py::arg("pose") = py::none(),
             py::kw_only(), py::arg("tolerance") = py::none(),
             "certified_distance(a, b, pose=None, *, tolerance=None) -> CertifiedPair\n\n"
             "As distance(), of models without intervals, with what proves the enclosure again. Of models with bends\n"
             "or set operations it may be wider than that of distance(), as of bent necks beside rims.");
}

}  // namespace verisq::python
