/// What makes an array readable in place, and the copies of all others.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <verisq/error.hpp>

#include "python/module/module.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

/// Up to here every integer is a binary64.
constexpr std::int64_t largest_exact_integer = std::int64_t{1} << 53;

py::module_ numpy() {
  return py::module_::import("numpy");
}

/// Functions that read objects of other packages: python/verisq/_objects.py.
py::object reader(const char* name) {
  return py::module_::import("verisq._objects").attr(name);
}

std::string text(const py::handle& object) {
  return py::str(object);
}

py::array as_array(const py::handle& object, std::string_view name) {
  py::array array = numpy().attr("asanyarray")(is_mesh(object) ? reader("vertices")(object)
                                                               : py::reinterpret_borrow<py::object>(object));
  // What is masked would count.
  if (numpy().attr("ma").attr("isMaskedArray")(array).cast<bool>())
    throw py::type_error(fmt::format("{} must not be a masked array: leave out what is masked", name));
  return array;
}

/// "(N, 3)"
std::string text_of_shape(const std::vector<py::ssize_t>& shape) {
  std::string result;
  for (const py::ssize_t length : shape) {
    result += (result.empty() ? "" : ", ") + (length < 0 ? std::string("N") : std::to_string(length));
  }
  return fmt::format("({}{})", result, shape.size() == 1 ? "," : "");
}

void check_shape(const py::array& array, std::string_view name, const std::vector<py::ssize_t>& shape) {
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (std::size_t k = 0; fits && k < shape.size(); ++k) {
    fits = shape[k] < 0 || array.shape(static_cast<py::ssize_t>(k)) == shape[k];
  }
  if (!fits) {
    throw py::value_error(
        fmt::format("{} must be an array of shape {}, not {}", name, text_of_shape(shape), text(array.attr("shape"))));
  }
}

bool is_within_exact_integers(const py::array& array) {
  if (array.size() == 0) return true;
  const py::int_ limit(largest_exact_integer);
  return array.attr("max")() <= limit && array.attr("min")() >= py::int_(-largest_exact_integer);
}

void check_type(const py::array& array, std::string_view name) {
  const char kind = array.dtype().kind();
  const py::ssize_t bytes = array.itemsize();
  if (kind == 'f' && bytes <= 8) return;
  if (kind == 'i' || kind == 'u') {
    if (bytes <= 4 || is_within_exact_integers(array)) return;
    throw py::value_error(
        fmt::format("{} must be within 2^53 where they are integers: binary64 holds no others", name));
  }
  throw py::type_error(
      fmt::format("{} must be real numbers that binary64 holds exactly, not {}", name, text(array.dtype())));
}

bool readable_in_place(const py::array& array) {
  constexpr py::ssize_t bytes = sizeof(double);
  if (array.dtype().kind() != 'f' || array.itemsize() != bytes) return false;
  if (!array.dtype().attr("isnative").cast<bool>()) return false;
  if (reinterpret_cast<std::uintptr_t>(array.data()) % alignof(double) != 0) return false;
  for (py::ssize_t k = 0; k < array.ndim(); ++k) {
    if (array.strides(k) % bytes != 0) return false;
  }
  return true;
}

/// One `Record` of doubles for each row.
template <class Record>
std::vector<Record> records(const py::handle& object, std::string_view name, const std::vector<py::ssize_t>& shape) {
  static_assert(std::is_trivially_copyable_v<Record> && std::is_standard_layout_v<Record>);
  const py::array array = numpy().attr("ascontiguousarray")(numbers(object, name, shape));
  std::vector<Record> result(static_cast<std::size_t>(array.shape(0)));
  if (!result.empty()) std::memcpy(result.data(), array.data(), result.size() * sizeof(Record));
  return result;
}

std::array<std::uint32_t, 3> indices(const std::array<std::int64_t, 3>& corners, std::size_t vertices) {
  std::array<std::uint32_t, 3> result{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners[k] < 0 || static_cast<std::uint64_t>(corners[k]) >= vertices)
      throw py::value_error(fmt::format("triangles name vertex {} of {}", corners[k], vertices));
    result[k] = static_cast<std::uint32_t>(corners[k]);
  }
  return result;
}

std::vector<std::array<std::int64_t, 3>> corners_of(const py::handle& object) {
  const py::array array = as_array(object, "triangles");
  check_shape(array, "triangles", {-1, 3});
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u')
    throw py::type_error(fmt::format("triangles must be integers, indices of vertices, not {}", text(array.dtype())));
  if (!is_within_exact_integers(array)) throw py::value_error("triangles name vertices that are not there");
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> widened(array);
  std::vector<std::array<std::int64_t, 3>> result(static_cast<std::size_t>(array.shape(0)));
  if (!result.empty()) std::memcpy(result.data(), widened.data(), static_cast<std::size_t>(widened.nbytes()));
  return result;
}

}  // namespace

bool is_mesh(py::handle object) {
  if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object) || py::hasattr(object, "__array__"))
    return false;
  return py::hasattr(object, "vertices") || py::hasattr(object, "points") || py::hasattr(object, "GetPoints");
}

Mesh mesh_of(py::handle object) {
  const py::tuple parts = reader("mesh")(object);
  return mesh(parts[0], parts[1]);
}

py::array numbers(py::handle object, std::string_view name, const std::vector<py::ssize_t>& shape) {
  const py::array array = as_array(object, name);
  check_shape(array, name, shape);
  check_type(array, name);
  return readable_in_place(array) ? array : py::array(array.attr("astype")(py::dtype::of<double>()));
}

PointColumns columns(const py::array& points) {
  const auto size = static_cast<std::size_t>(points.shape(0));
  if (size == 0) return {0, {}, {}, {}};
  const py::ssize_t row = points.strides(0) / static_cast<py::ssize_t>(sizeof(double));
  const py::ssize_t coordinate = points.strides(1) / static_cast<py::ssize_t>(sizeof(double));
  const auto* const first = static_cast<const double*>(points.data());
  return {size, {first, row}, {first + coordinate, row}, {first + 2 * coordinate, row}};
}

std::vector<Point> points(py::handle object, std::string_view name) {
  return records<Point>(object, name, {-1, 3});
}

std::vector<Triangle> triangles(py::handle object, std::string_view name) {
  if (is_mesh(object)) return records<Triangle>(reader("corners")(object), name, {-1, 3, 3});
  return records<Triangle>(object, name, {-1, 3, 3});
}

std::vector<Pose> poses(py::handle object, std::string_view name) {
  static_assert(sizeof(Pose) == 7 * sizeof(double));
  return records<Pose>(reader("poses")(object), name, {-1, 7});
}

std::vector<std::int64_t> integers(py::handle object, std::string_view name) {
  const py::array array = as_array(object, name);
  check_shape(array, name, {-1});
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u')
    throw py::type_error(fmt::format("{} must be integers, not {}", name, text(array.dtype())));
  if (!is_within_exact_integers(array)) throw py::value_error(fmt::format("{} must be within 2^53", name));
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> widened(array);
  return {widened.data(), widened.data() + widened.size()};
}

Pose pose(py::handle object) {
  if (object.is_none()) return {};
  const py::array numbers_of_pose = numbers(reader("pose")(object), "a pose", {7});
  const Pose result = poses(numbers_of_pose.attr("reshape")(1, 7), "a pose").front();
  const auto finite = [](double number) { return std::isfinite(number); };
  const auto zero = [](double number) { return number == 0.0; };
  if (!std::ranges::all_of(result.translation, finite) || !std::ranges::all_of(result.quaternion, finite) ||
      std::ranges::all_of(result.quaternion, zero))
    throw Error(ErrorKind::input, "a pose must be finite, and its quaternion not zero");
  return result;
}

Point point(py::handle object) {
  const py::array coordinates = numbers(object, "a point", {3});
  return points(coordinates.attr("reshape")(1, 3), "a point").front();
}

std::optional<Plane> plane(py::handle object) {
  if (object.is_none()) return std::nullopt;
  const py::array coordinates = numbers(object, "a plane", {6});
  const std::vector<Point> rows = points(coordinates.attr("reshape")(2, 3), "a plane");
  const Plane result{rows[0], rows[1]};
  const auto finite = [](double number) { return std::isfinite(number); };
  if (!std::ranges::all_of(result.point, finite) || !std::ranges::all_of(result.normal, finite) ||
      result.normal == Point{})
    throw Error(ErrorKind::input, "a plane must be finite, and its normal not zero");
  return result;
}

Mesh mesh(py::handle vertices, py::handle triangles) {
  Mesh result{points(vertices, "vertices"), {}};
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    for (const double coordinate : result.vertices[i]) {
      if (!std::isfinite(coordinate)) throw Error(ErrorKind::input, fmt::format("vertex {} is not finite", i));
    }
  }
  if (triangles.is_none()) return result;
  for (const auto& corners : corners_of(triangles)) {
    result.triangles.push_back(indices(corners, result.vertices.size()));
  }
  return result;
}

}  // namespace verisq::python
