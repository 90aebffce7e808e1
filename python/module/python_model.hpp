/// The classes verisq.Model, verisq.Mesh and verisq.Answer, and a femur's landmarks as dictionaries.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/clearance.hpp>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::python {

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

/// What stands for a mesh: a verisq.Mesh, or an array of points (N, 3): a cloud.
[[nodiscard]] Mesh mesh_or_cloud(pybind11::handle object);

// The class verisq.Answer, which certified results of all kinds become.

struct PythonAnswer {
  Answer answer;
  std::string name = "answer";  ///< stands for its file in messages

  static constexpr std::size_t members = 2;
};

/// The units that the first of these model files names; "" where none does. Throws Error(input).
[[nodiscard]] std::string units_of(const std::vector<std::filesystem::path>& models);

}  // namespace verisq::python
