/// Newton's method on the stationarity equations: every unknown a logarithm, every term positive.
#include "tests/oracle/stationarity.hpp"

namespace verisq::oracle {

namespace {

constexpr int most_steps = 24;

const Real zero = 0;

}  // namespace

/// One coordinate's equation: residual F, and dF = along d(ln x) + force (dlnλ + d ln ∂g/∂x).
struct Stationarity::Equation {
  Real residual;
  Real along;
  Real force;
};

/// The derivative by the unknown that the equation eliminates. Inside it may vanish (a coordinate that is zero in q,
/// p = 2): then a stand-in that leaves the steps 100 correct bits.
Real Stationarity::pivot_of(const Equation& equation, const Real& slope) {
  const Real pivot = equation.along + equation.force * slope;
  const Real least = ldexp(Real(1), -100);
  return equation.along < 0 && abs(pivot) < least ? least : pivot;
}

Stationarity::Stationarity(const MixedNorm<Real>& norm, const Vector& q, Side side)
    : norm_(norm),
      q_(q),
      side_(side),
      outer_slope_(regularised(norm.outer().primal_minus_one)),
      inner_slope_(regularised(norm.inner().primal_minus_one)) {
  for (std::size_t i = 0; i < 3; ++i) {
    log_axes_[i] = log(norm.semi_axes()[i]);
    if (q_[i] > 0) log_q_[i] = log(q_[i]);
  }
}

Contact Stationarity::contact_at(const Vector& x, const std::array<bool, 3>& present) const {
  Vector scaled_logarithm;
  for (std::size_t i = 0; i < 3; ++i) {
    if (present[i]) scaled_logarithm[i] = log(x[i]) - log_axes_[i];
  }
  const Real tau_z = scaled_logarithm[2];
  const Real sigma = present[0] && present[1] ? Real(scaled_logarithm[1] - scaled_logarithm[0]) : zero;
  Real radius = zero;
  if (present[0] && present[1]) {
    const Real& p = norm_.inner().primal;
    radius = LogSum<Real>(p * scaled_logarithm[0], p * scaled_logarithm[1]).value / p;
  } else if (present[0] || present[1]) {
    radius = scaled_logarithm[present[0] ? 0 : 1];
  }
  return contact_at(tau_z - radius, sigma, present);
}

Contact Stationarity::contact_at(const Real& tau, const Real& sigma, const std::array<bool, 3>& present) const {
  const Real& p1 = norm_.outer().primal;
  const Real& p2 = norm_.inner().primal;
  Contact contact{present, {zero, zero}, zero, zero, zero};
  if (present[0] && present[1]) {
    contact.share[0] = -LogSum<Real>(zero, p2 * sigma).value / p2;
    contact.share[1] = -LogSum<Real>(-p2 * sigma, zero).value / p2;
  }
  if ((present[0] || present[1]) && present[2]) {
    contact.radius = -LogSum<Real>(zero, p1 * tau).value / p1;
    contact.height = -LogSum<Real>(-p1 * tau, zero).value / p1;
  }
  contact.multiplier = log(least_squares_multiplier(contact));
  return contact;
}

Vector Stationarity::point(const Contact& contact) const {
  Vector x{zero, zero, zero};
  for (std::size_t i = 0; i < 2; ++i) {
    if (contact.present[i]) x[i] = exp(contact.radius + contact.share[i] + log_axes_[i]);
  }
  if (contact.present[2]) x[2] = exp(contact.height + log_axes_[2]);
  return x;
}

Real Stationarity::least_squares_multiplier(const Contact& contact) const {
  const Vector x = point(contact);
  Vector normal{zero, zero, zero};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!contact.present[i]) continue;
    normal[i] = exp(outer_slope_ * contact.radius + inner_slope_ * contact.share[i] - log_axes_[i]);
  }
  if (contact.present[2]) normal[2] = exp(outer_slope_ * contact.height - log_axes_[2]);
  return abs(dot(difference(q_, x), normal)) / dot(normal, normal);
}

Stationarity::Equation Stationarity::linearised(std::size_t axis, const Contact& contact) const {
  const bool is_height = axis == 2;
  const Real log_x = (is_height ? contact.height : Real(contact.radius + contact.share[axis])) + log_axes_[axis];
  const Real log_normal = (is_height ? Real(outer_slope_ * contact.height)
                                     : Real(outer_slope_ * contact.radius + inner_slope_ * contact.share[axis])) -
                          log_axes_[axis];
  const Real log_force = contact.multiplier + log_normal;
  if (side_ == Side::outside) {
    const LogSum<Real> sum(log_x, log_force);
    return {sum.value - log_q_[axis], sum.share_of_first, sum.share_of_second};
  }
  if (q_[axis] == 0) return {log_force - log_x, Real(-1), Real(1)};
  const LogSum<Real> sum(log_q_[axis], log_force);
  return {sum.value - log_x, Real(-1), sum.share_of_second};
}

/// One of the two equations in (ln r, ln λ) that are left: by_radius d ln r + by_multiplier d lnλ = right.
struct Stationarity::Row {
  Real by_radius;
  Real by_multiplier;
  Real right;
  Real residual;  ///< of the norm itself
};

/// ‖(X/r, Y/r)‖ = 1, the logarithm of its p2-th power, with the shares eliminated by their equations.
Stationarity::Row Stationarity::section_row(const Contact& contact, const std::array<Equation, 3>& equations) const {
  const Real& p2 = norm_.inner().primal;
  std::array<Real, 2> part{contact.present[0] ? 1 : 0, contact.present[1] ? 1 : 0};
  Row row{zero, zero, zero, zero};
  if (contact.present[0] && contact.present[1]) {
    const LogSum<Real> sum(p2 * contact.share[0], p2 * contact.share[1]);
    part = {sum.share_of_first, sum.share_of_second};
    row.residual = sum.value;
  }
  row.right = row.residual / p2;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!contact.present[i]) continue;
    const Equation& e = equations[i];
    const Real weight = part[i] / pivot_of(e, inner_slope_);
    row.by_radius += weight * (e.along + e.force * outer_slope_);
    row.by_multiplier += weight * e.force;
    row.right -= weight * e.residual;
  }
  return row;
}

/// ‖(r, Z)‖ = 1, the logarithm of its p1-th power, with the height eliminated by its equation.
Stationarity::Row Stationarity::boundary_row(const Contact& contact, const Equation& vertical) const {
  if (!contact.present[2]) return {Real(1), zero, zero, zero};
  const Real& p1 = norm_.outer().primal;
  const bool section = contact.present[0] || contact.present[1];
  const LogSum<Real> sum(p1 * contact.radius, p1 * contact.height);
  const Real height_part = section ? sum.share_of_second : Real(1);
  const Real weight = height_part / pivot_of(vertical, outer_slope_);
  const Real residual = section ? sum.value : zero;
  return {section ? sum.share_of_first : zero, -weight * vertical.force, weight * vertical.residual - residual / p1,
          residual};
}

/// One step for all unknowns: the shares and the height are eliminated, a 2x2 system in (ln r, ln λ) is left, whose
/// determinant is outside a sum of terms of one sign. Returns the largest residual before the step.
Real Stationarity::newton_step(Contact& contact) const {
  std::array<Equation, 3> equations;
  Real largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!contact.present[i]) continue;
    equations[i] = linearised(i, contact);
    largest = std::max<Real>(largest, abs(equations[i].residual));
  }
  const Row section = section_row(contact, equations);
  const Row boundary = boundary_row(contact, equations[2]);
  largest = std::max({largest, Real(abs(section.residual)), Real(abs(boundary.residual))});

  const Real determinant = section.by_radius * boundary.by_multiplier - section.by_multiplier * boundary.by_radius;
  const Real radius_step =
      (section.right * boundary.by_multiplier - section.by_multiplier * boundary.right) / determinant;
  const Real multiplier_step = (section.by_radius * boundary.right - section.right * boundary.by_radius) / determinant;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!contact.present[0] || !contact.present[1]) break;  // a single share is 1
    const Equation& e = equations[i];
    contact.share[i] -= (e.residual + (e.along + e.force * outer_slope_) * radius_step + e.force * multiplier_step) /
                        pivot_of(e, inner_slope_);
  }
  if (contact.present[2]) {
    const Equation& e = equations[2];
    contact.height -= (e.residual + e.force * multiplier_step) / pivot_of(e, outer_slope_);
    contact.radius += radius_step;
  }
  contact.multiplier += multiplier_step;
  return largest;
}

std::optional<Contact> Stationarity::solve(Contact contact, const Real& tolerance) const {
  for (int step = 0; step < most_steps; ++step) {
    const Real residual = newton_step(contact);
    if (!isfinite(contact.multiplier) || !isfinite(contact.radius) || !isfinite(contact.height)) return std::nullopt;
    if (residual < tolerance) return contact;
  }
  return std::nullopt;
}

}  // namespace verisq::oracle
