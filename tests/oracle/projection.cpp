/// The closest point by Newton's method at 200 bits, and the two evaluations that prove its distance.
#include "tests/oracle/projection.hpp"

#include <algorithm>

#include "tests/oracle/nested_projection.hpp"
#include "tests/oracle/stationarity.hpp"

namespace verisq::oracle {

namespace {

/// The best bounds of all candidates for the closest point.
class DualityGap {
 public:
  DualityGap(const MixedNorm<Real>& norm, const Vector& q)
      : norm_(norm),
        q_(q),
        goal_(ldexp(std::max(length(q), norm.semi_axes()[0]), -150)),
        best_{{Real(0), length(q)}, {}} {}

  /// Any x != 0 and the two directions it suggests, its normal and its offset from q, give valid bounds.
  void add(const Vector& x) {
    const Real gauge = norm_.gauge(x);
    if (!isfinite(gauge) || gauge <= 0) return;
    const Vector body_point = gauge > 1 ? scaled<Real>(x, 1 / gauge) : x;
    const Vector offset = difference(q_, body_point);
    const Real upper = length(offset);
    if (upper < best_.distance.upper) {
      best_.distance.upper = upper;
      best_.point = body_point;
    }
    add_direction(offset);
    if (!closed()) add_direction(norm_.gradient(x, gauge));
  }

  [[nodiscard]] bool closed() const { return best_.distance.upper - best_.distance.lower <= goal_; }
  [[nodiscard]] const ProjectedPoint& best() const { return best_; }

 private:
  void add_direction(const Vector& v) {
    const Real norm = length(v);
    if (norm == 0) return;
    best_.distance.lower = std::max<Real>(best_.distance.lower, (dot(v, q_) - norm_.support(v)) / norm);
  }

  const MixedNorm<Real>& norm_;
  const Vector& q_;
  Real goal_;
  ProjectedPoint best_;  // at first the centre
};

/// Runs Newton from `start` to two accuracies: the first is nearly always enough.
void add_solution(DualityGap& gap, const Stationarity& stationarity, const Contact& start) {
  for (const int bits : {60, 120}) {
    const std::optional<Contact> contact = stationarity.solve(start, ldexp(Real(1), -bits));
    if (!contact) return;
    gap.add(stationarity.point(*contact));
    if (gap.closed()) return;
  }
}

[[nodiscard]] std::size_t count(const std::array<bool, 3>& present) {
  return static_cast<std::size_t>(std::ranges::count(present, true));
}

}  // namespace

ProjectedPoint project_from_outside(const Superquadric& superquadric, const MixedNorm<Real>& norm, const Vector& q) {
  const std::array<bool, 3> present{q[0] > 0, q[1] > 0, q[2] > 0};
  DualityGap gap(norm, q);
  const Vector radial = scaled<Real>(q, 1 / norm.gauge(q));
  // On an axis the tip is the closest point, by symmetry.
  if (count(present) == 1) {
    gap.add(radial);
    return gap.best();
  }
  const Stationarity stationarity(norm, q, Side::outside);

  if (present[0] || present[1]) {
    const MixedNorm<double> rough(superquadric);
    NestedProjection<double> search(rough, rounded(q), 1e-15);
    const ContactAngles<double> angles = search.solve();
    add_solution(gap, stationarity, stationarity.contact_at(Real(angles.tau), Real(angles.sigma), present));
  }
  if (!gap.closed()) add_solution(gap, stationarity, stationarity.contact_at(radial, present));
  if (!gap.closed()) {
    NestedProjection<Real> search(norm, q, ldexp(Real(1), -100));
    const ContactAngles<Real> angles = search.solve();
    const Contact contact = stationarity.contact_at(angles.tau, angles.sigma, present);
    gap.add(stationarity.point(contact));
    if (!gap.closed()) add_solution(gap, stationarity, contact);
  }
  return gap.best();
}

}  // namespace verisq::oracle
