/// Motions of a standing body in the coordinates that its contacts leave, and small ones about an equilibrium.
#pragma once

#include <Eigen/Core>
#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/stance.hpp>

#include "verify/stance/linear_systems.hpp"
#include "verify/stance/scalar.hpp"
#include "verify/stance/standing.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {

// The equations of motion, reduced to the forces on those bodies whose mass or centre of mass is uncertain: three
// unknowns a body in place of the whole tree (docs/stance.md §3).

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

// Small motions of a body at rest on the ground: masses, damping and stiffness in the joints' coordinates, over any
// scalar (docs/stance.md §8).

template <class T>
using DynamicMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// M q'' + C q' + K q = 0 for small q: all joints but that the root's translations are those of the reference point,
/// and its rotations turn about it. What controllers do is left out.
template <class T>
struct SmallMotions {
  DynamicMatrix<T> mass, damping, stiffness;
};

namespace small_motions_details {

/// The body and how its points move with the joints' rates.
template <class T>
class MovingBody {
 public:
  /// One column a joint.
  using Jacobian = Eigen::Matrix<T, 3, Eigen::Dynamic>;

  MovingBody(const Model& model, const std::vector<T>& parameters, const std::vector<T>& joints,
             const std::array<double, 3>& reference)
      : body_(standing_details::body_in_root(model, parameters, joints)),
        turned_(standing_details::orientation_of_root(model, joints)),
        reference_(standing_details::exact<T>(reference)),
        root_axes_(axes_of_root(model, joints)) {}

  /// From the reference point on, in axes parallel to the world's.
  [[nodiscard]] Vector3<T> place(const Vector3<T>& in_root) const { return turned_ * Vector3<T>(in_root - reference_); }
  [[nodiscard]] Vector3<T> place(std::size_t body, const Vector3<T>& in_body) const {
    return place(body_.body(body).point(in_body));
  }
  [[nodiscard]] Matrix3<T> orientation(std::size_t body) const { return turned_ * body_.body(body).orientation; }

  /// Of the point of a body that is at a place.
  [[nodiscard]] Jacobian velocity(std::size_t body, const Vector3<T>& at) const {
    return jacobian(body, [&](const Vector3<T>& axis, const Vector3<T>& from) -> Vector3<T> {
      return axis.cross(Vector3<T>(at - from));
    });
  }

  [[nodiscard]] Jacobian angular_velocity(std::size_t body) const {
    return jacobian(
        body, [](const Vector3<T>& axis, const Vector3<T>&) { return axis; }, T(0));
  }

 private:
  static std::vector<Vector3<T>> axes_of_root(const Model& model, const std::vector<T>& joints) {
    std::vector<Vector3<T>> axes;
    Matrix3<T> turned = Matrix3<T>::Identity();
    const std::vector<Joint>& of_root = model.bodies.front().joints;
    for (std::size_t j = 0; j < of_root.size(); ++j) {
      axes.push_back(turned.col(of_root[j].axis));
      if (of_root[j].kind == JointKind::rotation) turned = turned_about(turned, of_root[j].axis, joints[j]);
    }
    return axes;
  }

  static Matrix3<T> turned_about(const Matrix3<T>& turned, std::uint8_t axis, const T& angle) {
    const Transform<T> turn{std::nullopt, {{axis, cos(angle), sin(angle)}}};
    return kinematics_details::composed(BodyPose<T>{turned, zero_vector<T>()}, turn).orientation;
  }

  /// `of_rotation(axis, a place on it)` for rotations that carry the body, `along` times the axis for translations.
  template <class OfRotation>
  [[nodiscard]] Jacobian jacobian(std::size_t body, const OfRotation& of_rotation, const T& along = T(1)) const {
    Jacobian columns = Jacobian::Constant(3, static_cast<Eigen::Index>(body_.tree.degrees_of_freedom), T(0));
    const std::vector<Link<T>>& links = body_.tree.links;
    for (std::optional<std::size_t> i = body_.tree.body_link[body]; i; i = links[*i].parent) {
      if (links[*i].joint == nullptr) continue;
      const Joint& joint = *links[*i].joint;
      const std::size_t column = links[*i].degree_of_freedom;
      const bool of_root = *i <= body_.tree.body_link.front();
      const Vector3<T> axis =
          of_root ? root_axes_[column] : Vector3<T>(turned_ * Vector3<T>(body_.links[*i].orientation.col(joint.axis)));
      const Vector3<T> from = of_root ? zero_vector<T>() : place(body_.links[*i].position);
      const Vector3<T> moved = joint.kind == JointKind::rotation ? of_rotation(axis, from) : Vector3<T>(axis * along);
      columns.col(static_cast<Eigen::Index>(column)) = moved;
    }
    return columns;
  }

  standing_details::BodyInRoot<T> body_;
  Matrix3<T> turned_;
  Vector3<T> reference_;  ///< in the root's frame
  std::vector<Vector3<T>> root_axes_;
};

/// What gravity, the elastic forces of the cylinders and the applied force do to the joints: one number each.
template <class T>
[[nodiscard]] std::vector<T> vertical_forces(const Model& model, const std::vector<T>& parameters,
                                             const StandingPosture<T>& posture,
                                             const std::array<double, 3>& reference) {
  const MovingBody<T> body(model, parameters, posture.joints, reference);
  const StandingTerms<T> terms = standing_terms<T>(model, parameters, posture, reference, false);
  std::vector<T> result(posture.joints.size(), T(0));
  const auto add = [&](std::size_t of, const VerticalForce<T>& force) {
    const auto velocity = body.velocity(of, force.place);
    for (std::size_t j = 0; j < result.size(); ++j)
      result[j] += velocity(1, static_cast<Eigen::Index>(j)) * force.upward;
  };
  for (std::size_t i = 0; i < terms.weights.size(); ++i) add(i, terms.weights[i]);
  for (std::size_t i = 0; i < terms.points.size(); ++i)
    add(model.cylinders[i / points_of_cylinder].body, terms.points[i].force);
  add(0, terms.applied);
  return result;
}

/// The derivatives of `vertical_forces` by the posture, downhill: one column a joint.
template <class T>
[[nodiscard]] DynamicMatrix<T> stiffness_against_gravity(const Model& model, const std::vector<T>& parameters,
                                                         const StandingPosture<T>& posture,
                                                         const std::array<double, 3>& reference) {
  const std::vector<Dual<T>> constants(parameters.begin(), parameters.end());
  const std::vector<Joint>& root = model.bodies.front().joints;
  const auto size = static_cast<Eigen::Index>(posture.joints.size());
  DynamicMatrix<T> stiffness = DynamicMatrix<T>::Constant(size, size, T(0));
  for (std::size_t j = 0; j < posture.joints.size(); ++j) {
    StandingPosture<Dual<T>> moved{posture.height, {posture.joints.begin(), posture.joints.end()}};
    const bool slides = j < root.size() && root[j].kind == JointKind::translation;
    if (slides && root[j].axis != 1) continue;  // the ground is level
    (slides ? moved.height : moved.joints[j]).partial[0] = T(1);
    const std::vector<Dual<T>> forces = vertical_forces(model, constants, moved, reference);
    for (std::size_t i = 0; i < forces.size(); ++i)
      stiffness(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = -forces[i].partial[0];
  }
  return stiffness;
}

/// sum += rows^T weight rows.
template <class T, class Rows>
void add_weighted(DynamicMatrix<T>& sum, const Rows& rows, const T& weight) {
  for (Eigen::Index i = 0; i < sum.rows(); ++i) {
    if (is_zero(rows[i])) continue;
    for (Eigen::Index j = 0; j < sum.cols(); ++j) {
      if (!is_zero(rows[j])) sum(i, j) += rows[i] * rows[j] * weight;
    }
  }
}

}  // namespace small_motions_details

/// At a posture at rest in which all cylinders press. Friction sticks: the bristles' ends on the ground are where they
/// carry nothing. Preconditions as standing_terms; each cylinder has bristles.
template <class T>
[[nodiscard]] SmallMotions<T> small_motions(const Model& model, const std::vector<T>& parameters,
                                            const StandingPosture<T>& posture, const std::array<double, 3>& reference) {
  using namespace small_motions_details;
  const MovingBody<T> body(model, parameters, posture.joints, reference);
  const auto size = static_cast<Eigen::Index>(posture.joints.size());
  const DynamicMatrix<T> none = DynamicMatrix<T>::Constant(size, size, T(0));
  SmallMotions<T> result{none, none, stiffness_against_gravity(model, parameters, posture, reference)};
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& of = model.bodies[i];
    const auto velocity = body.velocity(i, body.place(i, values_of<T>(of.centre_of_mass, parameters)));
    const auto angular =
        Eigen::Matrix<T, 3, Eigen::Dynamic>(body.orientation(i).transpose() * body.angular_velocity(i));
    const T mass = value_of<T>(of.mass, parameters);
    const Vector3<T> inertia = values_of<T>(of.inertia, parameters);
    for (int k = 0; k < 3; ++k) {
      add_weighted<T>(result.mass, velocity.row(k), mass);
      add_weighted<T>(result.mass, angular.row(k), inertia[k]);
    }
  }
  const StandingTerms<T> terms = standing_terms<T>(model, parameters, posture, reference, false);
  for (std::size_t c = 0; c < model.cylinders.size(); ++c) {
    const ContactCylinder& cylinder = model.cylinders[c];
    constexpr double share = 1.0 / static_cast<double>(points_of_cylinder);
    // k delta^n (1 + D delta'/v_N) has the derivative k delta^n D/v_N by delta'.
    const T damping = damping_factor(value_of<T>(cylinder.normal_restitution, parameters)) /
                      value_of<T>(cylinder.impact_velocity, parameters);
    for (std::size_t i = points_of_cylinder * c; i < points_of_cylinder * (c + 1); ++i) {
      const VerticalForce<T>& force = terms.points[i].force;
      const auto velocity = body.velocity(cylinder.body, force.place);
      add_weighted<T>(result.damping, velocity.row(1), force.upward * damping);
      for (const int k : {0, 2}) {
        add_weighted<T>(result.stiffness, velocity.row(k), T(share * cylinder.bristle_stiffness));
        add_weighted<T>(result.damping, velocity.row(k), T(share * cylinder.bristle_damping));
      }
    }
  }
  return result;
}

}  // namespace verisq::stance
