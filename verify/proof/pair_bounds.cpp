/// The two proofs of docs/mathematics.md §7.
#include "verify/proof/pair_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// x / max(1, g(x)), with g rounded up: the gauge of the result is at most 1.
PreciseVector moved_into(const SuperquadricBounds<Real>& solid, const PreciseVector& x) {
  const Real gauge = solid.gauge_up(x);
  return gauge > Real(1) ? PreciseVector(x / PreciseInterval(gauge)) : x;
}

}  // namespace

Real PairBounds::lower_by_vector(const PreciseVector& v) const {
  const PreciseVector w = relative_.rotation.transpose() * v;
  const PreciseInterval supports =
      PreciseInterval(a_->bounds().support_up(v)) + PreciseInterval(b_->bounds().support_up(-w));
  const PreciseInterval gap = v.dot(relative_.translation) - supports;
  return (gap / length<Real>(v)).lower();
}

Real PairBounds::upper_by_points(const PreciseVector& on_a, const PreciseVector& on_b) const {
  const PreciseVector a = moved_into(a_->bounds(), on_a);
  const PreciseVector b = relative_(moved_into(b_->bounds(), on_b));
  return length<Real>(PreciseVector(b - a)).upper();
}

Enclosure PairBounds::distance(const Separation& separation) const {
  const auto& [primitive_a, primitive_b, vector, on_a, on_b] = separation;
  const bool direction = usable({vector[0], vector[1], vector[2]});
  const auto finite = [](const Point& x) { return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]); };
  const bool points = finite(on_a) && finite(on_b);
  return {direction ? lower_by_vector(precise(vector)).to_double(Direction::down) : -infinity,
          points ? upper_by_points(precise(on_a), precise(on_b)).to_double(Direction::up) : infinity};
}

}  // namespace verisq::verify
