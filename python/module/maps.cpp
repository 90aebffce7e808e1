/// Maps: many enclosures at once, of points, triangles and poses, from arrays to arrays.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "python/module/module.hpp"
#include "python/module/pickling.hpp"

namespace verisq::python {
namespace {

namespace py = pybind11;

/// As queries of the library, and what keeps them alive.
template <class Query>
struct Queries;

template <>
struct Queries<Point> {
  explicit Queries(const py::handle& object)
      : array(numbers(object, "points", {-1, 3})), columns(python::columns(array)) {}
  [[nodiscard]] std::size_t size() const { return columns.size(); }
  [[nodiscard]] Point operator[](std::size_t i) const { return columns[i]; }
  [[nodiscard]] const PointColumns& in_memory() const { return columns; }

  py::array array;
  PointColumns columns;
};

template <class Query>
struct CopiedQueries {
  [[nodiscard]] std::size_t size() const { return list.size(); }
  [[nodiscard]] const Query& operator[](std::size_t i) const { return list[i]; }
  [[nodiscard]] std::span<const Query> in_memory() const { return list; }

  std::vector<Query> list;
};

template <>
struct Queries<Triangle> : CopiedQueries<Triangle> {
  explicit Queries(const py::handle& object) : CopiedQueries{triangles(object, "triangles")} {}
};

template <>
struct Queries<Pose> : CopiedQueries<Pose> {
  explicit Queries(const py::handle& object) : CopiedQueries{poses(object, "poses")} {}
};

/// How well a model's place is known, as Python says it.
struct PythonPoseUncertainty {
  std::array<double, 3> translation;
  double rotation;  ///< in degrees
  Point centre;
  unsigned divisions;

  [[nodiscard]] bool operator==(const PythonPoseUncertainty&) const = default;
  [[nodiscard]] PoseUncertainty bounds() const { return {translation, radians_up(rotation), centre}; }
};

using MaybeUncertain = std::optional<PythonPoseUncertainty>;

PythonPoseUncertainty pose_uncertainty_of(const py::object& translation, double rotation, const Point& centre,
                                          unsigned divisions) {
  std::array<double, 3> each{};
  if (py::isinstance<py::sequence>(translation) || py::isinstance<py::array>(translation)) {
    each = translation.cast<std::array<double, 3>>();
  } else {
    each.fill(translation.cast<double>());
  }
  for (const double x : each) check_length(x, "translation");
  check_length(rotation, "rotation");
  if (rotation > 180.0) throw py::value_error("rotation: more than 180 degrees");
  if (divisions == 0) throw py::value_error("divisions: must be at least 1");
  return {each, rotation, centre, divisions};
}

void declare_pose_uncertainty(py::module_& module) {
  py::class_<PythonPoseUncertainty>(
      module, "PoseUncertainty",
      "PoseUncertainty(translation=0.0, rotation=0.0, centre=(0, 0, 0), divisions=1)\n\n"
      "How well the place of a model is known, as of a tracked tool: it may be moved by up to `translation` along "
      "each\n"
      "axis (one length or three, in model units), and turned about any axis through `centre` by up to `rotation`\n"
      "degrees. divisions: of maps of points, how finely the places are divided where convexity does not tell the\n"
      "distances (bends, csg, edges, deep inside): 16 makes rows hardly wider than distances differ.\n\n"
      "Raises ValueError for negative numbers and more than 180 degrees.")
      .def(py::init(&pose_uncertainty_of), py::arg("translation") = 0.0, py::arg("rotation") = 0.0,
           py::arg("centre") = Point{}, py::arg("divisions") = 1)
      .def_property_readonly("translation", [](const PythonPoseUncertainty& self) { return self.translation; })
      .def_readonly("rotation", &PythonPoseUncertainty::rotation)
      .def_property_readonly("centre", [](const PythonPoseUncertainty& self) { return self.centre; })
      .def_readonly("divisions", &PythonPoseUncertainty::divisions)
      .def(pickled<PythonPoseUncertainty>());
}

/// What all maps are told.
struct Settings {
  double tolerance;
  std::string device = "auto";
  bool certificates = false;
  double point_radius = 0.0;
  std::optional<double> time_limit = {};  ///< seconds, of each call
  std::optional<PythonPoseUncertainty> pose_uncertainty = {};

  [[nodiscard]] bool operator==(const Settings&) const = default;
};

/// A library's mapper, whose calls from several threads wait for each other.
template <class Query>
class PythonMapper {
 public:
  /// `make` makes the library's mapper of these options, without Python's lock.
  template <class Make>
  PythonMapper(const Settings& settings, const Make& make)
      : settings_(settings),
        limit_(settings.time_limit),
        mapper_(without_lock(interruption_, [&] { return make(options()); })) {}

  /// Of one model.
  PythonMapper(const PythonModel& model, const Settings& settings)
      : PythonMapper(settings, [&](const MapOptions& options) { return Mapper<Query>(model.model(), options); }) {}

  PythonMap operator()(const Queries<Query>& queries) {
    PythonMap map = empty_map(queries.size(), settings_.tolerance);
    const ResultColumns rows = columns(map);
    const std::unique_lock<std::timed_mutex> one_at_a_time = turn();
    const Caller caller(caller_);
    interruption_.reset();
    limit_.start();
    if (settings_.certificates) {
      const auto list = std::make_shared<CertificateList>();
      map.summary = without_lock(interruption_, [&] { return with_certificates(queries, rows, *list); });
      map.certificates = list;
    } else {
      map.summary = without_lock(interruption_, [&] { return mapper_.map(queries.in_memory(), rows); });
    }
    return map;
  }

 private:
  /// The thread whose turn it is, as long as this lives.
  class Caller {
   public:
    explicit Caller(std::atomic<std::thread::id>& caller) : caller_(caller) {
      caller_.store(std::this_thread::get_id());
    }
    ~Caller() { caller_.store(std::thread::id()); }
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;
    Caller(Caller&&) = delete;
    Caller& operator=(Caller&&) = delete;

   private:
    std::atomic<std::thread::id>& caller_;
  };

  /// Waits for the calls of other threads, until Ctrl-C. Throws where this thread would wait for itself, as in a
  /// signal's handler.
  [[nodiscard]] std::unique_lock<std::timed_mutex> turn() {
    constexpr std::chrono::milliseconds between{50};
    if (caller_ == std::this_thread::get_id())
      throw std::runtime_error("this mapper is being called by this thread already");
    std::unique_lock<std::timed_mutex> lock(calls_, std::defer_lock);
    while (true) {
      {
        const py::gil_scoped_release released;
        if (lock.try_lock_for(between)) return lock;
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
  }

  [[nodiscard]] MapOptions options() {
    MapOptions options{.tolerance = settings_.tolerance,
                       .device = settings_.device,
                       .certificates = settings_.certificates,
                       .point_radius = settings_.point_radius,
                       .interrupted = interruption_.poll(),
                       .out_of_time = limit_.out_of_time()};
    if (settings_.pose_uncertainty) {
      options.pose_uncertainty = settings_.pose_uncertainty->bounds();
      options.pose_divisions = settings_.pose_uncertainty->divisions;
    }
    return options;
  }

  MapSummary with_certificates(const Queries<Query>& queries, const ResultColumns& rows, CertificateList& list) {
    std::size_t read = 0;
    std::size_t written = 0;
    const auto source = [&](std::span<Query> chunk) {
      std::size_t count = 0;
      for (; count < chunk.size() && read < queries.size(); ++count) chunk[count] = queries[read++];
      return count;
    };
    const auto sink = [&](std::span<const Query>, std::span<const MapResult> results,
                          std::span<const Certificate> certificates) {
      for (const MapResult& result : results) rows.set(written++, result);
      list.certificates.insert(list.certificates.end(), certificates.begin(), certificates.end());
    };
    return mapper_.map(source, sink);
  }

  Settings settings_;
  Interruption interruption_;
  Deadline limit_;  // of each call
  std::timed_mutex calls_;
  std::atomic<std::thread::id> caller_;
  Mapper<Query> mapper_;  // last: its options point to the others
};

/// Of points, whose closest points it knows, too.
class PythonPointMapper : public PythonMapper<Point> {
 public:
  PythonPointMapper(const PythonModel& model, const Settings& settings)
      : PythonMapper(model, settings), model_(model), tolerance_(settings.tolerance) {}

  /// Made ready by the first call; Python's lock is held meanwhile.
  PythonClosestPoints closest_points(const py::handle& points) {
    if (!distance_) distance_.emplace(model_.exact("closest_points"));
    return closest_points_of(*distance_, points, tolerance_);
  }

 private:
  PythonModel model_;
  double tolerance_;
  std::optional<SignedDistance> distance_;
};

Settings settings_of(double radius, const std::optional<double>& tolerance, const std::string& device,
                     bool certificates, double point_radius, const MaybeUncertain& pose_uncertainty,
                     const std::optional<double>& time_limit = {}) {
  check_length(point_radius, "point_radius");
  check_time_limit(time_limit);
  return {tolerance_or_default(tolerance, radius), device, certificates, point_radius, time_limit, pose_uncertainty};
}

template <class Query>
std::unique_ptr<PythonMapper<Query>> mapper(const PythonModel& model, const Settings& settings) {
  return std::make_unique<PythonMapper<Query>>(model, settings);
}

std::unique_ptr<PythonMapper<Pose>> mapper(const PythonModel& a, const PythonModel& b, const Settings& settings) {
  return std::make_unique<PythonMapper<Pose>>(
      settings, [&](const MapOptions& options) { return PoseMapper(a.model(), b.model(), options); });
}

Settings settings_of(const PythonModel& a, const PythonModel& b, const std::optional<double>& tolerance,
                     const std::string& device, const MaybeUncertain& pose_uncertainty,
                     const std::optional<double>& time_limit = {}) {
  check_units(a, b);
  return settings_of(std::max(a.bounding_radius(), b.bounding_radius()), tolerance, device, false, 0.0,
                     pose_uncertainty, time_limit);
}

std::string device_for(std::size_t rows, const std::string& device) {
  return device == "auto" && rows <= few_rows ? "host" : device;
}

/// The device's mapper of the last map that is done, for the next one of the same model: what a device compiles for a
/// model it may keep to the end of the process. A map takes it, and gives it back: maps of other threads meanwhile make
/// their own.
template <class Query>
class LastMapper {
 public:
  using Owned = std::unique_ptr<PythonMapper<Query>>;

  /// Null where the last map was another one's.
  [[nodiscard]] Owned take(const PythonModel& model, const Settings& settings) {
    const std::lock_guard lock(mutex_);
    if (mapper_ == nullptr || identity_ != model.identity() || settings_ != settings) return nullptr;
    return std::move(mapper_);
  }

  void give_back(const PythonModel& model, const Settings& settings, Owned mapper) {
    const std::lock_guard lock(mutex_);
    identity_ = model.identity();
    settings_ = settings;
    mapper_.swap(mapper);
  }

  /// For as long as the process lives: what belongs to a device may not end after the device's library.
  static LastMapper& instance() {
    static auto* const last = new LastMapper;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): locked
    return *last;
  }

 private:
  std::mutex mutex_;
  std::uint64_t identity_ = 0;
  Settings settings_{};
  Owned mapper_;
};

template <class Query>
PythonMap map(const PythonModel& unmoved, const py::handle& object, const py::handle& by,
              const std::optional<double>& tolerance, const std::string& device, double point_radius,
              const std::optional<double>& time_limit, bool certificates, const MaybeUncertain& pose_uncertainty) {
  const Queries<Query> queries(object);
  std::optional<PythonModel> moved;
  if (!by.is_none()) moved = posed(unmoved, pose(by));
  const PythonModel& model = moved ? *moved : unmoved;
  const Settings settings = settings_of(model.bounding_radius(), tolerance, device_for(queries.size(), device),
                                        certificates, point_radius, pose_uncertainty, time_limit);
  if (settings.device == "host") return (*mapper<Query>(model, settings))(queries);
  auto& last = LastMapper<Query>::instance();
  auto ready = last.take(model, settings);
  if (ready == nullptr) ready = mapper<Query>(model, settings);
  PythonMap found = (*ready)(queries);
  last.give_back(model, settings, std::move(ready));  // not where it threw
  return found;
}

PythonMap map_of_poses(const PythonModel& a, const PythonModel& b, const py::handle& object,
                       const std::optional<double>& tolerance, const std::string& device,
                       const std::optional<double>& time_limit, const MaybeUncertain& pose_uncertainty) {
  const Queries<Pose> queries(object);
  const Settings settings =
      settings_of(a, b, tolerance, device_for(queries.size(), device), pose_uncertainty, time_limit);
  return (*mapper(a, b, settings))(queries);
}

template <class Query>
PythonMap call(PythonMapper<Query>& self, const py::handle& object) {
  return self(Queries<Query>(object));
}

/// Of a class that a model and settings make, for maps of such queries.
template <class Class, class Query>
py::class_<Class> declare_mapper(py::module_& module, const char* name, const char* explanation, const char* queries) {
  py::class_<Class> declared(module, name, explanation);
  declared
      .def(py::init([](const PythonModel& model, const std::optional<double>& tolerance, const std::string& device,
                       double point_radius, bool certificates, const MaybeUncertain& pose_uncertainty) {
             return std::make_unique<Class>(model, settings_of(model.bounding_radius(), tolerance, device, certificates,
                                                               point_radius, pose_uncertainty));
           }),
           py::arg("model"), py::kw_only(), py::arg("tolerance") = py::none(), py::arg("device") = "auto",
           py::arg("point_radius") = 0.0, py::arg("certificates") = false, py::arg("pose_uncertainty") = py::none())
      .def(
          "__call__", [](Class& self, const py::handle& object) { return call<Query>(self, object); },
          py::arg(queries));
  return declared;
}

template <class Query>
void declare_map(py::module_& module, const char* name, const char* queries, const char* explanation) {
  module.def(name, map<Query>, py::arg("model"), py::arg(queries), py::kw_only(), py::arg("pose") = py::none(),
             py::arg("tolerance") = py::none(), py::arg("device") = "auto", py::arg("point_radius") = 0.0,
             py::arg("time_limit") = py::none(), py::arg("certificates") = false,
             py::arg("pose_uncertainty") = py::none(), explanation);
}

void declare_mappers(py::module_& module) {
  declare_mapper<PythonPointMapper, Point>(
      module, "Mapper",
      "Mapper(model, *, tolerance=None, device=\"auto\", point_radius=0.0, certificates=False,\n"
      "    pose_uncertainty=None)\n\n"
      "A model made ready for maps of points: device chosen and tested, kernels compiled. Called with points, as "
      "map()\n"
      "takes them, it returns a Map. Many maps of one model pay for that once. Calls of several threads wait for each\n"
      "other. Arguments and errors are those of map().",
      "points")
      .def("closest_points", &PythonPointMapper::closest_points, py::arg("points"),
           "closest_points(points) -> ClosestPointMap\n\n"
           "As the function, of the model that is kept ready, to the mapper's tolerance; by the host's processors,\n"
           "whatever the device.");
  declare_mapper<PythonMapper<Triangle>, Triangle>(
      module, "TriangleMapper",
      "TriangleMapper(model, *, tolerance=None, device=\"auto\", point_radius=0.0, "
      "certificates=False,\n"
      "    pose_uncertainty=None)\n\n"
      "The same for maps of triangles: called with an array of shape (N, 3, 3).",
      "triangles");
  py::class_<PythonMapper<Pose>>(module, "PoseMapper",
                                 "PoseMapper(a, b, *, tolerance=None, device=\"auto\", pose_uncertainty=None)\n\n"
                                 "Two models made ready for maps of poses: called with an array of shape (N, 7).")
      .def(py::init([](const PythonModel& a, const PythonModel& b, const std::optional<double>& tolerance,
                       const std::string& device, const MaybeUncertain& pose_uncertainty) {
             return mapper(a, b, settings_of(a, b, tolerance, device, pose_uncertainty));
           }),
           py::arg("a"), py::arg("b"), py::kw_only(), py::arg("tolerance") = py::none(), py::arg("device") = "auto",
           py::arg("pose_uncertainty") = py::none())
      .def("__call__", call<Pose>, py::arg("poses"));
}

}  // namespace

void declare_maps(py::module_& module) {
  declare_pose_uncertainty(module);
  declare_mappers(module);
  declare_map<Point>(
      module, "map", "points",
      "map(model, points, *, pose=None, tolerance=None, device=\"auto\", point_radius=0.0, time_limit=None,\n"
      "    certificates=False, pose_uncertainty=None) -> Map\n\n"
      "Encloses the signed distance of each point to the model: positive outside, the Euclidean distance; negative\n"
      "inside, minus the distance to the boundary.\n\n"
      "points: shape (N, 3), in model units; nothing else may write there meanwhile. float64 is read where it lies,\n"
      "    whatever its strides; float32, float16, other byte orders and integers are widened exactly, into a copy.\n"
      "    A mesh, of this or another package, stands for its vertices.\n"
      "pose: moves the model first, as Model.posed(pose) does, whose rounded numbers are what the rows are proven of;\n"
      "    a Checker needs that model.\n"
      "tolerance: rows at most as wide are verified, in model units; 0 asks for the tightest. Default: 1e-6 of the\n"
      "    model's bounding_radius.\n"
      "device: \"auto\" (the host for up to 128 rows), \"host\", an index as text or a part of a device's name.\n"
      "point_radius: each point is any within this distance of the given one, in model units.\n"
      "time_limit: seconds; then what is open stays valid, and wide.\n"
      "certificates: keep what proves each row again, for Checker.\n"
      "pose_uncertainty: how well the model's place is known, a PoseUncertainty; each row then contains the distances\n"
      "    at all places, and is never narrower than they differ. Not with certificates.\n\n"
      "Other threads of Python run meanwhile. Ctrl-C ends the map: KeyboardInterrupt.\n\n"
      "Raises ValueError for another shape, TypeError for numbers that binary64 does not hold exactly, Error for a\n"
      "point that is not finite, and for models and devices as `verisq map` does.");
  declare_map<Triangle>(
      module, "map_triangles", "triangles",
      "map_triangles(model, triangles, *, pose=None, tolerance=None, device=\"auto\", point_radius=0.0, "
      "time_limit=None,\n"
      "    certificates=False, pose_uncertainty=None) -> Map\n\n"
      "Encloses the distance of each whole triangle to the model, 0 where they meet. triangles: shape (N, 3, 3), the\n"
      "corners; or a mesh, of this or another package. They are copied. Otherwise as map().");
  module.def(
      "map_poses", map_of_poses, py::arg("a"), py::arg("b"), py::arg("poses"), py::kw_only(),
      py::arg("tolerance") = py::none(), py::arg("device") = "auto", py::arg("time_limit") = py::none(),
      py::arg("pose_uncertainty") = py::none(),
      "map_poses(a, b, poses, *, tolerance=None, device=\"auto\", time_limit=None, pose_uncertainty=None) -> Map\n\n"
      "Encloses the distance of model a and of model b moved by each pose, 0 where they meet. poses: shape\n"
      "(N, 7): translation in model units and quaternion [w, x, y, z] of any length but 0; a point x of b goes\n"
      "to R x + t; or rigid matrices (N, 4, 4), or a stack of SciPy's Rotation. They are copied. pose_uncertainty: how "
      "well each place of b is known, in b's coordinates. "
      "Default tolerance: 1e-6 of the larger bounding_radius. Models with bends or set\n"
      "operations are searched, pose by pose on all processors. time_limit: seconds; then what is open stays valid,\n"
      "and wide. Raises Error as map().");
}

}  // namespace verisq::python
