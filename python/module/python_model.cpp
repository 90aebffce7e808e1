/// The classes verisq.Model and verisq.Mesh of module.hpp.

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh_topology.hpp>

#include "python/module/module.hpp"

namespace verisq::python {
namespace {

/// Stands for a mesh of another package: pybind11 makes a PythonMesh of it where a function takes one.
struct MeshOfAnotherPackage {};

}  // namespace
}  // namespace verisq::python

template <>
struct pybind11::detail::type_caster<verisq::python::MeshOfAnotherPackage> {
  PYBIND11_TYPE_CASTER(verisq::python::MeshOfAnotherPackage, const_name("Mesh"));

  bool load(handle object, bool /*convert*/) { return verisq::python::is_mesh(object); }
};

namespace verisq::python {
namespace {

namespace py = pybind11;

}  // namespace

py::dict dictionary(const FemurLandmarks& landmarks) {
  py::dict result;
  for (const auto& [name, member] : named_landmarks) {
    if (const std::optional<Point>& at = landmarks.*member) result[name] = *at;
  }
  if (landmarks.head_radius) result["head_radius"] = *landmarks.head_radius;
  return result;
}

FemurLandmarks landmarks_of(const py::dict& description) {
  FemurLandmarks result;
  for (const auto& [key, value] : description) {
    const auto name = key.cast<std::string>();
    bool known = name == "head_radius";
    if (known) result.head_radius = value.cast<double>();
    for (const NamedLandmark& landmark : named_landmarks) {
      if (name != landmark.name) continue;
      result.*landmark.point = point(value);
      known = true;
    }
    if (!known) throw Error(ErrorKind::input, fmt::format("landmarks: no landmark is called {}", name));
  }
  return result;
}

std::optional<Side> side_of(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  if (*word == "left") return Side::left;
  if (*word == "right") return Side::right;
  throw py::value_error(fmt::format("side must be \"left\", \"right\" or None, not \"{}\"", *word));
}

namespace {

namespace py = pybind11;

constexpr const char* name_of_text = "model";

py::object number_or_interval(const Enclosure& number) {
  if (number.lo == number.hi) return py::float_(number.lo);
  return py::cast(std::vector<double>{number.lo, number.hi});
}

template <std::size_t N>
py::list list(const std::array<Enclosure, N>& numbers) {
  py::list result;
  for (const Enclosure& number : numbers) result.append(number_or_interval(number));
  return result;
}

py::dict superquadric_of(const UncertainPrimitive& primitive) {
  py::dict superquadric;
  superquadric["semi_axes"] = list(primitive.semi_axes);
  superquadric["exponents"] = list(primitive.exponents);
  if (primitive.taper != 1.0) superquadric["taper"] = primitive.taper;
  return superquadric;
}

py::dict dictionary(const Mesh& mesh) {
  py::dict result;
  result["vertices"] = mesh.vertices;
  result["triangles"] = mesh.triangles;
  return result;
}

py::dict dictionary(const UncertainPrimitive& primitive) {
  py::dict pose;
  pose["translation"] = list(primitive.translation);
  pose["quaternion"] = std::vector<double>(primitive.quaternion.begin(), primitive.quaternion.end());
  py::dict result;
  result["name"] = primitive.name;
  if (primitive.mesh)
    result["mesh"] = dictionary(*primitive.mesh);
  else
    result["superquadric"] = superquadric_of(primitive);
  if (primitive.bend) {
    py::dict bend;
    bend["curvature"] = primitive.bend->curvature;
    bend["angle_deg"] = primitive.bend->angle_degrees;
    result["bend"] = bend;
  }
  result["pose"] = pose;
  return result;
}

const char* key(SetOperation operation) {
  switch (operation) {
    case SetOperation::unite: return "union";
    case SetOperation::intersect: return "intersection";
    case SetOperation::subtract: break;
  }
  return "difference";
}

py::object operand(const SetExpression& expression, const UncertainModel& model) {
  if (expression.operands.empty()) return py::str(model.primitives[expression.primitive].name);
  py::list operands;
  for (const SetExpression& each : expression.operands) operands.append(operand(each, model));
  py::dict result;
  result[key(expression.operation)] = operands;
  return result;
}

py::list list(const std::vector<AreaBox>& areas) {
  py::list result;
  for (const AreaBox& box : areas) {
    py::dict area;
    area["name"] = box.area.name;
    area["weight"] = box.area.weight;
    area["box"] = std::vector<Point>{box.lower, box.upper};
    result.append(area);
  }
  return result;
}

py::dict dictionary(const PythonModel& whole) {
  const UncertainModel& model = whole.model();
  py::dict result;
  result["format"] = "verisq-model/1";
  if (!model.units.empty()) result["units"] = model.units;
  py::list primitives;
  for (const UncertainPrimitive& primitive : model.primitives) primitives.append(dictionary(primitive));
  result["primitives"] = primitives;
  if (model.csg) result["csg"] = operand(*model.csg, model);
  const py::dict landmarks = python::dictionary(whole.landmarks());
  if (!landmarks.empty()) result["landmarks"] = landmarks;
  if (!whole.areas().empty()) result["areas"] = list(whole.areas());
  return result;
}

PythonModel from_text(const std::string& text, const std::string& name) {
  return PythonModel(parse_uncertain_model(text, name), parse_model_landmarks(text, name), parse_areas(text, name));
}

PythonModel from_file(const std::filesystem::path& path) {
  return PythonModel(read_uncertain_model(path), read_model_landmarks(path), read_areas(path));
}

/// Of what JSON does not know, arrays and NumPy's numbers become lists and numbers.
py::object plain(const py::object& value) {
  if (!py::hasattr(value, "tolist")) {
    throw py::type_error(fmt::format("a model holds numbers, texts, lists and dictionaries, not {}",
                                     std::string(py::str(py::type::of(value).attr("__name__")))));
  }
  return value.attr("tolist")();
}

PythonModel from_dictionary(const py::dict& description) {
  const py::object text =
      py::module_::import("json").attr("dumps")(description, py::arg("default") = py::cpp_function(plain));
  return from_text(text.cast<std::string>(), name_of_text);
}

PythonModel from_mesh(const PythonMesh& solid, const std::string& name, const std::string& units,
                      const py::handle& at) {
  Model model{units, {mesh_primitive(name, solid.mesh, at.is_none() ? Pose() : pose(at))}};
  return PythonModel(UncertainModel(model));
}

std::vector<std::string> names(const PythonModel& model) {
  std::vector<std::string> result;
  for (const UncertainPrimitive& primitive : model.model().primitives) result.push_back(primitive.name);
  return result;
}

std::string representation_of_model(const PythonModel& model) {
  const std::size_t count = model.model().primitives.size();
  const std::string& units = model.model().units;  // as Python shows texts: on one line
  return fmt::format("<verisq.Model: {} primitive{}{}{}>", count, count == 1 ? "" : "s",
                     units.empty() ? "" : ", units " + py::repr(py::str(units)).cast<std::string>(),
                     is_exact(model.model()) ? "" : ", with intervals");
}

std::uint64_t next_identity() {
  static std::atomic<std::uint64_t> next{0};
  return next++;
}

}  // namespace

PythonModel::PythonModel(UncertainModel model, FemurLandmarks landmarks, std::vector<AreaBox> areas)
    : model_(std::move(model)),
      landmarks_(landmarks),
      areas_(std::move(areas)),
      largest_(bracket(model_).largest),
      bounding_radius_(verisq::bounding_radius(largest_)),
      identity_(next_identity()) {}

const Model& PythonModel::exact(std::string_view what) const {
  if (!is_exact(model_)) throw Error(ErrorKind::input, fmt::format("{}: not for models with intervals", what));
  return largest_;  // an exact model is its own bracket
}

PythonModel posed(const PythonModel& model, const Pose& by) {
  return PythonModel(verisq::posed(model.exact("moving a model"), by), verisq::posed(model.landmarks(), by),
                     model.areas());
}

void check_units(const PythonModel& a, const PythonModel& b) {
  const std::string& of_a = a.model().units;
  const std::string& of_b = b.model().units;
  if (!of_a.empty() && !of_b.empty() && of_a != of_b)
    throw Error(ErrorKind::input, fmt::format("units {} of b differ from {} of a", of_b, of_a));
}

void check_time_limit(const std::optional<double>& seconds) {
  constexpr double longest = 1e9;
  if (seconds && !(*seconds > 0.0 && *seconds <= longest))
    throw py::value_error(fmt::format("time_limit must be above 0 and at most 1e9 seconds, not {}", *seconds));
}

void check_length(double value, std::string_view name) {
  if (!(value >= 0.0) || !std::isfinite(value))
    throw py::value_error(fmt::format("{} must be finite and at least 0, not {}", name, value));
}

namespace {

double tolerance_of(const std::optional<double>& given, double relative, double radius) {
  if (given) check_length(*given, "tolerance");
  const double tolerance = given.value_or(relative * radius);
  if (!std::isfinite(tolerance))
    throw Error(ErrorKind::input, "tolerance: give one, because the size of the model overflows");
  return tolerance;
}

}  // namespace

double tolerance_or_default(const std::optional<double>& given, double radius) {
  return tolerance_of(given, 1e-6, radius);
}

double tolerance_along_way(const std::optional<double>& given, double radius) {
  const double tolerance = tolerance_of(given, 1e-3, radius);
  if (tolerance == 0.0) throw py::value_error("tolerance must be above 0");
  return tolerance;
}

void declare_models(py::module_& module) {
  py::class_<PythonModel>(module, "Model",
                          "A solid: posed superquadrics and the set operations on them, as a model file states them\n"
                          "(verisq-model/1, docs/formats.md §2). Made by load, loads or from_dict; immutable.")
      .def_static("load", from_file, py::arg("path"),
                  "load(path) -> Model\n\nThe model of a file. Raises Error, one line with file, key and value, for\n"
                  "everything that the format refuses.")
      .def_static("loads", from_text, py::arg("text"), py::arg("name") = name_of_text,
                  "loads(text, name=\"model\") -> Model\n\nThe same from JSON; name stands for the file in messages.")
      .def_static("from_dict", from_dictionary, py::arg("description"),
                  "from_dict(description) -> Model\n\nThe same from the dictionary that the JSON would be; arrays may\n"
                  "stand for lists. Every number is taken as its binary64.")
      .def_static(
          "from_mesh", from_mesh, py::arg("mesh"), py::kw_only(), py::arg("name") = "mesh", py::arg("units") = "",
          py::arg("pose") = py::none(),
          "from_mesh(mesh, *, name=\"mesh\", units=\"\", pose=None) -> Model\n\n"
          "The model of one solid: every point about which the triangles of a closed Mesh wind. pose: seven\n"
          "numbers, translation in model units and quaternion [w, x, y, z]. Model.load takes mesh files, too.\n"
          "Raises Error, with the number of open edges, for a mesh that is not closed. docs/formats.md §2 says\n"
          "which functions take meshes so far.")
      .def(
          "to_dict", [](const PythonModel& self) { return dictionary(self); },
          "to_dict() -> dict\n\nWhat from_dict makes the same model of, bit for bit.")
      .def(
          "save",
          [](const PythonModel& self, const std::filesystem::path& path) {
            write_model(path, self.exact("saving a model"), self.landmarks());
          },
          py::arg("path"),
          "save(path)\n\nWrites the file, so that load gives the same bits; it appears when it is complete. Areas,\n"
          "which are the bone's, are left out. Raises Error where it cannot be written, and for models with "
          "intervals.")
      .def(
          "posed", [](const PythonModel& self, const py::handle& by) { return posed(self, pose(by)); }, py::arg("pose"),
          "posed(pose) -> Model\n\nThe model moved: by seven numbers, translation in model units and quaternion\n"
          "[w, x, y, z], or by what verisq.pose takes. Its numbers are rounded to nearest: what is enclosed is of the "
          "model that they state. Raises\n"
          "Error for models with intervals.")
      .def_property_readonly(
          "units", [](const PythonModel& self) { return self.model().units; },
          "Free text of the file, as \"mm\"; empty where it says none.")
      .def_property_readonly(
          "landmarks", [](const PythonModel& self) { return dictionary(self.landmarks()); },
          "The points that the file names, in model units: they move with the model.")
      .def_property_readonly(
          "areas", [](const PythonModel& self) { return list(self.areas()); },
          "The file's areas, for fit(): boxes in the bone's coordinates, which stay where they are.")
      .def_property_readonly("names", names, "The names of the primitives, in the file's order.")
      .def_property_readonly(
          "bounding_radius", &PythonModel::bounding_radius,
          "Radius of a sphere that contains the model, rounded up, in model units. A tolerance that\n"
          "is not given is 1e-6 of it.")
      .def_property_readonly(
          "is_exact", [](const PythonModel& self) { return is_exact(self.model()); },
          "Whether no number of the model is an interval.")
      .def_property_readonly(
          "is_union_of_convex", [](const PythonModel& self) { return verisq::is_union_of_convex(self.largest()); },
          "Whether the model is the union of its primitives, none of them bent: others are\n"
          "searched.")
      .def("__repr__", representation_of_model)
      .def(
          "__eq__",
          [](const PythonModel& self, const PythonModel& other) {
            return self.identity() == other.identity() || dictionary(self).equal(dictionary(other));
          },
          py::is_operator(), "True if they state the same numbers and names.")
      .def("__hash__",
           [](const PythonModel& self) {
             return py::hash(
                 py::make_tuple(self.model().units, py::tuple(py::cast(names(self))), self.bounding_radius()));
           })
      .def(py::pickle([](const PythonModel& self) { return dictionary(self); },
                      [](const py::dict& description) { return from_dictionary(description); }));
}

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

std::string representation_of_mesh(const PythonMesh& self) {
  return fmt::format("<verisq.Mesh: {} vertices, {} triangles>", self.mesh.vertices.size(), self.mesh.triangles.size());
}

bool is_closed(const PythonMesh& self) {
  return !self.mesh.triangles.empty() && mesh_topology(self.mesh).bounds_solid();
}

PythonMesh mesh_of_model(const PythonModel& model, double deviation) {
  const Model& exact = model.exact("mesh_of_model");
  return without_lock([&](const Interrupted& interrupted) {
    return PythonMesh{model_mesh(exact, {.deviation = deviation, .interrupted = interrupted}).mesh};
  });
}

}  // namespace

Mesh mesh_or_cloud(py::handle object) {
  if (py::isinstance<PythonMesh>(object)) return object.cast<const PythonMesh&>().mesh;
  return is_mesh(object) ? mesh_of(object) : mesh(object, py::none());
}

void declare_meshes(py::module_& module) {
  py::class_<PythonMesh>(
      module, "Mesh",
      "Mesh(vertices, triangles=None)\n\nVertices, an array of shape (N, 3), and triangles, indices\n"
      "of shape (M, 3); without triangles it is a cloud. Or one argument: a mesh of trimesh, meshio, pyvista, VTK or\n"
      "Open3D, which every function takes where it takes a Mesh. All are copied. Raises ValueError for\n"
      "other shapes, polygons that are no triangles, and indices that no vertex has; Error for coordinates that are\n"
      "not finite.")
      .def(py::init([](const py::handle& vertices, const py::handle& triangles) {
             return PythonMesh{triangles.is_none() ? mesh_or_cloud(vertices) : mesh(vertices, triangles)};
           }),
           py::arg("vertices"), py::arg("triangles") = py::none())
      .def_static(
          "load",
          [](const std::filesystem::path& path) {
            const py::gil_scoped_release released;
            return PythonMesh{read_mesh(path)};
          },
          py::arg("path"),
          "load(path) -> Mesh\n\nReads STL, OBJ, PLY, OFF or VTK (.vtp, .vtk), by the extension. Equal corners of an "
          "STL are merged,\n"
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
      .def("__repr__", representation_of_mesh)
      .def(py::pickle(
          [](const PythonMesh& self) {
            return py::make_tuple(copied(self.mesh.vertices), copied(self.mesh.triangles));
          },
          [](const py::tuple& parts) { return PythonMesh{mesh(parts[0], parts[1])}; }));
  py::implicitly_convertible<MeshOfAnotherPackage, PythonMesh>();
  module.def(
      "mesh_of_model", mesh_of_model, py::arg("model"), py::arg("deviation"),
      "mesh_of_model(model, deviation) -> Mesh\n\nThe model's surface as a closed mesh, about so near to it, in\n"
      "model units: floating point, nothing is proven of it (ask deviation()). Raises Error for a deviation\n"
      "that is not positive or too small, and for models with intervals.");
}

}  // namespace verisq::python
