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

/// One step for all unknowns: the shares and the height are eliminated, a 2x2 system in (ln r, ln λ) is left. Outside
/// every sum below is of nonnegative terms. Returns the largest residual before the step.
Real Stationarity::newton_step(Contact& contact) const {
  const Real& p1 = norm_.outer().primal;
  const Real& p2 = norm_.inner().primal;
  const bool section = contact.present[0] || contact.present[1];
  Real largest = 0;
  const auto note = [&largest](const Real& residual) { largest = std::max<Real>(largest, abs(residual)); };

  // ‖(X/r, Y/r)‖ = 1, logarithm of its p2-th power.
  std::array<Real, 2> part{zero, zero};
  Real share_residual = 0;
  if (contact.present[0] && contact.present[1]) {
    const LogSum<Real> sum(p2 * contact.share[0], p2 * contact.share[1]);
    part = {sum.share_of_first, sum.share_of_second};
    share_residual = sum.value;
  } else if (section) {
    part[contact.present[0] ? 0 : 1] = 1;
  }
  note(share_residual);

  std::array<Equation, 2> planar;
  Real by_radius = 0;
  Real by_multiplier = 0;
  Real right_share = share_residual / p2;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!contact.present[i]) continue;
    planar[i] = linearised(i, contact);
    note(planar[i].residual);
    const Real pivot = pivot_of(planar[i], inner_slope_);
    by_radius += part[i] * (planar[i].along + planar[i].force * outer_slope_) / pivot;
    by_multiplier += part[i] * planar[i].force / pivot;
    right_share -= part[i] * planar[i].residual / pivot;
  }

  // ‖(r, Z)‖ = 1, logarithm of its p1-th power.
  Real radius_part = section ? 1 : 0;
  Real height_part = contact.present[2] ? 1 : 0;
  Real boundary_residual = 0;
  if (section && contact.present[2]) {
    const LogSum<Real> sum(p1 * contact.radius, p1 * contact.height);
    radius_part = sum.share_of_first;
    height_part = sum.share_of_second;
    boundary_residual = sum.value;
  }
  note(boundary_residual);

  Equation vertical{zero, zero, zero};
  Real vertical_pivot = 1;
  if (contact.present[2]) {
    vertical = linearised(2, contact);
    note(vertical.residual);
    vertical_pivot = pivot_of(vertical, outer_slope_);
  }
  const Real height_by_multiplier = height_part * vertical.force / vertical_pivot;
  const Real right_boundary = -boundary_residual / p1 + height_part * vertical.residual / vertical_pivot;

  const Real determinant = by_radius * height_by_multiplier + by_multiplier * radius_part;
  const Real radius_step = (right_share * height_by_multiplier + by_multiplier * right_boundary) / determinant;
  const Real multiplier_step = (radius_part * right_share - by_radius * right_boundary) / determinant;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!contact.present[i] || !(contact.present[0] && contact.present[1])) continue;
    const Equation& e = planar[i];
    contact.share[i] -= (e.residual + (e.along + e.force * outer_slope_) * radius_step + e.force * multiplier_step) /
                        pivot_of(e, inner_slope_);
  }
  if (contact.present[2] && section) {
    contact.height -= (vertical.residual + vertical.force * multiplier_step) / vertical_pivot;
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
