/// Where a body stands still, by another formulation: the least potential energy, by homogeneous transforms and
/// differences in long double; and the body of examples/standing.xml.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/stance.hpp>

#include "tests/fixtures/places.hpp"

namespace verisq::stance::oracle {

using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;
using Matrix = Eigen::Matrix<Real, 3, 3>;
using Positions = std::vector<Real>;

constexpr std::size_t ty = 1;
constexpr std::size_t rz = 3;
constexpr std::size_t rx = 4;

inline Real value(const Quantity& quantity, std::span<const double> parameters) {
  return quantity.parameter ? parameters[*quantity.parameter] : quantity.nominal;
}

inline Vector values(const QuantityVector& vector, std::span<const double> parameters) {
  return {value(vector[0], parameters), value(vector[1], parameters), value(vector[2], parameters)};
}

inline Matrix turn(std::uint8_t axis, Real angle) {
  return Eigen::AngleAxis<Real>(angle, Vector::Unit(axis)).toRotationMatrix();
}

enum class Joints { stiff, springs };
enum class Ground { sticks, lets_go };

/// Of a posture: of the weights, the springs at the points of contact and those of the joints.
class Energy {
 public:
  Energy(const Model& model, std::span<const double> parameters, Joints joints, Ground ground = Ground::sticks)
      : model_(model), parameters_(parameters), joints_(joints), ground_(ground) {}

  [[nodiscard]] Real operator()(const Positions& q) const {
    // The force acts before the root's origin by its offset, wherever the root turns to.
    const Real lever = -value(model_.bodies.front().offset[0], parameters_);
    Real energy = -value(model_.applied.force[1], parameters_) * (q[ty] + lever * q[rz]);
    place_bodies(q);
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const Body& body = model_.bodies[i];
      energy += value(body.mass, parameters_) * model_.gravity *
                (origins_[i] + turns_[i] * values(body.centre_of_mass, parameters_))[1];
    }
    for (const ContactCylinder& cylinder : model_.cylinders) {
      for (const Real depth : depths(cylinder)) {
        const Real n = cylinder.exponent;
        const Real acting = ground_ == Ground::sticks ? std::abs(depth) : std::max(depth, Real(0));
        energy += value(cylinder.stiffness, parameters_) / 2 * std::pow(acting, n + 1) / (n + 1);
      }
    }
    return energy + (joints_ == Joints::springs ? of_springs(q) : 0);
  }

  /// Of all points, negative above the ground.
  [[nodiscard]] std::vector<Real> penetrations(const Positions& q) const {
    place_bodies(q);
    std::vector<Real> result;
    for (const ContactCylinder& cylinder : model_.cylinders) {
      for (const Real depth : depths(cylinder)) result.push_back(depth);
    }
    return result;
  }

  /// Central differences of fourth order.
  [[nodiscard]] Real slope(Positions q, std::size_t joint) const {
    constexpr Real step = 1e-5L;
    const Real at = q[joint];
    const auto moved = [&](int steps) {
      q[joint] = at + steps * step;
      return (*this)(q);
    };
    return (8 * (moved(1) - moved(-1)) - (moved(2) - moved(-2))) / (12 * step);
  }

  /// An equilibrium of a body with stiff joints, by Newton's method from a posture near it.
  [[nodiscard]] Positions stationary(Positions q) const {
    const std::array free{ty, rz, rx};
    for (int round = 0; round < 40; ++round) {
      Vector slopes;
      Matrix second;
      for (Eigen::Index i = 0; i < 3; ++i) slopes[i] = slope(q, free[static_cast<std::size_t>(i)]);
      for (Eigen::Index j = 0; j < 3; ++j) {
        constexpr Real step = 1e-6L;
        Positions moved = q;
        moved[free[static_cast<std::size_t>(j)]] += step;
        for (Eigen::Index i = 0; i < 3; ++i)
          second(i, j) = (slope(moved, free[static_cast<std::size_t>(i)]) - slopes[i]) / step;
      }
      const Vector change = second.partialPivLu().solve(slopes);
      for (Eigen::Index i = 0; i < 3; ++i) q[free[static_cast<std::size_t>(i)]] -= change[i];
      if (change.norm() < 1e-14L) break;
    }
    return q;
  }

 private:
  void place_bodies(const Positions& q) const {
    origins_.clear();
    turns_.clear();
    std::size_t next = 0;
    for (const Body& body : model_.bodies) {
      Matrix r = body.parent ? turns_[*body.parent] : Matrix(Matrix::Identity());
      Vector p = body.parent ? origins_[*body.parent] : Vector(Vector::Zero());
      p += r * values(body.offset, parameters_);
      for (const Joint& joint : body.joints) {
        if (joint.kind == JointKind::translation) {
          p += r.col(joint.axis) * q[next++];
        } else {
          r = Matrix(r * turn(joint.axis, q[next++]));
        }
      }
      origins_.push_back(p);
      turns_.push_back(r);
    }
  }

  [[nodiscard]] std::array<Real, 2> depths(const ContactCylinder& cylinder) const {
    const Vector in_body(cylinder.axis[0], cylinder.axis[1], cylinder.axis[2]);
    const Vector axis = turns_[cylinder.body] * in_body;
    const Vector centre = origins_[cylinder.body] + turns_[cylinder.body] * values(cylinder.centre, parameters_);
    const Real along = cylinder.half_length / std::sqrt(Real(3));
    const Real lowest = value(cylinder.radius, parameters_) * std::sqrt(1 - axis[1] * axis[1]);
    return {lowest - (centre[1] - along * axis[1]), lowest - (centre[1] + along * axis[1])};
  }

  [[nodiscard]] Real of_springs(const Positions& q) const {
    Real energy = 0;
    for (const Controller& controller : model_.controllers) {
      std::size_t joint = controller.joint;
      for (std::size_t i = 0; i < controller.body; ++i) joint += model_.bodies[i].joints.size();
      const Real error = q[joint] - model_.bodies[controller.body].joints[controller.joint].position;
      energy += controller.proportional * error * error / 2;
    }
    return energy;
  }

  const Model& model_;
  std::span<const double> parameters_;
  Joints joints_;
  Ground ground_;
  mutable std::vector<Vector> origins_;
  mutable std::vector<Matrix> turns_;
};

inline Model standing_model() {
  return read_model(places::example("standing.xml"));
}

inline std::vector<double> nominal(const Model& model) {
  std::vector<double> result;
  for (const Parameter& parameter : model.parameters) result.push_back(parameter.nominal);
  return result;
}

inline Positions of_file(const Model& model) {
  Positions q;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) q.push_back(joint.position);
  }
  return q;
}

inline std::vector<std::uint32_t> indices(const Model& model, const std::vector<std::string>& names) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i) {
    if (std::ranges::find(names, model.parameters[i].name) != names.end()) result.push_back(i);
  }
  return result;
}

inline Model within_one_per_cent(Model model) {
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i) {
    const double at = model.parameters[i].nominal;
    if (at > 0.0) model = narrowed(std::move(model), i, {0.99 * at, 1.01 * at});
  }
  return model;
}

}  // namespace verisq::stance::oracle
