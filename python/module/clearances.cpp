/// Whole meshes, between their vertices too: how near they come to a model, and on which side of it they lie.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/containment.hpp>
#include <verisq/mesh_clearance.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_mesh.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<PointAcross> = 2;
template <>
inline constexpr std::size_t member_count<ContainmentProof> = 9;

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

std::string representation(const MeshClearance& self) {
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
      .def("__repr__", representation)
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

}  // namespace verisq::python
