/// The class verisq.Mesh: an immutable mesh or cloud, of which arrays are views.
#pragma once

#include <pybind11/numpy.h>

#include <verisq/mesh.hpp>

namespace verisq::python {

struct PythonMesh {
  Mesh mesh;
};

/// What stands for a mesh: a verisq.Mesh, or an array of points (N, 3): a cloud.
[[nodiscard]] Mesh mesh_or_cloud(pybind11::handle object);

}  // namespace verisq::python
