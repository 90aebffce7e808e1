/// All sources of the Python module use this: its parts, and arrays of NumPy.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>
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

// NumPy arrays as queries: where they lie if they are binary64, else widened where that is exact.

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
