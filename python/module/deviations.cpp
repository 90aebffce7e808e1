/// How far a mesh and a model's surface lie apart.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/deviation.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_mesh.hpp"
#include "python/module/python_model.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<DistanceStatistics> = 4;
template <>
inline constexpr std::size_t member_count<Deviation> = 12;

namespace {

namespace py = pybind11;

std::string representation(const Deviation& self) {
  if (!self.hausdorff) return "<verisq.Deviation>";
  return fmt::format("<verisq.Deviation: Hausdorff distance in [{}, {}]>", self.hausdorff->lo, self.hausdorff->hi);
}

Deviation deviation_of(const PythonModel& model, const py::handle& mesh, double relative_tolerance,
                       const std::optional<double>& tolerance, const std::vector<double>& percentiles, bool from_model,
                       const std::string& device, const std::optional<double>& time_limit) {
  check_time_limit(time_limit);
  const Model& exact = model.exact("deviation");
  const Mesh measured = mesh_or_cloud(mesh);
  Interruption interruption;
  DeviationOptions options{.relative_tolerance = relative_tolerance,
                           .tolerance = tolerance,
                           .percentiles = percentiles,
                           .from_model = from_model,
                           .device = device,
                           .interrupted = interruption.poll()};
  const auto start = std::chrono::steady_clock::now();
  if (time_limit) {
    options.out_of_time = [start, limit = *time_limit] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= limit;
    };
  }
  return without_lock(interruption, [&] { return deviation(exact, measured, options); });
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
      .def("__repr__", representation)
      .def(pickled<Deviation>());
  module.def("deviation", deviation_of, py::arg("model"), py::arg("mesh"), py::kw_only(),
             py::arg("relative_tolerance") = 0.05, py::arg("tolerance") = py::none(),
             py::arg("percentiles") = std::vector<double>{50.0, 95.0}, py::arg("from_model") = true,
             py::arg("device") = "auto", py::arg("time_limit") = py::none(),
             "deviation(model, mesh, *, relative_tolerance=0.05, tolerance=None, percentiles=(50, 95),\n"
             "    from_model=True, device=\"auto\", time_limit=None) -> Deviation\n\n"
             "Encloses how far a mesh (a Mesh, or points of shape (N, 3)) and the model's surface lie apart, both\n"
             "ways: the two-sided Hausdorff distance, means and percentiles. Enclosures are at most that share of\n"
             "their upper end wide, or the tolerance, in model units. Raises Error for models with intervals, meshes\n"
             "without vertices, and options out of range.");
}

}  // namespace verisq::python
