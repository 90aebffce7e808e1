/// Models of point clouds and meshes: a search in floating point.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/recovery.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/pickling.hpp"
#include "python/module/python_mesh.hpp"
#include "python/module/python_model.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<EstimatedDeviation> = 4;
template <>
inline constexpr std::size_t member_count<RecoveryStage> = 4;

namespace {

namespace py = pybind11;

struct PythonRecovery {
  PythonModel model;
  std::vector<RecoveryStage> stages;
  double outliers;
  std::size_t points;

  static constexpr std::size_t members = 4;
};

PythonRecovery recover_model(const py::handle& shape, std::size_t primitives, const std::optional<double>& deviation,
                             bool taper, bool bend, double most_outliers, std::uint64_t seed,
                             const std::string& units) {
  const Mesh mesh = mesh_or_cloud(shape);
  Interruption interruption;
  const RecoveryOptions options{.primitives = primitives,
                                .deviation = deviation,
                                .taper = taper,
                                .bend = bend,
                                .most_outliers = most_outliers,
                                .seed = seed,
                                .interrupted = interruption.poll()};
  Recovery found = without_lock(interruption, [&] { return recover(mesh, options); });
  found.model.units = units;
  return {PythonModel(found.model), std::move(found.stages), found.outliers, found.points};
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
      .def(pickled<PythonRecovery>());
  module.def("recover", recover_model, py::arg("shape"), py::kw_only(), py::arg("primitives") = 1,
             py::arg("deviation") = py::none(), py::arg("taper") = false, py::arg("bend") = false,
             py::arg("most_outliers") = 0.6, py::arg("seed") = 1, py::arg("units") = "",
             "recover(shape, *, primitives=1, deviation=None, taper=False, bend=False, most_outliers=0.6, seed=1,\n"
             "    units=\"\") -> Recovery\n\n"
             "The likeliest superquadric, or union of several, for a Mesh or for points of shape (N, 3) on its\n"
             "surface: moved by noise, missing in parts, some of them outliers. With deviation, in model units, it\n"
             "stops once 95 % are that near. The same seed gives the same model. Floating point: nothing is proven.\n"
             "Raises Error for fewer than 12 points, points in a plane, and options out of range.");
}

}  // namespace verisq::python
