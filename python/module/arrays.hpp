/// NumPy arrays as queries: where they lie if they are binary64, else widened where that is exact.
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/columns.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/plane_cut.hpp>

namespace verisq::python {

/// Numbers of one shape; -1 stands for any length. The array itself, whatever its strides, if it holds aligned binary64
/// of this machine's byte order; else a copy, in which every number is the same. Throws TypeError for types whose
/// numbers binary64 may not hold (but 64-bit integers where all lie within 2^53) and for masked arrays, ValueError for
/// other shapes.
[[nodiscard]] pybind11::array numbers(pybind11::handle object, std::string_view name,
                                      const std::vector<pybind11::ssize_t>& shape);

/// The points of an array of shape (N, 3), which must outlive them. Precondition: from `numbers`.
[[nodiscard]] PointColumns columns(const pybind11::array& points);

/// Copies of an array of shape (N, 3).
[[nodiscard]] std::vector<Point> points(pybind11::handle object, std::string_view name);
/// ... (N, 3, 3): corners of triangles.
[[nodiscard]] std::vector<Triangle> triangles(pybind11::handle object, std::string_view name);
/// ... (N, 7): translation and quaternion [w, x, y, z].
[[nodiscard]] std::vector<Pose> poses(pybind11::handle object, std::string_view name);

/// Copies of integers of shape (N,). Throws TypeError for other types, ValueError for other shapes and where they are
/// beyond 2^53.
[[nodiscard]] std::vector<std::int64_t> integers(pybind11::handle object, std::string_view name);

/// A sequence of seven numbers, or None: no motion. Throws Error(input) for numbers that are not finite and a
/// quaternion of zero.
[[nodiscard]] Pose pose(pybind11::handle object);
/// A sequence of three numbers.
[[nodiscard]] Point point(pybind11::handle object);

/// A sequence of six numbers, a point and a normal of any length, or None. Throws Error(input) for numbers that are not
/// finite and a normal of zero.
[[nodiscard]] std::optional<Plane> plane(pybind11::handle object);

/// Vertices (N, 3), and triangles (M, 3) of indices, or None: a cloud. Throws ValueError also for an index that no
/// vertex has, Error(input) for coordinates that are not finite.
[[nodiscard]] Mesh mesh(pybind11::handle vertices, pybind11::handle triangles);

}  // namespace verisq::python
