/// The program of two solids, and what each point of its central path proves.
#include "tests/oracle/pair_reference.hpp"

#include "tests/oracle/closest_pair.hpp"
#include "tests/oracle/solid_point.hpp"

namespace verisq::oracle {

namespace {

template <class Number>
[[nodiscard]] DistanceProgram<Number> program(const PosedSolid& a, const PosedSolid& b) {
  DistanceProgram<Number> result;
  result.origin = converted<Number>(difference(b.centre(), a.centre()));
  result.add_superquadric(a.superquadric().exponents, solid_axes<Number>(a, Number(-1)));
  result.add_superquadric(b.superquadric().exponents, solid_axes<Number>(b, Number(1)));
  return result;
}

constexpr std::size_t first_of_b = DistanceProgram<Real>::variables_of_superquadric;

/// Is the boundary flat to more than second order, or nearly, where its normal is v? With an exponent p > 2 it is where
/// the coordinate's share of the normal vanishes.
[[nodiscard]] bool flat_towards(const PosedSolid& solid, const Vector& v) {
  const Real nearly = 1e-6;
  const MixedNorm<Real>& norm = solid.norm();
  const Vector local = solid.turned_to_own_frame(v);
  Vector share;
  for (std::size_t i = 0; i < 3; ++i) share[i] = abs(local[i]) * norm.semi_axes()[i];
  const Real section = norm.support({local[0], local[1], Real(0)});
  const bool flat_section = std::min(share[0], share[1]) < nearly * section;
  const bool flat_profile = std::min(section, share[2]) < nearly * std::max(section, share[2]);
  return (norm.inner().primal > 2 && flat_section) || (norm.outer().primal > 2 && flat_profile);
}

class PairProof {
 public:
  PairProof(const PosedSolid& a, const PosedSolid& b)
      : a_(a),
        b_(b),
        rounding_(rounding_at_200_bits(a) + rounding_at_200_bits(b)),
        goal_(std::max(a.largest_semi_axis(), b.largest_semi_axis()) * Real(1e-27)),
        best_{Real(0), length(difference(b.centre(), a.centre())) + rounding_, a.centre(), b.centre(), {}, {}} {}

  [[nodiscard]] bool add(const PathPoint& point) {
    const Vector on_a = solid_point(a_, point.variables, 0);
    const Vector on_b = solid_point(b_, point.variables, first_of_b);
    const Vector middle = scaled<Real>(difference(on_a, scaled<Real>(on_b, Real(-1))), Real(0.5));
    if (contains(a_, middle) && contains(b_, middle)) {
      best_ = {Real(0), Real(0), middle, middle, Real(0), middle};
      return true;
    }
    const Vector v = difference(on_b, on_a);
    const Real distance = length(v);
    if (distance + rounding_ < best_.upper) {
      best_.upper = distance + rounding_;
      best_.on_a = on_a;
      best_.on_b = on_b;
      best_.reach.reset();
      if (!flat_towards(a_, v) && !flat_towards(b_, v)) {
        best_.reach = std::max(reach(a_, point.outstanding, 0), reach(b_, point.outstanding, first_of_b));
      }
    }
    if (distance > 0) {
      const Real between_centres = dot(v, difference(b_.centre(), a_.centre()));
      const Real lower = (between_centres - support(a_, v) - support(b_, v)) / distance;
      best_.lower = std::max<Real>(best_.lower, lower - rounding_);
    }
    return best_.upper - best_.lower <= goal_ + 2 * rounding_;
  }

  [[nodiscard]] const PairReference& best() const { return best_; }

 private:
  const PosedSolid& a_;
  const PosedSolid& b_;
  Real rounding_;
  Real goal_;
  PairReference best_;
};

}  // namespace

PairReference reference_distance(const PosedSolid& a, const PosedSolid& b) {
  PairProof proof(a, b);
  follow_path({program<double>(a, b), program<Real>(a, b)}, std::max(a.largest_semi_axis(), b.largest_semi_axis()),
              [&](const PathPoint& point) { return proof.add(point); });
  return proof.best();
}

}  // namespace verisq::oracle
