/// All sources of the Python module use this: its parts, arrays of NumPy, and the classes that several sources share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/checker.hpp>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/distance.hpp>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq::python {

// What each file of the module adds to it, in the order in which it must: a class before what mentions it.

void declare_errors(pybind11::module_& module);
void declare_enclosures(pybind11::module_& module);
void declare_models(pybind11::module_& module);
void declare_signed_distance(pybind11::module_& module);
void declare_meshes(pybind11::module_& module);
void declare_class_of_maps(pybind11::module_& module);
void declare_maps(pybind11::module_& module);
void declare_certificates(pybind11::module_& module);
void declare_closest_points(pybind11::module_& module);
void declare_closest_pairs(pybind11::module_& module);
void declare_answers(pybind11::module_& module);
void declare_pairs(pybind11::module_& module);
void declare_paths(pybind11::module_& module);
void declare_deviations(pybind11::module_& module);
void declare_recoveries(pybind11::module_& module);
void declare_features(pybind11::module_& module);
void declare_octrees(pybind11::module_& module);
void declare_clearances(pybind11::module_& module);
void declare_insertions(pybind11::module_& module);
void declare_fits(pybind11::module_& module);
void declare_stances(pybind11::module_& module);
void declare_devices(pybind11::module_& module);

// Work without Python's lock, which Ctrl-C ends.

/// Asks Python now and then whether a signal's handler raised something, KeyboardInterrupt for Ctrl-C. Python runs
/// handlers in its main thread alone: queries of other threads never see any.
class Interruption {
 public:
  Interruption() = default;
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;
  ~Interruption() = default;

  /// For the library's options: true once a handler raised. Only the thread that made this asks Python, whose lock it
  /// must not hold then; threads that work for it are told. This must outlive it.
  [[nodiscard]] std::function<bool()> poll() {
    return [this] { return raised(); };
  }

  /// As made anew, by this thread. Precondition: nobody polls.
  void reset() {
    owner_ = std::this_thread::get_id();
    stop_ = false;
    exception_.reset();
  }

  /// Raises in Python what a handler raised. Precondition: Python's lock is held.
  void rethrow() const {
    if (exception_) throw pybind11::error_already_set(*exception_);
  }

 private:
  /// To take Python's lock costs what another thread makes of its turn: not at every poll.
  [[nodiscard]] bool raised() {
    constexpr std::chrono::milliseconds between{50};
    if (stop_ || std::this_thread::get_id() != owner_) return stop_;
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < between) return false;
    asked_ = now;
    const pybind11::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() == 0) return false;
    exception_.emplace();  // takes over what is raised
    stop_ = true;
    return true;
  }

  std::thread::id owner_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point asked_{};
  std::optional<pybind11::error_already_set> exception_;
  std::atomic<bool> stop_ = false;
};

/// What `work` returns, done without Python's lock; raises what a handler raised meanwhile. Precondition: the lock is
/// held, `work` touches nothing of Python but by polls of `interruption`.
template <class Work>
auto without_lock(const Interruption& interruption, const Work& work) {
  auto result = [&] {
    const pybind11::gil_scoped_release released;
    return work();
  }();
  interruption.rethrow();
  return result;
}

/// True once the work is to end.
using Interrupted = std::function<bool()>;

/// The same with an interruption of its own, which `work` polls.
template <std::invocable<Interrupted> Work>
auto without_lock(const Work& work) {
  Interruption interruption;
  return without_lock(interruption, [&] { return work(interruption.poll()); });
}

// NumPy arrays as queries: where they lie if they are binary64, else widened where that is exact.

/// Returns whether it is a mesh or cloud, of this or another package: python/verisq/_objects.py reads it then.
[[nodiscard]] bool is_mesh(pybind11::handle object);

/// Precondition: is_mesh. Throws ValueError for polygons that are no triangles, and as `mesh`.
[[nodiscard]] Mesh mesh_of(pybind11::handle object);

/// Numbers of one shape; -1 stands for any length. The array itself, whatever its strides, if it holds aligned binary64
/// of this machine's byte order; else a copy, in which every number is the same. Throws TypeError for types whose
/// numbers binary64 may not hold (but 64-bit integers where all lie within 2^53) and for masked arrays, ValueError for
/// other shapes.
[[nodiscard]] pybind11::array numbers(pybind11::handle object, std::string_view name,
                                      const std::vector<pybind11::ssize_t>& shape);

/// The points of an array of shape (N, 3), which must outlive them. Precondition: from `numbers`.
[[nodiscard]] PointColumns columns(const pybind11::array& points);

/// Copies of an array of shape (N, 3), or the vertices of a mesh.
[[nodiscard]] std::vector<Point> points(pybind11::handle object, std::string_view name);
/// ... (N, 3, 3): corners of triangles, or those of a mesh.
[[nodiscard]] std::vector<Triangle> triangles(pybind11::handle object, std::string_view name);
/// ... (N, 7): translation and quaternion [w, x, y, z]; or rigid matrices (N, 4, 4), or a stack of SciPy's Rotation.
[[nodiscard]] std::vector<Pose> poses(pybind11::handle object, std::string_view name);

/// Copies of integers of shape (N,). Throws TypeError for other types, ValueError for other shapes and where they are
/// beyond 2^53.
[[nodiscard]] std::vector<std::int64_t> integers(pybind11::handle object, std::string_view name);

/// A sequence of seven numbers, what `verisq.pose` takes instead, or None: no motion. Throws Error(input) for numbers
/// that are not finite and a quaternion of zero.
[[nodiscard]] Pose pose(pybind11::handle object);
/// A sequence of three numbers.
[[nodiscard]] Point point(pybind11::handle object);

/// A sequence of six numbers, a point and a normal of any length, or None. Throws Error(input) for numbers that are not
/// finite and a normal of zero.
[[nodiscard]] std::optional<Plane> plane(pybind11::handle object);

/// Vertices (N, 3), and triangles (M, 3) of indices, or None: a cloud. Throws ValueError also for an index that no
/// vertex has, Error(input) for coordinates that are not finite.
[[nodiscard]] Mesh mesh(pybind11::handle vertices, pybind11::handle triangles);

// Landmarks of a femur as dictionaries of points, and sides as words.

/// Points by their names, and "head_radius".
[[nodiscard]] pybind11::dict dictionary(const FemurLandmarks& landmarks);

/// And back. Throws Error(input) for a name that is none.
[[nodiscard]] FemurLandmarks landmarks_of(const pybind11::dict& description);

/// "left", "right" or nothing. Throws ValueError for other words.
[[nodiscard]] std::optional<Side> side_of(const std::optional<std::string>& word);

// The class verisq.Model: what a model file says, exact or not.

/// Immutable, as read.
class PythonModel {
 public:
  explicit PythonModel(UncertainModel model, FemurLandmarks landmarks = {}, std::vector<AreaBox> areas = {});

  [[nodiscard]] const UncertainModel& model() const { return model_; }
  [[nodiscard]] const FemurLandmarks& landmarks() const { return landmarks_; }
  [[nodiscard]] const std::vector<AreaBox>& areas() const { return areas_; }
  /// The model itself, or the largest that its intervals allow.
  [[nodiscard]] const Model& largest() const { return largest_; }
  [[nodiscard]] double bounding_radius() const { return bounding_radius_; }
  /// Of no other model that this process has made, but of copies of this one.
  [[nodiscard]] std::uint64_t identity() const { return identity_; }

  /// The ordinary model. Throws Error(input) that says `what` needs one, where this has intervals.
  [[nodiscard]] const Model& exact(std::string_view what) const;

 private:
  UncertainModel model_;
  FemurLandmarks landmarks_;
  std::vector<AreaBox> areas_;
  Model largest_;
  double bounding_radius_;
  std::uint64_t identity_;
};

/// As given, or what the command line takes instead: 1e-6 of this radius. Throws Error(input) for a radius too large
/// for that, ValueError for a tolerance that is negative or not finite.
[[nodiscard]] double tolerance_or_default(const std::optional<double>& given, double radius);

/// The same along ways and for whole meshes, every distance of which is searched: 1e-3 of the radius, and never 0.
[[nodiscard]] double tolerance_along_way(const std::optional<double>& given, double radius);

/// The model moved. Throws Error(input) for one with intervals.
[[nodiscard]] PythonModel posed(const PythonModel& model, const Pose& by);

/// Lengths of two models can be compared only in one unit: throws Error(input) where both name one, and not the same.
void check_units(const PythonModel& a, const PythonModel& b);

/// Throws ValueError unless the number is finite and at least 0.
void check_length(double value, std::string_view name);

/// Throws ValueError unless these are seconds above 0, and at most 1e9.
void check_time_limit(const std::optional<double>& seconds);

// The class verisq.Mesh: an immutable mesh or cloud, of which arrays are views.

struct PythonMesh {
  Mesh mesh;
};

/// A mesh of this or another package; or an array of points (N, 3), which is a cloud.
[[nodiscard]] Mesh mesh_or_cloud(pybind11::handle object);

// The class verisq.Answer, which certified results of all kinds become.

struct PythonAnswer {
  Answer answer;
  std::string name = "answer";  ///< stands for its file in messages
};

/// The units that the first of these model files names; "" where none does. Throws Error(input).
[[nodiscard]] std::string units_of(const std::vector<std::filesystem::path>& models);

// The class verisq.Certificates: what proves the rows of a map again, kept as the library has it.

/// One for each row, in the order of the map.
struct CertificateList {
  std::vector<Certificate> certificates;
};

// The class verisq.ClosestPointMap, and what fills it.

/// What one call found, and of which points.
struct PythonClosestPoints {
  pybind11::array points;
  std::vector<ClosestPoint> rows;
  ClosestPointSummary summary;
};

/// Of an array of shape (N, 3), without Python's lock; the tolerance in model units.
[[nodiscard]] PythonClosestPoints closest_points_of(const SignedDistance& distance, const pybind11::handle& points,
                                                    double tolerance);

// The class verisq.Map: rows as arrays, and what is said of all of them.

static_assert(sizeof(Status) == 1);

/// A finished map: its columns are arrays.
struct PythonMap {
  pybind11::array_t<double> lo;
  pybind11::array_t<double> hi;
  pybind11::array_t<std::uint8_t> status;
  std::shared_ptr<const CertificateList> certificates;  ///< null unless asked for
  MapSummary summary;
  double tolerance;
};

/// Of so many rows, which are not set.
[[nodiscard]] PythonMap empty_map(std::size_t size, double tolerance);

/// Where its rows are.
[[nodiscard]] ResultColumns columns(PythonMap& map);

/// A copy of finished rows.
[[nodiscard]] PythonMap map_of_rows(std::span<const MapResult> rows, const MapSummary& summary, double tolerance);

// The class verisq.CertifiedBound: how good a fit can be at best, with what proves it again.

struct PythonCertifiedBound {
  BestFitClaim claim;
  BestFitCertificate certificate;
};

void declare_class_of_certified_bounds(pybind11::module_& module);

// The class verisq.CertifiedContact: how much of a mesh's area is in contact, with what proves it again.

struct PythonCertifiedContact {
  std::vector<std::string> areas;  ///< names of the regions
  ContactTerms terms;
  ContactClaims claims;
  ContactCertificate certificate;
};

void declare_class_of_certified_contacts(pybind11::module_& module);

}  // namespace verisq::python
