/// verisq.Enclosure and single queries: the distance of a point, of two models, and of two while one moves.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/path.hpp>
#include <verisq/penetration.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

double end(const Enclosure& enclosure, py::ssize_t index) {
  if (index == 0 || index == -2) return enclosure.lo;
  if (index == 1 || index == -1) return enclosure.hi;
  throw py::index_error("an enclosure has two ends");
}

/// NaN is no end.
Enclosure enclosure_of(double lo, double hi) {
  if (!(lo <= hi)) throw py::value_error(fmt::format("an enclosure's lo must be at most hi, not {} and {}", lo, hi));
  return {lo, hi};
}

std::string representation_of_enclosure(const Enclosure& enclosure) {
  return fmt::format("Enclosure(lo={}, hi={})", enclosure.lo, enclosure.hi);
}

}  // namespace

void declare_enclosures(py::module_& module) {
  py::class_<Enclosure>(module, "Enclosure",
                        "Enclosure(lo, hi)\n\nAn interval of binary64 numbers that contains the exact real result; an\n"
                        "infinite end is one on whose side nothing is proven. lo, hi = enclosure takes it apart.")
      .def(py::init(&enclosure_of), py::arg("lo"), py::arg("hi"))
      .def_readonly("lo", &Enclosure::lo, "Lower end.")
      .def_readonly("hi", &Enclosure::hi, "Upper end.")
      .def_property_readonly("width", &Enclosure::width, "hi - lo, to nearest.")
      .def("__contains__", &Enclosure::contains)
      .def("__len__", [](const Enclosure&) { return 2; })
      .def("__getitem__", end)
      .def(
          "__eq__", [](const Enclosure& self, const Enclosure& other) { return self == other; }, py::is_operator())
      .def("__hash__", [](const Enclosure& self) { return py::hash(py::make_tuple(self.lo, self.hi)); })
      .def("__repr__", representation_of_enclosure)
      .def(py::pickle(
          [](const Enclosure& self) { return py::make_tuple(self.lo, self.hi); },
          [](const py::tuple& ends) { return enclosure_of(ends[0].cast<double>(), ends[1].cast<double>()); }));
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
            return without_lock([&](const Interrupted& interrupted) { return self(at, tolerance, interrupted); });
          },
          py::arg("point"), py::arg("tolerance") = 0.0,
          "__call__(point, tolerance=0.0) -> Enclosure\n\nOf a point [x, y, z] in model units: positive outside, the\n"
          "Euclidean distance; negative inside, minus the distance to the boundary. Works until the enclosure is at\n"
          "most the tolerance wide or the method's limit is reached; 0 asks for the tightest.");
}

namespace {

namespace py = pybind11;

struct PythonPair {
  Enclosure distance;
  Proximity proximity;
  std::optional<ClosestPoints> closest;
  std::optional<Point> common;
  bool complete;
  std::optional<Enclosure> penetration_depth;
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
  return {found.distance,           found.proximity, pair.closest_points(found, pose, stop),
          found.certificate.common, found.complete,  std::nullopt};
}

PythonPair searched(const PythonModel& a, const PythonModel& b, const Pose& pose, double tolerance,
                    const std::function<bool()>& stop) {
  constexpr const char* what = "pairs with bends or set operations";
  const SearchedDistance found =
      ModelSearch(a.exact(what), b.exact(what))(pose, {.tolerance = tolerance, .interrupted = stop});
  return {found.distance, found.proximity, std::nullopt, found.common, found.reached, std::nullopt};
}

PythonPair distance(const PythonModel& a, const PythonModel& b, const py::handle& pose_of_b,
                    const std::optional<double>& tolerance, const std::optional<double>& time_limit) {
  check_units(a, b);
  check_time_limit(time_limit);
  const Pose moved = pose(pose_of_b);
  const double width = tolerance_or_default(tolerance, std::max(a.bounding_radius(), b.bounding_radius()));
  const bool convex = is_union_of_convex(a.largest()) && is_union_of_convex(b.largest());
  Interruption interruption;
  Deadline limit(time_limit, interruption.poll());
  limit.start();
  const std::function<bool()> stop = limit.stop();
  return without_lock(interruption, [&] {
    PythonPair pair = convex ? certified(a, b, moved, stop) : searched(a, b, moved, width, stop);
    if (is_exact(a.model()) && is_exact(b.model()) && !(pair.distance.lo > 0.0)) {
      const PenetrationDepth depth(a.largest(), b.largest());
      pair.penetration_depth = depth(moved, {.tolerance = width, .common = pair.common, .interrupted = stop}).depth;
    }
    return pair;
  });
}

/// A distance with what proves it again.
struct CertifiedPair {
  Enclosure distance;
  PairCertificate certificate;
  std::optional<CertifiedPenetration> penetration;
};

CertifiedPair certified_distance(const PythonModel& a, const PythonModel& b, const py::handle& pose_of_b,
                                 const std::optional<double>& tolerance) {
  check_units(a, b);
  const Model& one = a.exact("certified_distance");
  const Model& other = b.exact("certified_distance");
  const Pose moved = pose(pose_of_b);
  const double width = tolerance_or_default(tolerance, std::max(a.bounding_radius(), b.bounding_radius()));
  return without_lock([&](const Interrupted& interrupted) {
    auto [distance, certificate] = CertifiedDistances(one, other, width)(moved, interrupted);
    CertifiedPair pair{distance, std::move(certificate), std::nullopt};
    if (!(distance.lo > 0.0)) {
      pair.penetration = PenetrationDepth(one, other)(
          moved, {.tolerance = width, .common = pair.certificate.common, .interrupted = interrupted});
    }
    return pair;
  });
}

bool pair_is_proved(const CertifiedPair& self, const PythonModel& a, const PythonModel& b,
                    const py::handle& pose_of_b) {
  const Model& one = a.exact("is_proved");
  const Model& other = b.exact("is_proved");
  const Pose moved = pose(pose_of_b);
  return without_lock([&](const Interrupted& interrupted) {
    const Finding finding = PairChecker(one, other)(moved, self.distance, self.certificate, interrupted);
    if (finding.verdict != Verdict::proved || !self.penetration) return finding.verdict == Verdict::proved;
    const auto& [depth, certificate] = *self.penetration;
    const PenetrationChecker checker(one, other);
    return checker(moved, depth, certificate, interrupted).verdict == Verdict::proved;
  });
}

PythonAnswer answer_of(const CertifiedPair& self, const std::filesystem::path& a, const std::filesystem::path& b,
                       const py::handle& pose_of_b) {
  return {PairAnswer{{subject_file(a), subject_file(b)},
                     units_of({a, b}),
                     pose(pose_of_b),
                     self.distance,
                     self.certificate,
                     self.penetration}};
}

std::string representation_of_pair(const PythonPair& self) {
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
      .def_readonly(
          "penetration_depth", &PythonPair::penetration_depth,
          "Enclosure of the length of the shortest translation of b after which a and b have no common inner\n"
          "point, of exact models that are not proven to be apart, else None.")
      .def("__repr__", representation_of_pair)
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
      .def_property_readonly(
          "penetration_depth",
          [](const CertifiedPair& self) {
            return self.penetration ? std::optional(self.penetration->depth) : std::nullopt;
          },
          "As that of a Pair, as far as its certificate proves it.")
      .def("is_proved", pair_is_proved, py::arg("a"), py::arg("b"), py::arg("pose") = py::none(),
           "is_proved(a, b, pose=None) -> bool\n\n"
           "Proves the enclosure again, of these models and this pose, by MPFR and the certificate alone.")
      .def("answer", answer_of, py::arg("a"), py::arg("b"), py::arg("pose") = py::none(),
           "answer(a, b, pose=None) -> Answer\n\n"
           "What `verisq distance --certificate-file` writes: of these model files, and the pose of model b.")
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
                   const std::optional<double>& tolerance, double time_tolerance,
                   const std::optional<double>& time_limit) {
  check_time_limit(time_limit);
  Travel of = travel("distance_along", a, b, path, tolerance, time_tolerance);
  Interruption interruption;
  Deadline limit(time_limit, interruption.poll());
  limit.start();
  of.options.interrupted = limit.stop();
  return without_lock(interruption, [&] { return distance_along(of.path, of.resting, of.moving, of.options); });
}

struct PythonCertifiedPath {
  PathClaims claims;
  PathCertificate certificate;
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

bool path_is_proved(const PythonCertifiedPath& self, const PythonModel& a, const PythonModel& b,
                    const py::handle& path) {
  const PathChecker checker(a.exact("is_proved"), b.exact("is_proved"), poses(path, "path"));
  const PathClaims proven = without_lock(
      [&](const Interrupted& interrupted) { return checker.prove(self.certificate, {.interrupted = interrupted}); });
  const auto [smallest, first_contact] = check(self.claims, proven);
  return smallest.verdict == Verdict::proved && (!first_contact || first_contact->verdict == Verdict::proved);
}

PythonAnswer answer_of_path(const PythonCertifiedPath& self, const std::filesystem::path& a,
                            const std::filesystem::path& b, const py::handle& path) {
  return {PathAnswer{
      {subject_file(a), subject_file(b)}, units_of({a, b}), poses(path, "path"), self.claims, self.certificate}};
}

std::string representation_of_path(const PathDistance& self) {
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
      .def_readonly("out_of_time", &PathDistance::interrupted, "Whether time_limit ended it: valid, and wide.")
      .def_readonly("moments", &PathDistance::moments, "At how many times distances were enclosed.")
      .def("__repr__", representation_of_path)
      .def(pickled<PathDistance>());
  py::class_<PythonCertifiedPath>(module, "CertifiedPath", "What certified_distance_along() proves.")
      .def_property_readonly(
          "smallest", [](const PythonCertifiedPath& self) { return self.claims.smallest; },
          "Enclosure of the smallest distance of all times: what the certificate proves.")
      .def_property_readonly(
          "first_contact", [](const PythonCertifiedPath& self) { return self.claims.first_contact; },
          "Enclosure of the first time at which the models have a common point, its hi infinite where none is proven;\n"
          "None where they are proven to be apart at all times.")
      .def("is_proved", path_is_proved, py::arg("a"), py::arg("b"), py::arg("path"),
           "is_proved(a, b, path) -> bool\n\n"
           "Proves both again, of these models and this path, by MPFR and the certificate alone.")
      .def("answer", answer_of_path, py::arg("a"), py::arg("b"), py::arg("path"),
           "answer(a, b, path) -> Answer\n\n"
           "What `verisq path --certificate-file` writes: of these model files, and the path of model b.")
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
             py::arg("tolerance") = py::none(), py::arg("time_tolerance") = 1e-6, py::arg("time_limit") = py::none(),
             "distance_along(a, b, path, *, tolerance=None, time_tolerance=1e-6, time_limit=None) -> PathDistance\n\n"
             "Encloses the smallest distance of model a and of model b, which moves by the poses of an array (N, 7),\n"
             "translations and quaternions [w, x, y, z]; proven at all times, between the poses too: there the\n"
             "translation is linear and the rotation turns about a fixed axis at constant speed, by the smaller\n"
             "angle. tolerance: of the smallest distance, by default 1e-6 of the larger bounding_radius, 1e-4 with\n"
             "bends or set operations; time_tolerance: of the first contact; time_limit: in seconds. Raises Error for\n"
             "models with intervals, and units that differ.");
}

}  // namespace verisq::python
