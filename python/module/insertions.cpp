/// Ways of an implant into the bone: the smallest distances along them, and the bone that they take away.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/insertion.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {

namespace {

namespace py = pybind11;

py::array_t<double> straight(const py::handle& direction, double length, const py::handle& last, std::size_t steps) {
  const Point along = point(direction);
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!finite(along[0]) || !finite(along[1]) || !finite(along[2]) || along == Point{})
    throw py::value_error("direction must be finite, and not zero");
  check_length(length, "length");
  if (length == 0.0 || steps == 0) throw py::value_error("length and steps must be above 0");
  const std::vector<Pose> path = straight_path(pose(last), along, length, steps);
  py::array_t<double> result(std::vector<py::ssize_t>{static_cast<py::ssize_t>(path.size()), 7});
  double* next = result.mutable_data();
  for (const Pose& each : path) {
    for (const double number : each.translation) *next++ = number;
    for (const double number : each.quaternion) *next++ = number;
  }
  return result;
}

PythonMap map_along(const PythonModel& implant, const py::handle& object, const py::handle& path,
                    const std::optional<double>& tolerance, const std::string& device) {
  const Model& exact = implant.exact("map_along");
  const std::vector<Point> bone = points(object, "points");
  const std::vector<Pose> way = poses(path, "path");
  Interruption interruption;
  const double width = tolerance_along_way(tolerance, implant.bounding_radius());
  const InsertionOptions options{.tolerance = width, .device = device, .interrupted = interruption.poll()};
  const Insertion found =
      without_lock(interruption, [&] { return smallest_distance_along(way, exact, bone, options); });
  return map_of_rows(found.rows, found.summary, width);
}

/// The smallest distances along a way in, with what proves them again.
struct CertifiedWay {
  PythonMap map;
  std::vector<InsertionCertificate> certificates;
};

CertifiedWay certified_map_along(const PythonModel& implant, const py::handle& object, const py::handle& path,
                                 const std::optional<double>& tolerance, const std::string& device) {
  const Model& exact = implant.exact("certified_map_along");
  const std::vector<Point> bone = points(object, "points");
  const std::vector<Pose> way = poses(path, "path");
  Interruption interruption;
  const double width = tolerance_along_way(tolerance, implant.bounding_radius());
  const InsertionOptions options{.tolerance = width, .device = device, .interrupted = interruption.poll()};
  CertifiedInsertion proven = without_lock(interruption, [&] {
    return certified_insertion(way, exact, bone, smallest_distance_along(way, exact, bone, options), options);
  });
  return {map_of_rows(proven.rows, proven.summary, width), std::move(proven.certificates)};
}

bool is_proved(const CertifiedWay& self, const PythonModel& implant, const py::handle& object, const py::handle& path) {
  const Model& exact = implant.exact("is_proved");
  const std::vector<Point> bone = points(object, "points");
  const std::vector<Pose> way = poses(path, "path");
  if (bone.size() != self.certificates.size())
    throw py::value_error(
        fmt::format("points: are {}, and the certificates are of {}", bone.size(), self.certificates.size()));
  const auto lo = self.map.lo.unchecked<1>();
  const auto hi = self.map.hi.unchecked<1>();
  return without_lock([&](const Interrupted& interrupted) {
    const InsertionChecker checker(exact, way);
    for (std::size_t i = 0; i < bone.size(); ++i) {
      const auto row = static_cast<py::ssize_t>(i);
      if (interrupted() ||
          checker(bone[i], {lo(row), hi(row)}, self.certificates[i], interrupted).verdict != Verdict::proved)
        return false;
    }
    return true;
  });
}

/// That of the whole surface between the points, its vertices, too.
struct CertifiedMeshClearance {
  CertifiedWay vertices;
  Enclosure smallest_distance;
  WaySurfaceCertificate certificate;
};

std::vector<Enclosure> distances_of(const std::vector<MapResult>& rows) {
  std::vector<Enclosure> distances;
  distances.reserve(rows.size());
  for (const MapResult& row : rows) distances.push_back(row.distance);
  return distances;
}

CertifiedMeshClearance certified_clearance(const PythonModel& implant, const PythonMesh& mesh, const py::handle& path,
                                           const std::optional<double>& tolerance, const std::string& device) {
  const Model& exact = implant.exact("certified_mesh_clearance");
  const Mesh& bone = mesh.mesh;
  const std::vector<Pose> way = poses(path, "path");
  const double width = tolerance_along_way(tolerance, implant.bounding_radius());
  Interruption interruption;
  const InsertionOptions options{.tolerance = width, .device = device, .interrupted = interruption.poll()};
  CertifiedInsertion vertices;
  const CertifiedWaySurface surface = without_lock(interruption, [&] {
    const MeshClearance found = mesh_clearance_along(
        way, exact, bone, {.tolerance = width, .device = device, .interrupted = options.interrupted});
    vertices = certified_insertion(way, exact, bone.vertices,
                                   smallest_distance_along(way, exact, bone.vertices, options), options);
    if (vertices.summary.interrupted) return CertifiedWaySurface{{}, {}, true};
    return certified_way_surface(way, exact, bone, distances_of(vertices.rows), found, options);
  });
  return {{map_of_rows(vertices.rows, vertices.summary, width), std::move(vertices.certificates)},
          surface.smallest_distance,
          surface.certificate};
}

bool is_clearance_proved(const CertifiedMeshClearance& self, const PythonModel& implant, const PythonMesh& mesh,
                         const py::handle& path) {
  const Model& exact = implant.exact("is_proved");
  const Mesh& bone = mesh.mesh;
  const std::vector<Pose> way = poses(path, "path");
  const auto& [map, certificates] = self.vertices;
  if (bone.vertices.size() != certificates.size())
    throw py::value_error(fmt::format("mesh: has {} vertices, and the certificates are of {}", bone.vertices.size(),
                                      certificates.size()));
  const auto lo = map.lo.unchecked<1>();
  const auto hi = map.hi.unchecked<1>();
  return without_lock([&](const Interrupted& interrupted) {
    const InsertionChecker checker(exact, way);
    std::vector<Enclosure> proven;
    for (std::size_t i = 0; i < bone.vertices.size() && !interrupted(); ++i) {
      const auto row = static_cast<py::ssize_t>(i);
      const Finding finding = checker(bone.vertices[i], {lo(row), hi(row)}, self.vertices.certificates[i], interrupted);
      if (finding.verdict != Verdict::proved) return false;
      proven.push_back(finding.proven);
    }
    if (interrupted()) return false;
    const WaySurfaceChecker surface(exact, way, bone);
    return surface(proven, self.smallest_distance, self.certificate, {.interrupted = interrupted}).verdict ==
           Verdict::proved;
  });
}

InsertionAnswer answer_about(const std::filesystem::path& implant, const std::filesystem::path& mesh,
                             const py::handle& path) {
  return {.model = subject_file(implant),
          .mesh = subject_file(mesh),
          .units = units_of({implant}),
          .pose = {},
          .path = poses(path, "path"),
          .rows = {}};
}

PythonAnswer answer_of_way(const CertifiedWay& self, const std::filesystem::path& implant,
                           const std::filesystem::path& mesh, const py::handle& path) {
  InsertionAnswer answer = answer_about(implant, mesh, path);
  const auto lo = self.map.lo.unchecked<1>();
  const auto hi = self.map.hi.unchecked<1>();
  for (std::size_t i = 0; i < self.certificates.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    answer.rows.push_back({{lo(row), hi(row)}, self.certificates[i]});
  }
  return {std::move(answer)};
}

PythonAnswer answer_of_clearance(const CertifiedMeshClearance& self, const std::filesystem::path& implant,
                                 const std::filesystem::path& mesh, const py::handle& path) {
  PythonAnswer answer = answer_of_way(self.vertices, implant, mesh, path);
  std::get<InsertionAnswer>(answer.answer).surface = {self.smallest_distance, self.certificate};
  return answer;
}

NamedMesh named(const char* name, const py::handle& mesh) {
  return {name, mesh.cast<const PythonMesh&>().mesh};
}

BoneRegion bone_region(const py::object& cavity, const py::object& within, const py::object& bone,
                       const std::optional<Plane>& resection) {
  if (cavity.is_none() == bone.is_none()) throw py::value_error("give either cavity or bone, which say where bone is");
  if (!within.is_none() && cavity.is_none()) throw Error(ErrorKind::input, "`within`: only with `cavity`");
  if (cavity.is_none()) return bone_inside(named("bone", bone), resection);
  std::optional<NamedMesh> outer;
  if (!within.is_none()) outer = named("within", within);
  return bone_around(named("cavity", cavity), std::move(outer), resection);
}

/// An implant's way into a bone, as Python says it.
struct WayIntoBone {
  const Model& implant;
  std::vector<Pose> path;
  BoneRegion bone;
};

WayIntoBone way_into_bone(const char* function, const PythonModel& implant, const py::handle& path,
                          const py::object& cavity, const py::object& within, const py::object& bone,
                          const py::object& resection) {
  return {implant.exact(function), poses(path, "path"), bone_region(cavity, within, bone, plane(resection))};
}

RemovedVolume removed_along(const WayIntoBone& way, const std::optional<double>& relative_tolerance) {
  if (relative_tolerance) check_length(*relative_tolerance, "relative_tolerance");
  Interruption interruption;
  const RemovedVolumeOptions options{.relative_tolerance = relative_tolerance.value_or(usual_volume_tolerance),
                                     .tolerance = relative_tolerance ? 0.0 : negligible_volume(way.implant),
                                     .interrupted = interruption.poll()};
  return without_lock(interruption, [&] { return verisq::removed_volume(way.path, way.implant, way.bone, options); });
}

RemovedVolume volume(const PythonModel& implant, const py::handle& path, const py::object& cavity,
                     const py::object& within, const py::object& bone, const py::object& resection,
                     const std::optional<double>& relative_tolerance) {
  return removed_along(way_into_bone("removed_volume", implant, path, cavity, within, bone, resection),
                       relative_tolerance);
}

CertifiedRemovedVolume certified_volume(const PythonModel& implant, const py::handle& path, const py::object& cavity,
                                        const py::object& within, const py::object& bone, const py::object& resection,
                                        const std::optional<double>& relative_tolerance) {
  const WayIntoBone way = way_into_bone("certified_removed_volume", implant, path, cavity, within, bone, resection);
  const RemovedVolume found = removed_along(way, relative_tolerance);
  return without_lock([&](const Interrupted& interrupted) {
    return verisq::certified_removed_volume(way.path, way.implant, way.bone, found, {.interrupted = interrupted});
  });
}

bool is_volume_proved(const CertifiedRemovedVolume& self, const PythonModel& implant, const py::handle& path,
                      const py::object& cavity, const py::object& within, const py::object& bone,
                      const py::object& resection) {
  const WayIntoBone way = way_into_bone("is_proved", implant, path, cavity, within, bone, resection);
  const RemovedVolumeChecker checker(way.implant, way.path, way.bone);
  return without_lock([&](const Interrupted& interrupted) {
    const ProvenRemovedVolume proven = checker(self.certificate, {.interrupted = interrupted});
    return !proven.interrupted && self.volume.lo <= proven.volume.lo && proven.volume.hi <= self.volume.hi;
  });
}

using File = std::optional<std::filesystem::path>;

PythonAnswer answer_of_volume(const CertifiedRemovedVolume& self, const std::filesystem::path& implant,
                              const py::handle& path, const File& cavity, const File& within, const File& bone,
                              const py::object& resection) {
  if (cavity.has_value() == bone.has_value())
    throw py::value_error("give either cavity or bone, which say where bone is");
  InsertionAnswer answer = answer_about(implant, cavity ? *cavity : *bone, path);
  answer.removed = {.bone = cavity ? BoneSide::outside : BoneSide::inside,
                    .within = within ? std::optional(subject_file(*within)) : std::nullopt,
                    .resection = plane(resection),
                    .volume = self.volume,
                    .certificate = self.certificate};
  return {std::move(answer)};
}

std::string representation(const RemovedVolume& self) {
  return fmt::format("<verisq.RemovedVolume: in [{}, {}]>", self.volume.lo, self.volume.hi);
}

void declare_removed_volumes(py::module_& module) {
  py::class_<RemovedVolume>(module, "RemovedVolume", "What removed_volume() proves.")
      .def_readonly("volume", &RemovedVolume::volume,
                    "Enclosure of the volume of all bone that lies in the implant at some time, in cubic model units.")
      .def_readonly("within_tolerance", &RemovedVolume::within_tolerance, "Whether it is as narrow as asked for.")
      .def_readonly("rims", &RemovedVolume::rims, "Over how many rims each surface was closed, by fans.")
      .def_readonly("cubes", &RemovedVolume::cubes, "Looked at.")
      .def("__repr__", representation)
      .def(pickled<RemovedVolume>());
  py::class_<CertifiedRemovedVolume>(module, "CertifiedRemovedVolume", "What certified_removed_volume() proves.")
      .def_readonly("volume", &CertifiedRemovedVolume::volume, "Enclosure: as RemovedVolume.volume.")
      .def("is_proved", is_volume_proved, py::arg("implant"), py::arg("path"), py::kw_only(),
           py::arg("cavity") = py::none(), py::arg("within") = py::none(), py::arg("bone") = py::none(),
           py::arg("resection") = py::none(),
           "is_proved(implant, path, *, cavity=None, within=None, bone=None, resection=None) -> bool\n\n"
           "Proves it again, of this implant, this path and this bone, by the certificate alone.")
      .def("answer", answer_of_volume, py::arg("implant"), py::arg("path"), py::kw_only(),
           py::arg("cavity") = py::none(), py::arg("within") = py::none(), py::arg("bone") = py::none(),
           py::arg("resection") = py::none(),
           "answer(implant, path, *, cavity=None, within=None, bone=None, resection=None) -> Answer\n\n"
           "What `verisq insert --removed-bone --certificate-file` writes: of these files, and this path.")
      .def("__repr__",
           [](const CertifiedRemovedVolume& self) {
             return fmt::format("<verisq.CertifiedRemovedVolume: in [{}, {}]>", self.volume.lo, self.volume.hi);
           })
      .def(pickled<CertifiedRemovedVolume>());
}

void declare_ways(py::module_& module) {
  module.def("straight_path", straight, py::arg("direction"), py::arg("length"), py::kw_only(),
             py::arg("last") = py::none(), py::arg("steps") = 1,
             "straight_path(direction, length, *, last=None, steps=1) -> array\n\n"
             "float64 (steps + 1, 7): poses along a straight way that ends in the pose `last` (default: where the\n"
             "model is) moving along the direction; length in model units. Raises ValueError for numbers out of "
             "range.");
  module.def(
      "map_along", map_along, py::arg("implant"), py::arg("points"), py::arg("path"), py::kw_only(),
      py::arg("tolerance") = py::none(), py::arg("device") = "auto",
      "map_along(implant, points, path, *, tolerance=None, device=\"auto\") -> Map\n\n"
      "Encloses, for each point, the smallest signed distance to the implant along the whole path, at its poses\n"
      "and between them: where that is negative the implant passes through the point, so deep. path: shape\n"
      "(K, 7), each applied after the poses of the primitives; between two of them the translation is linear,\n"
      "and the rotation turns at constant speed by the smaller angle. Default tolerance: 1e-3 of the implant's\n"
      "bounding_radius. Raises Error for models with intervals, a path without poses, and as map().");
  py::class_<CertifiedWay>(module, "CertifiedWay", "What certified_map_along() proves.")
      .def_readonly("map", &CertifiedWay::map, "The rows (Map): what the certificates prove.")
      .def("is_proved", is_proved, py::arg("implant"), py::arg("points"), py::arg("path"),
           "is_proved(implant, points, path) -> bool\n\n"
           "Proves every row again, of this implant, these points and this path, by MPFR and the certificates alone.\n"
           "False where one is not proved. Raises ValueError for another number of points.")
      .def("answer", answer_of_way, py::arg("implant"), py::arg("mesh"), py::arg("path"),
           "answer(implant, mesh, path) -> Answer\n\n"
           "What `verisq insert --certificate-file` writes: of this model file, of the mesh file whose vertices the\n"
           "points are, and of this path.")
      .def("__len__", [](const CertifiedWay& self) { return self.certificates.size(); })
      .def("__repr__",
           [](const CertifiedWay& self) {
             return fmt::format("<verisq.CertifiedWay: {} rows, {} wide>", self.certificates.size(),
                                self.map.summary.wide);
           })
      .def(pickled<CertifiedWay>());
  module.def(
      "certified_map_along", certified_map_along, py::arg("implant"), py::arg("points"), py::arg("path"), py::kw_only(),
      py::arg("tolerance") = py::none(), py::arg("device") = "auto",
      "certified_map_along(implant, points, path, *, tolerance=None, device=\"auto\") -> CertifiedWay\n\n"
      "As map_along(), of a union of convex primitives, with what proves each row again. Rows are mostly tighter.");
}

void declare_clearances_along(py::module_& module) {
  py::class_<CertifiedMeshClearance>(module, "CertifiedMeshClearance", "What certified_mesh_clearance() proves.")
      .def_readonly("smallest_distance", &CertifiedMeshClearance::smallest_distance,
                    "Enclosure: as MeshClearance.smallest_distance, along the whole path.")
      .def_readonly("vertices", &CertifiedMeshClearance::vertices, "CertifiedWay: of the mesh's vertices.")
      .def(
          "is_proved", is_clearance_proved, py::arg("implant"), py::arg("mesh"), py::arg("path"),
          "is_proved(implant, mesh, path) -> bool\n\n"
          "Proves it, and every row of the vertices, again, of this implant, this mesh and this path, by MPFR and the\n"
          "certificates alone. Raises ValueError for another number of vertices.")
      .def("answer", answer_of_clearance, py::arg("implant"), py::arg("mesh"), py::arg("path"),
           "answer(implant, mesh, path) -> Answer\n\n"
           "What `verisq insert --on triangles --certificate-file` writes: of these files, and this path.")
      .def("__repr__",
           [](const CertifiedMeshClearance& self) {
             return fmt::format("<verisq.CertifiedMeshClearance: smallest distance in [{}, {}]>",
                                self.smallest_distance.lo, self.smallest_distance.hi);
           })
      .def(pickled<CertifiedMeshClearance>());
  module.def(
      "certified_mesh_clearance", certified_clearance, py::arg("implant"), py::arg("mesh"), py::arg("path"),
      py::kw_only(), py::arg("tolerance") = py::none(), py::arg("device") = "auto",
      "certified_mesh_clearance(implant, mesh, path, *, tolerance=None, device=\"auto\") -> CertifiedMeshClearance\n\n"
      "The smallest distance of all points of all triangles along the path, as mesh_clearance(implant, mesh,\n"
      "path=path), of a union of convex primitives, with what proves it again.");
}

void declare_volumes_of_ways(py::module_& module) {
  module.def(
      "removed_volume", volume, py::arg("implant"), py::arg("path"), py::kw_only(), py::arg("cavity") = py::none(),
      py::arg("within") = py::none(), py::arg("bone") = py::none(), py::arg("resection") = py::none(),
      py::arg("relative_tolerance") = py::none(),
      "removed_volume(implant, path, *, cavity=None, within=None, bone=None, resection=None,\n"
      "    relative_tolerance=None) -> RemovedVolume\n\n"
      "Encloses how much bone the implant, a union of convex primitives, takes away on its way (as in\n"
      "map_along). Bone is what lies outside the Mesh `cavity` and inside the Mesh `within`, or inside the Mesh\n"
      "`bone`; and never beyond the resection, a plane by six numbers: a point and a normal, which points to\n"
      "what was cut off. The enclosure's width divided by its lower end is at most relative_tolerance; default:\n"
      "0.02, or 1e-7 of the cube about the implant's bounding sphere. Raises ValueError unless there is either\n"
      "cavity or bone, Error as `verisq insert` does.");
  module.def("certified_removed_volume", certified_volume, py::arg("implant"), py::arg("path"), py::kw_only(),
             py::arg("cavity") = py::none(), py::arg("within") = py::none(), py::arg("bone") = py::none(),
             py::arg("resection") = py::none(), py::arg("relative_tolerance") = py::none(),
             "certified_removed_volume(implant, path, *, cavity=None, within=None, bone=None, resection=None,\n"
             "    relative_tolerance=None) -> CertifiedRemovedVolume\n\n"
             "As removed_volume(), with what proves the volume again. The volume is what that proves.");
}

}  // namespace

void declare_insertions(py::module_& module) {
  declare_removed_volumes(module);
  declare_ways(module);
  declare_clearances_along(module);
  declare_volumes_of_ways(module);
}

}  // namespace verisq::python
