/// Whole meshes and a model: how near they come, on which side they lie, how far apart the surfaces are.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/device.hpp>
#include <verisq/recovery.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

MeshClearance clearance(const PythonModel& model, const PythonMesh& mesh, const py::handle& path,
                        double penetration_limit, const std::optional<double>& tolerance,
                        const std::optional<std::uint64_t>& most_samples, const std::string& device) {
  const Model& exact = model.exact("mesh_clearance");
  check_length(penetration_limit, "penetration_limit");
  const bool moves = !path.is_none();
  const std::vector<Pose> way = moves ? poses(path, "path") : std::vector<Pose>();
  Interruption interruption;
  MeshClearanceOptions options{.penetration_limit = penetration_limit,
                               .tolerance = tolerance_along_way(tolerance, model.bounding_radius()),
                               .device = device,
                               .interrupted = interruption.poll()};
  if (most_samples) options.most_samples = *most_samples;
  return without_lock(interruption, [&] {
    return moves ? mesh_clearance_along(way, exact, mesh.mesh, options) : mesh_clearance(exact, mesh.mesh, options);
  });
}

py::array_t<double> points_too_deep(const MeshClearance& self) {
  py::array_t<double> result(std::vector<py::ssize_t>{static_cast<py::ssize_t>(self.too_deep.size()), 3});
  double* next = result.mutable_data();
  for (const PointOnTriangle& at : self.too_deep) {
    for (const double coordinate : at.point) *next++ = coordinate;
  }
  return result;
}

py::array_t<std::uint32_t> triangles_too_deep(const MeshClearance& self) {
  py::array_t<std::uint32_t> result(static_cast<py::ssize_t>(self.too_deep.size()));
  std::uint32_t* next = result.mutable_data();
  for (const PointOnTriangle& at : self.too_deep) *next++ = at.triangle;
  return result;
}

std::string representation_of_clearance(const MeshClearance& self) {
  return fmt::format("<verisq.MeshClearance: smallest distance in [{}, {}]>", self.smallest_distance.lo,
                     self.smallest_distance.hi);
}

ContainmentProof contained(const PythonModel& model, const PythonMesh& mesh, const std::string& where,
                           const std::optional<std::uint64_t>& most_samples, const std::string& device) {
  if (where != "within" && where != "around")
    throw py::value_error(fmt::format("where must be \"within\" or \"around\", not \"{}\"", where));
  const Model& exact = model.exact("prove_containment");
  Interruption interruption;
  ContainmentOptions options{.device = device, .interrupted = interruption.poll()};
  if (most_samples) options.most_samples = *most_samples;
  const Containment containment = where == "within" ? Containment::within : Containment::around;
  return without_lock(interruption, [&] { return prove_containment(exact, mesh.mesh, containment, options); });
}

bool is_containment_proved(const ContainmentProof& self, const PythonModel& model, const PythonMesh& mesh) {
  const Model& exact = model.exact("is_proved");
  return without_lock([&](const Interrupted& interrupted) {
    const CheckOptions options{.interrupted = interrupted};
    const ContainmentFinding found = ContainmentChecker(exact, mesh.mesh)(self.containment, self.certificate, options);
    return self.proven && found.verdict == Verdict::proved;
  });
}

PythonAnswer answer_of(const ContainmentProof& self, const std::filesystem::path& model,
                       const std::filesystem::path& mesh) {
  if (!self.proven) throw py::value_error("nothing is proven: there is no answer to keep");
  return {ContainmentAnswer{subject_file(model), subject_file(mesh), units_of({model}), self.containment,
                            self.certificate}};
}

void declare_containments(py::module_& module) {
  py::class_<ContainmentProof>(module, "ContainmentProof",
                               "What prove_containment() found; proven False is no proof of the contrary.")
      .def_readonly("proven", &ContainmentProof::proven)
      .def_readonly("triangles_proven", &ContainmentProof::triangles_proven, "How many are where they should be.")
      .def_readonly("triangles_refuted", &ContainmentProof::triangles_refuted,
                    "How many have a point that is proven to be on the other side.")
      .def_readonly("triangles_undecided", &ContainmentProof::triangles_undecided)
      .def_readonly("centres_outside", &ContainmentProof::centres_outside,
                    "\"within\": the primitives whose centres are not proven to lie inside the mesh.")
      .def_readonly("maybe_with_cavities", &ContainmentProof::maybe_with_cavities,
                    "\"around\": nothing is proven of cavities of the model.")
      .def_readonly("samples", &ContainmentProof::samples, "Distances asked for.")
      .def(
          "is_proved", is_containment_proved, py::arg("model"), py::arg("mesh"),
          "is_proved(model, mesh) -> bool\n\nProves it again, of this model and this mesh, by MPFR and the certificate "
          "alone.\nRaises Error for meshes that are not closed, or not turned alike all over.")
      .def("answer", answer_of, py::arg("model"), py::arg("mesh"),
           "answer(model, mesh) -> Answer\n\n"
           "What `verisq recover --certificate-file` writes: of this model file and this mesh file. Raises ValueError\n"
           "where nothing is proven.")
      .def(pickled<ContainmentProof>());
  module.def("prove_containment", contained, py::arg("model"), py::arg("mesh"), py::arg("where"), py::kw_only(),
             py::arg("most_samples") = py::none(), py::arg("device") = "auto",
             "prove_containment(model, mesh, where, *, most_samples=None, device=\"auto\") -> ContainmentProof\n\n"
             "Proves, as far as it can, that the model lies \"within\" the solid that the closed Mesh bounds, or\n"
             "\"around\" it. Ends after about most_samples distances (default 2^24). Raises ValueError for another\n"
             "word, Error for models with intervals or set operations, and meshes that bound no solid.");
}

}  // namespace

void declare_clearances(py::module_& module) {
  py::class_<MeshClearance>(module, "MeshClearance", "What mesh_clearance() proves of all points of all triangles.")
      .def_readonly("smallest_distance", &MeshClearance::smallest_distance,
                    "Enclosure of the smallest signed distance; its lower end holds for the whole surface.")
      .def_readonly("proven_within", &MeshClearance::proven_within, "Triangles without a point deeper than the limit.")
      .def_readonly("proven_too_deep", &MeshClearance::proven_too_deep, "Triangles with such a point.")
      .def_readonly("undecided", &MeshClearance::undecided, "All other triangles.")
      .def_property_readonly("points_too_deep", points_too_deep,
                             "float64 (K, 3): of each triangle proven too deep a point that is about as deep as any.")
      .def_property_readonly("triangles_too_deep", triangles_too_deep, "uint32 (K,): these triangles.")
      .def_readonly("samples", &MeshClearance::samples, "Distances asked for.")
      .def("__repr__", representation_of_clearance)
      .def(pickled<MeshClearance>());
  module.def(
      "mesh_clearance", clearance, py::arg("model"), py::arg("mesh"), py::kw_only(), py::arg("path") = py::none(),
      py::arg("penetration_limit") = 0.0, py::arg("tolerance") = py::none(), py::arg("most_samples") = py::none(),
      py::arg("device") = "auto",
      "mesh_clearance(model, mesh, *, path=None, penetration_limit=0.0, tolerance=None, most_samples=None,\n"
      "    device=\"auto\") -> MeshClearance\n\n"
      "Encloses how near the whole surface of a Mesh, between its vertices too, comes to the model, and decides\n"
      "of each triangle whether a point of it lies deeper inside than the limit. With a path, poses of shape\n"
      "(K, 7), all along it (as in map_along). Works until the enclosure is at most the tolerance wide, in\n"
      "model units (default: 1e-3 of the bounding_radius), or after about most_samples distances (default\n"
      "2^23). Raises Error for models with intervals and meshes without triangles, and as map().");
  declare_containments(module);
}

namespace {

namespace py = pybind11;

std::string representation_of_deviation(const Deviation& self) {
  if (!self.hausdorff) return "<verisq.Deviation>";
  return fmt::format("<verisq.Deviation: Hausdorff distance in [{}, {}]>", self.hausdorff->lo, self.hausdorff->hi);
}

Deviation deviation_of(const PythonModel& model, const py::handle& mesh, double relative_tolerance,
                       const std::optional<double>& tolerance, const std::vector<double>& percentiles, bool from_model,
                       bool statistics_of_model, const std::string& device, const std::optional<double>& time_limit) {
  check_time_limit(time_limit);
  const Model& exact = model.exact("deviation");
  const Mesh measured = mesh_or_cloud(mesh);
  Interruption interruption;
  DeviationOptions options{.relative_tolerance = relative_tolerance,
                           .tolerance = tolerance,
                           .percentiles = percentiles,
                           .from_model = from_model,
                           .statistics_of_model = statistics_of_model,
                           .device = device,
                           .interrupted = interruption.poll()};
  Deadline limit(time_limit);
  limit.start();
  options.out_of_time = limit.out_of_time();
  return without_lock(interruption, [&] { return deviation(exact, measured, options); });
}

/// How far a mesh and a model's surface lie apart, with what proves it again.
struct PythonCertifiedDeviation {
  std::vector<double> percents;
  DistanceSummary of_vertices;
  std::optional<DistanceSummary> from_mesh;
  std::optional<Enclosure> from_model;
  std::optional<AreaStatistics> statistics_from_model;
  std::optional<Enclosure> hausdorff;
  DeviationCertificate certificate;
};

PythonCertifiedDeviation certified(const PythonModel& model, const py::handle& mesh, double relative_tolerance,
                                   const std::optional<double>& tolerance, const std::vector<double>& percentiles,
                                   bool from_model, bool statistics_of_model, const std::string& device) {
  const Model& exact = model.exact("certified_deviation");
  const Mesh measured = mesh_or_cloud(mesh);
  Interruption interruption;
  const DeviationOptions options{.relative_tolerance = relative_tolerance,
                                 .tolerance = tolerance,
                                 .percentiles = percentiles,
                                 .from_model = from_model,
                                 .statistics_of_model = statistics_of_model,
                                 .device = device,
                                 .interrupted = interruption.poll()};
  CertifiedDeviation found = without_lock(
      interruption, [&] { return certified_deviation(exact, measured, deviation(exact, measured, options), options); });
  return {percentiles,
          found.proven.of_vertices,
          found.proven.from_mesh,
          found.proven.from_model,
          std::move(found.proven.statistics_from_model),
          found.proven.hausdorff,
          std::move(found.certificate)};
}

/// Of a claim, where there is one.
bool is_claim_proved(const std::optional<Enclosure>& claimed, const std::optional<Enclosure>& proven) {
  return !claimed || (proven && check(*claimed, *proven).verdict == Verdict::proved);
}

template <class Summary>
bool all_proved(const Summary& claimed, const Summary& proven) {
  return std::ranges::all_of(check(claimed, proven),
                             [](const Finding& finding) { return finding.verdict == Verdict::proved; });
}

PythonAnswer answer_of_deviation(const PythonCertifiedDeviation& self, const std::filesystem::path& model,
                                 const std::filesystem::path& mesh) {
  return {DeviationAnswer{.model = subject_file(model),
                          .mesh = subject_file(mesh),
                          .units = units_of({model}),
                          .pose = {},
                          .percentiles = self.percents,
                          .of_vertices = self.of_vertices,
                          .from_mesh = self.from_mesh,
                          .from_model = self.from_model,
                          .statistics_from_model = self.statistics_from_model,
                          .hausdorff = self.hausdorff,
                          .certificate = self.certificate}};
}

bool is_proved(const PythonCertifiedDeviation& self, const PythonModel& model, const py::handle& mesh) {
  const Model& exact = model.exact("is_proved");
  const Mesh measured = mesh_or_cloud(mesh);
  const auto& [vertices, triangles, surface] = self.certificate;
  if (measured.vertices.size() != vertices.size() || measured.triangles.size() != triangles.size()) return false;
  const ProvenDeviation proven = without_lock([&](const Interrupted& interrupted) {
    return DeviationChecker(exact)(measured, self.certificate,
                                   {.percentiles = self.percents,
                                    .statistics_of_model = self.statistics_from_model.has_value(),
                                    .check = {.interrupted = interrupted}});
  });
  return !proven.interrupted && all_proved(self.of_vertices, proven.of_vertices) &&
         (!self.from_mesh || all_proved(*self.from_mesh, *proven.from_mesh)) &&
         (!self.statistics_from_model ||
          (proven.statistics_from_model && all_proved(*self.statistics_from_model, *proven.statistics_from_model))) &&
         is_claim_proved(self.from_model, proven.from_model) && is_claim_proved(self.hausdorff, proven.hausdorff);
}

void declare_certified_deviations(py::module_& module) {
  py::class_<DistanceSummary>(module, "DistanceSummary", "What is proven of the distances of a set of points.")
      .def_readonly("largest", &DistanceSummary::largest, "Enclosure of the supremum.")
      .def_readonly("mean", &DistanceSummary::mean, "Enclosure.")
      .def_readonly("percentiles", &DistanceSummary::percentiles, "Enclosures, as asked for.")
      .def(pickled<DistanceSummary>());
  py::class_<AreaStatistics>(module, "AreaStatistics", "What is proven of a surface's distances by area.")
      .def_readonly("mean", &AreaStatistics::mean, "Enclosure.")
      .def_readonly("percentiles", &AreaStatistics::percentiles, "Enclosures, as asked for.")
      .def(pickled<AreaStatistics>());
  py::class_<PythonCertifiedDeviation>(module, "CertifiedDeviation", "What certified_deviation() proves.")
      .def_readonly("of_vertices", &PythonCertifiedDeviation::of_vertices, "DistanceSummary of the vertices.")
      .def_readonly("from_mesh", &PythonCertifiedDeviation::from_mesh, "... of all points of all triangles, or None.")
      .def_readonly("from_model", &PythonCertifiedDeviation::from_model,
                    "Enclosure of the model's surface's largest distance from the mesh, or None.")
      .def_readonly("statistics_from_model", &PythonCertifiedDeviation::statistics_from_model,
                    "AreaStatistics: mean and percentiles of these distances, or None.")
      .def_readonly("hausdorff", &PythonCertifiedDeviation::hausdorff,
                    "Enclosure of the larger of both largest distances, or None.")
      .def("is_proved", is_proved, py::arg("model"), py::arg("mesh"),
           "is_proved(model, mesh) -> bool\n\n"
           "Proves every number again, of this model and this mesh, by MPFR and the certificates alone.")
      .def("answer", answer_of_deviation, py::arg("model"), py::arg("mesh"),
           "answer(model, mesh) -> Answer\n\n"
           "What `verisq deviation --certificate-file` writes: of this model file, and this file of a mesh or of "
           "points.")
      .def("__repr__",
           [](const PythonCertifiedDeviation& self) {
             const auto& [lo, hi] = (self.from_mesh ? *self.from_mesh : self.of_vertices).largest;
             return fmt::format("<verisq.CertifiedDeviation: largest in [{}, {}]>", lo, hi);
           })
      .def(pickled<PythonCertifiedDeviation>());
  module.def(
      "certified_deviation", certified, py::arg("model"), py::arg("mesh"), py::kw_only(),
      py::arg("relative_tolerance") = 0.05, py::arg("tolerance") = py::none(),
      py::arg("percentiles") = std::vector<double>{50.0, 95.0}, py::arg("from_model") = true,
      py::arg("statistics_of_model") = false, py::arg("device") = "auto",
      "certified_deviation(model, mesh, *, relative_tolerance=0.05, tolerance=None, percentiles=(50, 95),\n"
      "    from_model=True, statistics_of_model=False, device=\"auto\") -> CertifiedDeviation\n\n"
      "As deviation(), with what proves it again: from the mesh, or points of shape (N, 3), to the model's\n"
      "surface, where means and percentiles may be wider, and how far that surface lies from the mesh: at most,\n"
      "and with statistics_of_model in the mean by area, and percentiles.");
}

}  // namespace

void declare_deviations(py::module_& module) {
  py::class_<DistanceStatistics>(module, "DistanceStatistics",
                                 "Of the distances of a set of points: all vertices, or a whole surface, by area.")
      .def_readonly("largest", &DistanceStatistics::largest, "Enclosure of the supremum.")
      .def_readonly("farthest", &DistanceStatistics::farthest, "A point of the set about so far away.")
      .def_readonly("mean", &DistanceStatistics::mean, "Enclosure, or None.")
      .def_readonly("percentiles", &DistanceStatistics::percentiles, "Enclosures, as asked for; empty without.")
      .def(pickled<DistanceStatistics>());
  py::class_<Deviation>(module, "Deviation", "What deviation() proves: distances are Euclidean, not signed.")
      .def_readonly("hausdorff", &Deviation::hausdorff,
                    "Enclosure of the larger of both largest distances; None unless both are known.")
      .def_readonly("of_vertices", &Deviation::of_vertices, "DistanceStatistics: mesh's vertices to the surface.")
      .def_readonly("from_mesh", &Deviation::from_mesh, "... of all points of all triangles; None of a cloud.")
      .def_readonly("from_model", &Deviation::from_model, "... of all points of the model's surface to the mesh.")
      .def_readonly("to_tolerance", &Deviation::to_tolerance, "Whether every enclosure is as narrow as asked for.")
      .def_readonly("out_of_time", &Deviation::out_of_time, "Whether the limit came before.")
      .def("__repr__", representation_of_deviation)
      .def(pickled<Deviation>());
  module.def("deviation", deviation_of, py::arg("model"), py::arg("mesh"), py::kw_only(),
             py::arg("relative_tolerance") = 0.05, py::arg("tolerance") = py::none(),
             py::arg("percentiles") = std::vector<double>{50.0, 95.0}, py::arg("from_model") = true,
             py::arg("statistics_of_model") = false, py::arg("device") = "auto", py::arg("time_limit") = py::none(),
             "deviation(model, mesh, *, relative_tolerance=0.05, tolerance=None, percentiles=(50, 95),\n"
             "    from_model=True, statistics_of_model=False, device=\"auto\", time_limit=None) -> Deviation\n\n"
             "Encloses how far a mesh (a Mesh, or points of shape (N, 3)) and the model's surface lie apart, both\n"
             "ways: the two-sided Hausdorff distance, means and percentiles (of the model's surface with\n"
             "statistics_of_model, which takes longer). Enclosures are at most that share of\n"
             "their upper end wide, or the tolerance, in model units. Raises Error for models with intervals, meshes\n"
             "without vertices, and options out of range.");
  declare_certified_deviations(module);
}

}  // namespace verisq::python
