/// Landmarks and features of a femur.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/features_certificate.hpp>

#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/landmarks.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_mesh.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

struct PythonFemur {
  py::dict landmarks;
  py::object side;
  std::vector<std::string> notes;

  static constexpr std::size_t members = 3;
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

}  // namespace verisq::python
