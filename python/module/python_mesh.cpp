/// verisq.Mesh: from files and arrays; the surface of a model.
#include "python/module/python_mesh.hpp"

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>
#include <verisq/mesh_file.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model_mesh.hpp>

#include "python/module/arrays.hpp"
#include "python/module/declarations.hpp"
#include "python/module/interruption.hpp"
#include "python/module/python_model.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

/// A view of rows of three that `owner` keeps: read-only.
template <class Value>
py::array view(const std::vector<std::array<Value, 3>>& rows, const py::handle& owner) {
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows.size()), 3};
  const py::array_t<Value> array(shape, rows.empty() ? nullptr : rows.front().data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

template <class Value>
py::array_t<Value> copied(const std::vector<std::array<Value, 3>>& rows) {
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows.size()), 3};
  return py::array_t<Value>(shape, rows.empty() ? nullptr : rows.front().data());
}

std::string representation(const PythonMesh& self) {
  return fmt::format("<verisq.Mesh: {} vertices, {} triangles>", self.mesh.vertices.size(), self.mesh.triangles.size());
}

bool is_closed(const PythonMesh& self) {
  return !self.mesh.triangles.empty() && mesh_topology(self.mesh).bounds_solid();
}

PythonMesh mesh_of_model(const PythonModel& model, double deviation) {
  const Model& exact = model.exact("mesh_of_model");
  Interruption interruption;
  return without_lock(interruption, [&] {
    return PythonMesh{model_mesh(exact, {.deviation = deviation, .interrupted = interruption.poll()}).mesh};
  });
}

}  // namespace

Mesh mesh_or_cloud(py::handle object) {
  if (py::isinstance<PythonMesh>(object)) return object.cast<const PythonMesh&>().mesh;
  return mesh(object, py::none());
}

void declare_meshes(py::module_& module) {
  py::class_<PythonMesh>(
      module, "Mesh",
      "Mesh(vertices, triangles=None)\n\nVertices, an array of shape (N, 3), and triangles, indices\n"
      "of shape (M, 3); without triangles it is a cloud. Both are copied. Raises ValueError for\n"
      "other shapes and for indices that no vertex has, Error for coordinates that are not finite.")
      .def(py::init([](const py::handle& vertices, const py::handle& triangles) {
             return PythonMesh{mesh(vertices, triangles)};
           }),
           py::arg("vertices"), py::arg("triangles") = py::none())
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            const py::gil_scoped_release released;
            return PythonMesh{read_mesh(path)};
          },
          py::arg("path"),
          "load(path) -> Mesh\n\nReads STL, OBJ, PLY or OFF, by the extension. Equal corners of an STL are merged,\n"
          "polygons of others split into triangles. Raises Error with file and line or byte for what is damaged.")
      .def(
          "save",
          [](const PythonMesh& self, const std::filesystem::path& path) {
            const py::gil_scoped_release released;
            write_mesh(path, self.mesh);
          },
          py::arg("path"),
          "save(path)\n\nWrites PLY, OFF, OBJ (bit for bit) or STL (rounded to binary32), by the extension.")
      .def_property_readonly(
          "vertices", [](const py::object& self) { return view(self.cast<const PythonMesh&>().mesh.vertices, self); },
          "float64 (N, 3), a read-only view.")
      .def_property_readonly(
          "triangles", [](const py::object& self) { return view(self.cast<const PythonMesh&>().mesh.triangles, self); },
          "uint32 (M, 3), a read-only view: indices of vertices.")
      .def_property_readonly("is_closed", is_closed,
                             "Whether it bounds a solid: closed, manifold and consistently oriented, by its indices.")
      .def("__repr__", representation)
      .def(py::pickle(
          [](const PythonMesh& self) {
            return py::make_tuple(copied(self.mesh.vertices), copied(self.mesh.triangles));
          },
          [](const py::tuple& parts) { return PythonMesh{mesh(parts[0], parts[1])}; }));
  module.def(
      "mesh_of_model", mesh_of_model, py::arg("model"), py::arg("deviation"),
      "mesh_of_model(model, deviation) -> Mesh\n\nThe model's surface as a closed mesh, about so near to it, in\n"
      "model units: floating point, nothing is proven of it (ask deviation()). Raises Error for a deviation\n"
      "that is not positive or too small, and for models with intervals.");
}

}  // namespace verisq::python
