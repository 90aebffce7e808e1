/// The equations of motion of a body that stands, is pushed and controls its joints, in the sagittal plane, over any
/// scalar (docs/stance.md §9).
#pragma once

#include <cmath>
#include <span>
#include <vector>
#include <verisq/stance.hpp>

#include "verify/stance/collocation.hpp"
#include "verify/stance/sagittal_model.hpp"
#include "verify/stance/standing.hpp"
#include "verify/stance/taylor_model.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {

/// What the switches of a contact depend on: each changes sign where another branch begins to hold.
template <class T>
struct ContactSwitches {
  T penetration;  ///< m
  T damping;      ///< 1 + D delta'/v_N
  T friction;     ///< k_t s + c_t u: what friction would be if it stuck, N; 0 in flight
  T limit;        ///< of friction, N; 0 in flight
};

/// What one cylinder and the ground do to each other.
template <class T>
struct ContactForce {
  T normal;        ///< upward on the cylinder, N
  T friction;      ///< along x on the cylinder, N
  T bristle_rate;  ///< s', m/s
  ContactSwitches<T> switches;
};

/// A value of everything in the equations.
template <class T>
struct MotionTerms {
  std::vector<T> residual;                ///< M v' + h - forces, one a joint: 0 for a motion
  std::vector<T> rates;                   ///< of the state's other components, which depend on no rate
  std::vector<ContactForce<T>> contacts;  ///< of one cylinder each
};

namespace motion_details {

/// The damping factor D over the box of restitutions, by the mean value theorem about its middle:
/// at_middle + slope (e - middle) + rest.
struct AffineDamping {
  double middle;
  Interval at_middle, slope, rest;

  explicit AffineDamping(const Interval& restitution);

  template <class T>
  [[nodiscard]] T of(const T& restitution) const {
    const T linear = NumberWithin<T>::of(at_middle) + NumberWithin<T>::of(slope) * (restitution - T(middle));
    return is_zero(rest) ? linear : linear + NumberWithin<T>::of(rest);
  }
};

template <class T>
struct PlanarVector {
  T x, y;

  friend PlanarVector operator+(const PlanarVector& a, const PlanarVector& b) { return {a.x + b.x, a.y + b.y}; }
  friend PlanarVector operator-(const PlanarVector& a, const PlanarVector& b) { return {a.x - b.x, a.y - b.y}; }
  friend PlanarVector operator*(const T& a, const PlanarVector& b) { return {a * b.x, a * b.y}; }
};

/// Turned by a right angle.
template <class T>
[[nodiscard]] PlanarVector<T> crossed(const PlanarVector<T>& a) {
  return {-a.y, a.x};
}

/// The moment of b at the lever a.
template <class T>
[[nodiscard]] T moment(const PlanarVector<T>& a, const PlanarVector<T>& b) {
  return a.x * b.y - a.y * b.x;
}

/// A body's motion, all in the world's axes; accelerations are those of a body that feels gravity as one.
template <class T>
struct PlanarMotion {
  T cosine, sine;
  T angular_velocity, angular_acceleration;
  PlanarVector<T> origin, velocity, acceleration;
  PlanarVector<T> from_parent;  ///< origin less the parent's

  [[nodiscard]] PlanarVector<T> turned(const PlanarVector<T>& in_body) const {
    return {cosine * in_body.x - sine * in_body.y, sine * in_body.x + cosine * in_body.y};
  }
};

/// A force at a body's origin, and a moment.
template <class T>
struct PlanarLoad {
  PlanarVector<T> force;
  T moment;
};

template <class T>
[[nodiscard]] PlanarVector<T> planar(const QuantityVector& v, std::span<const T> parameters) {
  return {value_of(v[0], parameters), value_of(v[1], parameters)};
}

}  // namespace motion_details

/// The state: velocities of all joints, their positions, the integrals of the errors of joints with integral control,
/// the deflections of the bristles of all contacts. The parameters' box is centre + radius d, d in [-1, 1] each.
class ControlledMotion {
 public:
  /// `box` has an interval for each parameter of the model. The model must outlive this.
  ControlledMotion(const SagittalModel& model, std::vector<Interval> box, std::optional<Push> push);

  [[nodiscard]] std::size_t size() const { return 2 * joints() + integrals_.size() + model_.contacts.size(); }
  /// The first components, whose rates are accelerations.
  [[nodiscard]] std::size_t implicit() const { return joints(); }
  [[nodiscard]] std::size_t deviations() const { return uncertain_.size(); }
  [[nodiscard]] const SagittalModel& model() const { return model_; }

  [[nodiscard]] std::size_t joints() const { return model_.joints.size(); }
  [[nodiscard]] std::size_t position(std::size_t joint) const { return joints() + joint; }
  /// Joints with integral control, in the order of their integrals.
  [[nodiscard]] const std::vector<std::size_t>& integrals() const { return integrals_; }
  [[nodiscard]] std::size_t integral(std::size_t i) const { return 2 * joints() + i; }
  [[nodiscard]] std::size_t bristle(std::size_t contact) const { return 2 * joints() + integrals_.size() + contact; }

  /// Times at which the equations have kinks whatever the state: steps end there.
  [[nodiscard]] std::vector<double> breaks() const;

  /// To the matrix of a linearisation: a spring and a damper at each joint of the root, which nothing holds in flight,
  /// of about the frequency of standing and no two alike. In the choice of modes only.
  [[nodiscard]] Eigen::MatrixXd tether() const;

  /// `regime` is of a time between the same breaks as all of `time`; its branches need not be those that hold.
  template <class T>
  [[nodiscard]] MotionTerms<T> evaluate(std::span<const T> state, std::span<const T> acceleration, const T& time,
                                        const MotionRegime& regime, std::span<const T> deviations) const;

  /// The branches that hold for all values of `terms`.
  template <class T>
  [[nodiscard]] static MotionRegime settled(const MotionTerms<T>& terms, double within);

 private:
  template <class T>
  [[nodiscard]] std::vector<T> parameters(std::span<const T> deviations) const {
    std::vector<T> values;
    values.reserve(centre_.size());
    for (const double centre : centre_) values.emplace_back(centre);
    for (std::size_t k = 0; k < uncertain_.size(); ++k)
      values[uncertain_[k]] = T(centre_[uncertain_[k]]) + T(radius_[k]) * deviations[k];
    return values;
  }

  template <class T>
  [[nodiscard]] std::vector<motion_details::PlanarMotion<T>> motions(std::span<const T> state,
                                                                     std::span<const T> acceleration,
                                                                     std::span<const T> parameters) const;

  /// The load that each body needs to move so, at its origin.
  template <class T>
  [[nodiscard]] std::vector<motion_details::PlanarLoad<T>> inertial_loads(
      std::span<const motion_details::PlanarMotion<T>> motion, std::span<const T> parameters) const;

  /// The controllers' torques to the residual, and the rates of positions and of integrals.
  template <class T>
  void add_controllers(std::span<const T> state, MotionTerms<T>& terms) const;

  template <class T>
  [[nodiscard]] motion_details::PlanarVector<T> applied_force(const T& time, double within,
                                                              std::span<const T> parameters) const;

  const SagittalModel& model_;
  std::vector<double> centre_;
  std::vector<std::uint32_t> uncertain_;
  std::vector<double> radius_;  ///< of the uncertain ones, rounded up
  std::vector<std::size_t> integrals_;
  std::vector<motion_details::AffineDamping> damping_;  ///< of the contacts
  std::optional<Push> push_;
};

namespace motion_details {

/// normal_force() of contact.hpp, in the branches that are given, over what is open.
template <class T>
[[nodiscard]] T normal_force_in(const ContactBranches& branches, const T& stiffness, double exponent,
                                const T& penetration, const T& damped) {
  const auto clear = [](const T&) { return T(0); };
  const auto pressed = [&](const T& delta) {
    const T factor = branches.damping == Side::above ? damped : max(damped, T(0));
    // An approximation may look ahead, past the end of its branch: there only a linear force has a value.
    const T power = exponent == 1.0 ? delta : contact_details::power(T(max(delta, T(0))), exponent);
    return T(stiffness * power * factor);
  };
  if (branches.in_flight()) return T(0);
  if (branches.penetration == Side::above) return pressed(penetration);
  return piecewise(penetration, 0.0, clear, pressed);
}

/// A cylinder's contact at its lowest points; both points of Gauss's rule move alike in the plane.
/// `height` is of the cylinder's axis; `descent` and `slip` are the velocities downward and along x of the material
/// point that is lowest.
template <class T>
[[nodiscard]] ContactForce<T> contact_force(const ContactCylinder& cylinder, const AffineDamping& damping_factor,
                                            const ContactBranches& branches, std::span<const T> parameters,
                                            const T& height, const T& descent, const T& slip, const T& bristle) {
  const T penetration = value_of<T>(cylinder.radius, parameters) - height;
  const T damped = T(1) + damping_factor.of(value_of<T>(cylinder.normal_restitution, parameters)) * descent /
                              value_of<T>(cylinder.impact_velocity, parameters);
  const T normal =
      normal_force_in<T>(branches, value_of<T>(cylinder.stiffness, parameters), cylinder.exponent, penetration, damped);
  const T stiffness(cylinder.bristle_stiffness);
  const T damping(cylinder.bristle_damping);
  const T elastic = stiffness * bristle;
  if (is_zero(normal)) return {normal, T(0), -elastic / damping, {penetration, damped, T(0), T(0)}};  // in flight
  const FrictionLaw<T> friction{value_of<T>(cylinder.static_friction, parameters),
                                value_of<T>(cylinder.dynamic_friction, parameters), cylinder.stribeck_velocity};
  const T trial = elastic + damping * slip;
  const T limit = friction_coefficient(friction, slip) * normal;
  const ContactSwitches<T> switches{penetration, damped, trial, limit};
  const bool sticks =
      branches.friction == FrictionBranch::sticks ||
      (branches.friction == FrictionBranch::open && certainly_less(T(-limit), trial) && certainly_less(trial, limit));
  // Sticks: s' = u, exactly. Else s' is what makes the limited force k_t s + c_t s'. Equal where both hold.
  if (sticks) return {normal, -trial, slip, switches};
  const T limited = branches.friction == FrictionBranch::slips_forward    ? limit
                    : branches.friction == FrictionBranch::slips_backward ? T(-limit)
                                                                          : clamp(trial, T(-limit), limit);
  return {normal, -limited, (limited - elastic) / damping, switches};
}

}  // namespace motion_details

template <class T>
std::vector<motion_details::PlanarMotion<T>> ControlledMotion::motions(std::span<const T> state,
                                                                       std::span<const T> acceleration,
                                                                       std::span<const T> parameters) const {
  using namespace motion_details;
  std::vector<PlanarMotion<T>> result;
  std::vector<T> angles;
  for (const SagittalBody& body : model_.bodies) {
    PlanarMotion<T> m;
    T angle(0);
    if (body.parent) {
      const PlanarMotion<T>& parent = result[*body.parent];
      angle = angles[*body.parent];
      m = parent;
      m.from_parent = parent.turned(planar<T>(model_.model.bodies[body.body].offset, parameters));
      const PlanarVector<T> across = crossed(m.from_parent);
      m.origin = parent.origin + m.from_parent;
      m.velocity = parent.velocity + m.angular_velocity * across;
      m.acceleration =
          parent.acceleration + m.angular_acceleration * across - square(m.angular_velocity) * m.from_parent;
    } else {
      m.angular_velocity = m.angular_acceleration = T(0);
      m.from_parent = planar<T>(model_.model.bodies[body.body].offset, parameters);
      m.origin = m.from_parent + PlanarVector<T>{state[position(0)], state[position(1)]};
      m.velocity = {state[0], state[1]};
      m.acceleration = {acceleration[0], acceleration[1] + T(model_.model.gravity)};
    }
    if (body.joint) {
      angle = angle + state[position(*body.joint)];
      m.angular_velocity = m.angular_velocity + state[*body.joint];
      m.angular_acceleration = m.angular_acceleration + acceleration[*body.joint];
      m.cosine = cos(angle);
      m.sine = sin(angle);
    }
    angles.push_back(angle);
    result.push_back(m);
  }
  return result;
}

template <class T>
motion_details::PlanarVector<T> ControlledMotion::applied_force(const T& time, double within,
                                                                std::span<const T> parameters) const {
  motion_details::PlanarVector<T> force = motion_details::planar<T>(model_.model.applied.force, parameters);
  const Quantity& frequency = model_.model.applied.frequency;
  if (frequency.parameter || frequency.nominal != 0.0)
    force = T(cos(T(value_of<T>(frequency, parameters) * time))) * force;
  if (push_ && push_->start <= within && within <= push_->start + push_->duration) {
    // pi is rounded: the push that is meant ends at its duration by less than rounding shows.
    const T wave = sin(T(T(std::acos(-1.0) / push_->duration) * (time - T(push_->start))));
    force.x = force.x + T(push_->force) * square(wave);
  }
  return force;
}

template <class T>
std::vector<motion_details::PlanarLoad<T>> ControlledMotion::inertial_loads(
    std::span<const motion_details::PlanarMotion<T>> motion, std::span<const T> parameters) const {
  using namespace motion_details;
  std::vector<PlanarLoad<T>> loads;
  for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
    const Body& body = model_.model.bodies[model_.bodies[i].body];
    const PlanarMotion<T>& m = motion[i];
    const T mass = value_of<T>(body.mass, parameters);
    const PlanarVector<T> centre = planar<T>(body.centre_of_mass, parameters);
    const PlanarVector<T> first_moment = m.turned(mass * centre);
    const T inertia = value_of<T>(body.inertia[2], parameters) + mass * (square(centre.x) + square(centre.y));
    const T copies(model_.bodies[i].copies);
    loads.push_back({copies * (mass * m.acceleration + m.angular_acceleration * crossed(first_moment) -
                               square(m.angular_velocity) * first_moment),
                     copies * (inertia * m.angular_acceleration + moment(first_moment, m.acceleration))});
  }
  return loads;
}

template <class T>
void ControlledMotion::add_controllers(std::span<const T> state, MotionTerms<T>& terms) const {
  for (std::size_t j = 0; j < joints(); ++j) {
    const SagittalJoint& joint = model_.joints[j];
    const T error = state[position(j)] - T(joint.wanted);
    if (joint.proportional != 0.0) terms.residual[j] += T(joint.proportional) * error;
    if (joint.derivative != 0.0) terms.residual[j] += T(joint.derivative) * state[j];
    terms.rates.push_back(state[j]);
  }
  for (std::size_t i = 0; i < integrals_.size(); ++i) {
    const SagittalJoint& joint = model_.joints[integrals_[i]];
    terms.residual[integrals_[i]] += T(joint.integral) * state[integral(i)];
    terms.rates.push_back(state[position(integrals_[i])] - T(joint.wanted));
  }
}

template <class T>
MotionTerms<T> ControlledMotion::evaluate(std::span<const T> state, std::span<const T> acceleration, const T& time,
                                          const MotionRegime& regime, std::span<const T> deviations) const {
  using namespace motion_details;
  const Model& model = model_.model;
  const std::vector<T> values = parameters<T>(deviations);
  const std::span<const T> p(values);
  const std::vector<PlanarMotion<T>> motion = motions<T>(state, acceleration, p);
  MotionTerms<T> terms;
  terms.residual.assign(joints(), T(0));

  // What the bodies need to move so, less what acts on them, at their origins.
  std::vector<PlanarLoad<T>> loads = inertial_loads<T>(motion, p);
  for (std::size_t c = 0; c < model_.contacts.size(); ++c) {
    const std::size_t i = model_.contacts[c].body;
    const ContactCylinder& cylinder = model.cylinders[model_.contacts[c].cylinder];
    const PlanarMotion<T>& m = motion[i];
    const PlanarVector<T> middle = m.turned(planar<T>(cylinder.centre, p));
    const PlanarVector<T> lever{middle.x, middle.y - value_of<T>(cylinder.radius, p)};
    const PlanarVector<T> velocity = m.velocity + m.angular_velocity * crossed(lever);
    const ContactForce<T> force =
        contact_force<T>(cylinder, damping_[c], regime.contacts.empty() ? ContactBranches{} : regime.contacts[c], p,
                         T(m.origin.y + middle.y), T(-velocity.y), velocity.x, state[bristle(c)]);
    const T copies(model_.bodies[i].copies);
    const PlanarVector<T> on_body{copies * force.friction, copies * force.normal};
    loads[i].force = loads[i].force - on_body;
    loads[i].moment = loads[i].moment - moment(lever, on_body);
    terms.contacts.push_back(force);
  }
  // It acts at a point that only the root's translations carry along, -offset from the root's origin.
  const PlanarVector<T> applied = applied_force<T>(time, regime.within, p);
  const PlanarVector<T> point = planar<T>(model.bodies.front().offset, p);
  loads[0].force = loads[0].force - applied;
  loads[0].moment = loads[0].moment + moment(point, applied);

  for (std::size_t i = model_.bodies.size(); i-- > 0;) {
    const SagittalBody& body = model_.bodies[i];
    if (body.joint) terms.residual[*body.joint] = loads[i].moment;
    if (!body.parent) continue;
    PlanarLoad<T>& parent = loads[*body.parent];
    parent.force = parent.force + loads[i].force;
    parent.moment = parent.moment + loads[i].moment + moment(motion[i].from_parent, loads[i].force);
  }
  terms.residual[0] = loads[0].force.x;
  terms.residual[1] = loads[0].force.y;
  add_controllers(state, terms);
  for (const ContactForce<T>& contact : terms.contacts) terms.rates.push_back(contact.bristle_rate);
  return terms;
}

template <class T>
MotionRegime ControlledMotion::settled(const MotionTerms<T>& terms, double within) {
  const auto side = [](const T& x) {
    return certainly_less(T(0), x) ? Side::above : certainly_less(x, T(0)) ? Side::below : Side::open;
  };
  const auto friction = [](const T& trial, const T& limit) {
    if (certainly_less(limit, trial)) return FrictionBranch::slips_forward;
    if (certainly_less(trial, T(-limit))) return FrictionBranch::slips_backward;
    const bool sticks = certainly_less(T(-limit), trial) && certainly_less(trial, limit);
    return sticks ? FrictionBranch::sticks : FrictionBranch::open;
  };
  MotionRegime regime{within};
  for (const ContactForce<T>& contact : terms.contacts) {
    const ContactSwitches<T>& at = contact.switches;
    ContactBranches branches{side(at.penetration), side(at.damping)};
    if (!branches.in_flight()) branches.friction = friction(at.friction, at.limit);
    regime.contacts.push_back(branches);
  }
  return regime;
}

}  // namespace verisq::stance
