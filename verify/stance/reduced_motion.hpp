/// The equations of motion, reduced to the forces on those bodies whose mass or centre of mass is uncertain: three
/// unknowns a body in place of the whole tree (docs/stance.md §3).
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/stance_analysis.hpp>

#include "verify/stance/contraction.hpp"
#include "verify/stance/ground_forces.hpp"
#include "verify/stance/parameters.hpp"
#include "verify/stance/spatial.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {

/// A linear system in the forces f_b that the tree exerts on the masses, each at its centre of mass in the axes of its
/// body, and in the joint accelerations. The tree without these masses has constant matrices, which are enclosed once.
class ReducedMotion {
 public:
  /// Nothing where one of `variables` acts by other numbers than masses, centres of mass, the applied force, radii and
  /// stiffnesses of cylinders, where a mass may be 0, or where the tree without the masses has no mass matrix that is
  /// proven to be regular. Parameters that are not variables take the values given. The model must outlive the result.
  [[nodiscard]] static std::optional<ReducedMotion> of(const Model& model, const Instant& instant,
                                                       std::span<const std::uint32_t> variables,
                                                       const std::vector<double>& parameters);

  /// The unknowns: the accelerations, then three of each force. In this order elimination leaves the many zeros alone.
  [[nodiscard]] Eigen::Index unknowns() const { return free_.size() + 3 * static_cast<Eigen::Index>(masses_.size()); }

  /// A(p).
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> matrix(const std::vector<T>& parameters) const {
    using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix result = Matrix::Identity(unknowns(), unknowns());
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Lever<T> lever = lever_of(centre(masses_[i], parameters));
      for (std::size_t j = 0; j < masses_.size(); ++j) {
        const Lever<T> other = lever_of(centre(masses_[j], parameters));
        Eigen::Matrix<T, 3, 3> block = lever * (masses_[i].compliance[j].template cast<T>() * other.transpose()).eval();
        if (i == j) {
          const T inverse = T(1) / value_of<T>(masses_[i].body->mass, parameters);
          for (int k = 0; k < 3; ++k) block(k, k) += inverse;
        }
        result.template block<3, 3>(row(i), row(j)) = block;
      }
      result.block(0, row(i), free_.size(), 3) = masses_[i].response.template cast<T>().lazyProduct(lever.transpose());
    }
    return result;
  }

  /// b(p) - A(p) x.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> residual(const std::vector<T>& parameters,
                                                             const Eigen::VectorXd& x) const {
    Eigen::Matrix<T, Eigen::Dynamic, 1> result(unknowns());
    const Vector3<T> applied = values_of<T>(model_->applied.force, parameters);
    auto accelerations = result.head(free_.size());
    accelerations = free_.template cast<T>() + by_applied_.template cast<T>().lazyProduct(applied);
    const std::vector<Pressure<T>> pressures = pressures_of(parameters);
    for (const auto& [response, size] : pressures) accelerations += response->joints.template cast<T>() * size;
    for (Eigen::Index i = 0; i < free_.size(); ++i) accelerations[i] -= T(x[i]);
    std::vector<Wrench<T>> wrenches;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Vector3<T> force{T(x[row(i)]), T(x[row(i) + 1]), T(x[row(i) + 2])};
      wrenches.emplace_back(lever_of(centre(masses_[i], parameters)).transpose() * force);
      accelerations -= masses_[i].response.template cast<T>().lazyProduct(wrenches.back());
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& mass = masses_[i];
      Wrench<T> motion = mass.free.template cast<T>() + mass.by_applied.template cast<T>() * applied;
      for (const auto& [response, size] : pressures) motion += response->masses[i].template cast<T>() * size;
      for (std::size_t j = 0; j < masses_.size(); ++j) motion -= mass.compliance[j].template cast<T>() * wrenches[j];
      const Vector3<T> c = centre(mass, parameters);
      const Vector3<T> turning = mass.angular_velocity.template cast<T>();
      Vector3<T> missing = lever_of(c) * motion + turning.cross(Vector3<T>(turning.cross(c)));
      const T body_mass = value_of<T>(mass.body->mass, parameters);
      for (int k = 0; k < 3; ++k) missing[k] -= T(x[row(i) + k]) / body_mass;
      result.template segment<3>(row(i)) = missing;
    }
    return result;
  }

 private:
  /// Moment above force, or angular above linear acceleration, about the origin of a body's frame and in its axes.
  template <class T>
  using Wrench = Eigen::Matrix<T, 6, 1>;
  /// The acceleration of a body's point, of its frame's; the transpose makes a force there a wrench.
  template <class T>
  using Lever = Eigen::Matrix<T, 3, 6>;

  struct Mass {
    const Body* body;
    /// The tree without the masses: what a wrench on the body takes from the joints' accelerations (a row a joint), and
    /// from the accelerations of each mass's body (by mass, this one's rows).
    IntervalMatrix response = {};
    std::vector<Eigen::Matrix<Interval, 6, 6>> compliance = {};
    Eigen::Matrix<Interval, 6, 1> free = {};        ///< the body's accelerations without applied force and wrenches
    Eigen::Matrix<Interval, 6, 3> by_applied = {};  ///< what each part of the applied force adds
    Vector3<Interval> angular_velocity = {};
  };

  /// What a force on the tree without the masses does.
  struct Response {
    IntervalVector joints = {};                              ///< to the joints' accelerations
    std::vector<Eigen::Matrix<Interval, 6, 1>> masses = {};  ///< to those of the masses' bodies
  };

  /// What 1 N upward at a place on a cylinder does, and what each metre of radius adds to that where the axis leans.
  struct PressedPointResponse {
    Response at_centre;
    std::optional<Response> by_radius = {};
  };

  struct PressedCylinder {
    const ContactCylinder* cylinder;
    BodyPose<Interval> pose;  ///< of its body: constant, for no offset is a variable
    std::vector<PressedPointResponse> points = {};
  };

  /// A force, or a force times a radius, and what one of it does.
  template <class T>
  struct Pressure {
    const Response* response;
    T size;
  };

  /// Those of the ground that are not 0.
  template <class T>
  [[nodiscard]] std::vector<Pressure<T>> pressures_of(const std::vector<T>& parameters) const {
    std::vector<Pressure<T>> result;
    for (const PressedCylinder& pressed : pressed_) {
      const BodyPose<T> pose{pressed.pose.orientation.template cast<T>(), pressed.pose.position.template cast<T>()};
      const std::vector<GroundForce<T>> forces = ground_forces<T>(*pressed.cylinder, pose, parameters);
      for (std::size_t i = 0; i < forces.size(); ++i) {
        const T& upward = forces[i].upward;
        if (is_zero(upward)) continue;
        result.push_back({&pressed.points[i].at_centre, upward});
        if (const auto& by_radius = pressed.points[i].by_radius)
          result.push_back({&*by_radius, upward * value_of<T>(pressed.cylinder->radius, parameters)});
      }
    }
    return result;
  }

  /// Solutions of the tree without the masses, by column; nothing where there is no proof.
  using Solver = std::function<std::optional<IntervalMatrix>(const IntervalMatrix& forces)>;

  /// Lets the ground press on all cylinders; `jacobians` are those of the masses' bodies. Whether all is proven.
  [[nodiscard]] bool press(const Tree<Interval>& tree, const std::vector<Interval>& parameters,
                           std::span<const IntervalMatrix> jacobians, const Solver& solution);

  explicit ReducedMotion(const Model& model) : model_(&model) {}

  [[nodiscard]] Eigen::Index row(std::size_t mass) const { return free_.size() + 3 * static_cast<Eigen::Index>(mass); }

  template <class T>
  [[nodiscard]] static Vector3<T> centre(const Mass& mass, const std::vector<T>& parameters) {
    return values_of<T>(mass.body->centre_of_mass, parameters);
  }

  /// angular x c + linear.
  template <class T>
  [[nodiscard]] static Lever<T> lever_of(const Vector3<T>& c) {
    Lever<T> result = Lever<T>::Zero();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      result(i, j) = c[k];
      result(i, k) = -c[j];
      result(i, 3 + i) = T(1);
    }
    return result;
  }

  const Model* model_;
  std::vector<Mass> masses_ = {};
  std::vector<PressedCylinder> pressed_ = {};
  IntervalVector free_ = {};        ///< accelerations of the joints without applied force and masses
  IntervalMatrix by_applied_ = {};  ///< what each part of the applied force adds
};

}  // namespace verisq::stance
