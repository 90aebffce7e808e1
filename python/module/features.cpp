/// Features of femurs, and models recovered from clouds and meshes.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/features.hpp>
#include <verisq/recovery.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

struct PythonFemur {
  py::dict landmarks;
  py::object side;
  std::vector<std::string> notes;
};

PythonFemur detect(const PythonMesh& mesh, const std::optional<std::string>& side) {
  const std::optional<Side> given = side_of(side);
  const Interruption interruption;
  const DetectedFemur found = without_lock(interruption, [&] { return detect_femur(mesh.mesh, given); });
  py::object seen = py::none();
  if (found.side) seen = py::str(*found.side == Side::left ? "left" : "right");
  return {dictionary(found.landmarks), seen, found.notes};
}

FemurFeatures features(const py::dict& landmarks, const std::optional<std::string>& side, double landmark_radius) {
  return femur_features(landmarks_of(landmarks), side_of(side), landmark_radius);
}

bool is_proved(const FemurFeatures& self, const py::dict& landmarks, const std::optional<std::string>& side,
               double landmark_radius) {
  const std::vector<Finding> findings =
      check({landmarks_of(landmarks), side_of(side), landmark_radius, self.features, self.frame}).all();
  return std::ranges::all_of(findings, [](const Finding& finding) { return finding.verdict == Verdict::proved; });
}

PythonAnswer answer_of(const FemurFeatures& self, const py::dict& landmarks, const std::optional<std::string>& side,
                       double landmark_radius, const std::optional<std::filesystem::path>& mesh) {
  return {
      FeaturesAnswer{.implant = {},
                     .mesh = mesh ? std::optional(subject_file(*mesh)) : std::nullopt,
                     .claims = {landmarks_of(landmarks), side_of(side), landmark_radius, self.features, self.frame}}};
}

std::string representation(const Feature& self) {
  return fmt::format("<verisq.Feature: {} in [{}, {}]{}>", self.name, self.value.lo, self.value.hi,
                     self.unit == FeatureUnit::degrees ? " degrees" : "");
}

}  // namespace

void declare_features(py::module_& module) {
  py::class_<PythonFemur>(module, "Femur", "What detect_femur() saw, in floating point: nothing is proven.")
      .def_readonly("landmarks", &PythonFemur::landmarks, "Points by their names, as in a landmark file.")
      .def_readonly("side", &PythonFemur::side, "\"left\", \"right\" or None.")
      .def_readonly("notes", &PythonFemur::notes, "How each landmark was found, a sentence each.")
      .def(pickled<PythonFemur>());
  py::class_<Feature>(module, "Feature", "A number that describes a femur.")
      .def_readonly("name", &Feature::name, "\"ccd\", \"offset\", ...")
      .def_readonly("method", &Feature::method, "By which definition.")
      .def_readonly("value", &Feature::value, "Enclosure of what every choice of the landmarks gives.")
      .def_property_readonly(
          "unit", [](const Feature& self) { return self.unit == FeatureUnit::degrees ? "degrees" : "length"; },
          "\"degrees\" or \"length\", which is in the mesh's unit.")
      .def("__repr__", representation)
      .def(pickled<Feature>());
  py::class_<FemurFeatures>(module, "FemurFeatures", "What femur_features() encloses.")
      .def_readonly("features", &FemurFeatures::features, "A list of Feature.")
      .def_readonly("missing", &FemurFeatures::missing, "What could not be said, and why, a sentence each.")
      .def("is_proved", is_proved, py::arg("landmarks"), py::arg("side") = py::none(), py::kw_only(),
           py::arg("landmark_radius"),
           "is_proved(landmarks, side=None, *, landmark_radius) -> bool\n\n"
           "Encloses every feature again, in 127 bits, and compares: of these landmarks.")
      .def("answer", answer_of, py::arg("landmarks"), py::arg("side") = py::none(), py::kw_only(),
           py::arg("landmark_radius"), py::arg("mesh") = py::none(),
           "answer(landmarks, side=None, *, landmark_radius, mesh=None) -> Answer\n\n"
           "What `verisq features --certificate-file` writes; mesh: the file in which the landmarks were found.")
      .def(pickled<FemurFeatures>());
  module.def("detect_femur", detect, py::arg("mesh"), py::arg("side") = py::none(),
             "detect_femur(mesh, side=None) -> Femur\n\nFinds the landmarks of a whole or proximal femur, in\n"
             "millimetres, in floating point. Raises Error for a mesh that is none.");
  module.def(
      "femur_features", features, py::arg("landmarks"), py::arg("side") = py::none(), py::kw_only(),
      py::arg("landmark_radius"),
      "femur_features(landmarks, side=None, *, landmark_radius) -> FemurFeatures\n\nEncloses what the landmarks\n"
      "say (a dictionary of points, as Femur.landmarks), each anywhere within that radius.");
}

namespace {

namespace py = pybind11;

struct PythonRecovery {
  PythonModel model;
  std::vector<RecoveryStage> stages;
  double outliers;
  std::size_t points;
  bool out_of_time;
};

PythonRecovery recover_model(const py::handle& shape, std::size_t primitives, const std::optional<double>& deviation,
                             bool taper, bool bend, double most_outliers, std::uint64_t seed, const std::string& units,
                             const std::optional<double>& time_limit) {
  check_time_limit(time_limit);
  const Mesh mesh = mesh_or_cloud(shape);
  Interruption interruption;
  Deadline limit(time_limit, interruption.poll());
  limit.start();
  const RecoveryOptions options{.primitives = primitives,
                                .deviation = deviation,
                                .taper = taper,
                                .bend = bend,
                                .most_outliers = most_outliers,
                                .seed = seed,
                                .interrupted = limit.stop()};
  Recovery found = without_lock(interruption, [&] { return recover(mesh, options); });
  found.model.units = units;
  return {PythonModel(found.model), std::move(found.stages), found.outliers, found.points, found.interrupted};
}

}  // namespace

void declare_recoveries(py::module_& module) {
  py::class_<EstimatedDeviation>(module, "EstimatedDeviation", "Of samples, in floating point: nothing is proven.")
      .def_readonly("mean", &EstimatedDeviation::mean)
      .def_readonly("root_mean_square", &EstimatedDeviation::root_mean_square)
      .def_readonly("percentile_95", &EstimatedDeviation::percentile_95)
      .def_readonly("largest", &EstimatedDeviation::largest)
      .def(pickled<EstimatedDeviation>());
  py::class_<RecoveryStage>(module, "RecoveryStage", "What a model of so many primitives reached.")
      .def_readonly("primitives", &RecoveryStage::primitives)
      .def_readonly("to_model", &RecoveryStage::to_model, "EstimatedDeviation of the points that are no outliers.")
      .def_readonly("to_mesh", &RecoveryStage::to_mesh, "... of samples of the model's surface; None of a cloud.")
      .def(pickled<RecoveryStage>());
  py::class_<PythonRecovery>(module, "Recovery", "What recover() found; ask deviation() for what is proven of it.")
      .def_readonly("model", &PythonRecovery::model, "The union of its primitives.")
      .def_readonly("stages", &PythonRecovery::stages, "A RecoveryStage for each number of primitives that was tried.")
      .def_readonly("outliers", &PythonRecovery::outliers, "Share of the points that belong to nothing, estimated.")
      .def_readonly("points", &PythonRecovery::points, "Of the cloud, or sampled on the mesh.")
      .def_readonly("out_of_time", &PythonRecovery::out_of_time, "Whether time_limit ended it, with the best by then.")
      .def(pickled<PythonRecovery>());
  module.def("recover", recover_model, py::arg("shape"), py::kw_only(), py::arg("primitives") = 1,
             py::arg("deviation") = py::none(), py::arg("taper") = false, py::arg("bend") = false,
             py::arg("most_outliers") = 0.6, py::arg("seed") = 1, py::arg("units") = "",
             py::arg("time_limit") = py::none(),
             "recover(shape, *, primitives=1, deviation=None, taper=False, bend=False, most_outliers=0.6, seed=1,\n"
             "    units=\"\", time_limit=None) -> Recovery\n\n"
             "The likeliest superquadric, or union of several, for a Mesh or for points of shape (N, 3) on its\n"
             "surface: moved by noise, missing in parts, some of them outliers. With deviation, in model units, it\n"
             "stops once 95 % are that near. The same seed gives the same model. time_limit: in seconds. Floating "
             "point: nothing is proven.\n"
             "Raises Error for fewer than 12 points, points in a plane, and options out of range.");
}

}  // namespace verisq::python
