/// verisq.distance_along and certified_distance_along: the smallest distance of two models while one moves, and when
/// they first meet.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/certified_path.hpp>
#include <verisq/path_distance.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<PathDistance> = 8;
template <>
inline constexpr std::size_t member_count<PathClaims> = 2;
template <>
inline constexpr std::size_t member_count<PathPart> = 2;
template <>
inline constexpr std::size_t member_count<PathCertificate> = 3;

namespace {

namespace py = pybind11;

std::string word(PathProximity proximity) {
  switch (proximity) {
    case PathProximity::apart: return "apart";
    case PathProximity::meeting: return "meeting";
    case PathProximity::undecided: break;
  }
  return "undecided";
}

/// What both functions take; the models must outlive it.
struct Travel {
  const Model& resting;
  const Model& moving;
  std::vector<Pose> path;
  PathDistanceOptions options;
};

Travel travel(const char* function, const PythonModel& a, const PythonModel& b, const py::handle& path,
              const std::optional<double>& tolerance, double time_tolerance) {
  check_units(a, b);
  const Model& resting = a.exact(function);
  const Model& moving = b.exact(function);
  // With bends or set operations it takes more moments, so less is asked for.
  constexpr double usually_coarser = 100.0;
  const bool convex = is_union_of_convex(resting) && is_union_of_convex(moving);
  const double radius = std::max(a.bounding_radius(), b.bounding_radius());
  const double width = tolerance_or_default(tolerance, convex ? radius : usually_coarser * radius);
  return {resting, moving, poses(path, "path"), {.tolerance = width, .time_tolerance = time_tolerance}};
}

PathDistance along(const PythonModel& a, const PythonModel& b, const py::handle& path,
                   const std::optional<double>& tolerance, double time_tolerance) {
  Travel of = travel("distance_along", a, b, path, tolerance, time_tolerance);
  Interruption interruption;
  of.options.interrupted = interruption.poll();
  return without_lock(interruption, [&] { return distance_along(of.path, of.resting, of.moving, of.options); });
}

struct PythonCertifiedPath {
  PathClaims claims;
  PathCertificate certificate;

  static constexpr std::size_t members = 2;
};

PythonCertifiedPath certified_along(const PythonModel& a, const PythonModel& b, const py::handle& path,
                                    const std::optional<double>& tolerance, double time_tolerance) {
  Travel of = travel("certified_distance_along", a, b, path, tolerance, time_tolerance);
  Interruption interruption;
  of.options.interrupted = interruption.poll();
  CertifiedPath certified = without_lock(interruption, [&] {
    const PathDistance found = distance_along(of.path, of.resting, of.moving, of.options);
    return certified_path(of.path, of.resting, of.moving, found, of.options);
  });
  return {certified.claims, std::move(certified.certificate)};
}

bool is_proved(const PythonCertifiedPath& self, const PythonModel& a, const PythonModel& b, const py::handle& path) {
  const PathChecker checker(a.exact("is_proved"), b.exact("is_proved"), poses(path, "path"));
  Interruption interruption;
  const PathClaims proven =
      without_lock(interruption, [&] { return checker.prove(self.certificate, {.interrupted = interruption.poll()}); });
  const auto [smallest, first_contact] = check(self.claims, proven);
  return smallest.verdict == Verdict::proved && (!first_contact || first_contact->verdict == Verdict::proved);
}

std::string representation(const PathDistance& self) {
  return fmt::format("<verisq.PathDistance: {}, [{}, {}]>", word(self.proximity), self.smallest.lo, self.smallest.hi);
}

}  // namespace

void declare_paths(py::module_& module) {
  py::class_<PathDistance>(module, "PathDistance", "What distance_along() returns. Time k is that of pose k.")
      .def_readonly("smallest", &PathDistance::smallest,
                    "Enclosure of the smallest distance of all times, 0 where the models are proven to meet.")
      .def_readonly("smallest_at", &PathDistance::smallest_at, "A time at which the distance is at most smallest.hi.")
      .def_property_readonly(
          "proximity", [](const PathDistance& self) { return word(self.proximity); },
          "\"apart\" (no common point at any time) or \"meeting\" where that is proven, else \"undecided\".")
      .def_readonly("apart_before", &PathDistance::apart_before, "Proven: no common point at any time before this one.")
      .def_readonly("meet_at", &PathDistance::meet_at,
                    "A time at which a common point is proven: the first contact is not later. Else None.")
      .def_readonly("reached", &PathDistance::reached, "Whether the tolerances were reached.")
      .def_readonly("moments", &PathDistance::moments, "At how many times distances were enclosed.")
      .def("__repr__", representation)
      .def(pickled<PathDistance>());
  py::class_<PythonCertifiedPath>(module, "CertifiedPath", "What certified_distance_along() proves.")
      .def_property_readonly(
          "smallest", [](const PythonCertifiedPath& self) { return self.claims.smallest; },
          "Enclosure of the smallest distance of all times: what the certificate proves.")
      .def_property_readonly(
          "first_contact", [](const PythonCertifiedPath& self) { return self.claims.first_contact; },
          "Enclosure of the first time at which the models have a common point, its hi infinite where none is proven;\n"
          "None where they are proven to be apart at all times.")
      .def("is_proved", is_proved, py::arg("a"), py::arg("b"), py::arg("path"),
           "is_proved(a, b, path) -> bool\n\n"
           "Proves both again, of these models and this path, by MPFR and the certificate alone.")
      .def("__repr__",
           [](const PythonCertifiedPath& self) {
             return fmt::format("<verisq.CertifiedPath: [{}, {}]>", self.claims.smallest.lo, self.claims.smallest.hi);
           })
      .def(pickled<PythonCertifiedPath>());
  module.def(
      "certified_distance_along", certified_along, py::arg("a"), py::arg("b"), py::arg("path"), py::kw_only(),
      py::arg("tolerance") = py::none(), py::arg("time_tolerance") = 1e-6,
      "certified_distance_along(a, b, path, *, tolerance=None, time_tolerance=1e-6) -> CertifiedPath\n\n"
      "As distance_along(), with what proves the answer again. Of models with bends or set operations it may be\n"
      "wider than that.");
  module.def("distance_along", along, py::arg("a"), py::arg("b"), py::arg("path"), py::kw_only(),
             py::arg("tolerance") = py::none(), py::arg("time_tolerance") = 1e-6,
             "distance_along(a, b, path, *, tolerance=None, time_tolerance=1e-6) -> PathDistance\n\n"
             "Encloses the smallest distance of model a and of model b, which moves by the poses of an array (N, 7),\n"
             "translations and quaternions [w, x, y, z]; proven at all times, between the poses too: there the\n"
             "translation is linear and the rotation turns about a fixed axis at constant speed, by the smaller\n"
             "angle. tolerance: of the smallest distance, by default 1e-6 of the larger bounding_radius, 1e-4 with\n"
             "bends or set operations; time_tolerance: of the first contact. Raises Error for models with intervals,\n"
             "and units that differ.");
}

}  // namespace verisq::python
