/// The equations of a point's orthogonal projection onto the surface of a superquadric, for Krawczyk's operator.
#pragma once

#include <stdexcept>

#include "verify/analysis/krawczyk.hpp"
#include "verify/analysis/norm_expansion.hpp"

namespace verisq::verify {

/// In the unknowns (p, λ) of the solid's own frame: p - q = λ Dg(p), g(p) = 1. With λ > 0 the point q lies beneath the
/// surface along its normal at p, with λ < 0 above it; both |p - q| and |λ| |Dg(p)| are the distance. The nearest point
/// p of the surface is a zero wherever g is differentiable at it: outside by the rule of multipliers, inside because
/// the ball about q touches the surface there, so that the only supporting plane is the ball's.
class ProjectionEquations {
 public:
  ProjectionEquations(const Superquadric& solid, const PreciseVector& q)
      : gauge_(NormFunction<PreciseInterval>::gauge(solid)),
        has_flat_faces_(solid.exponents[0] == 2.0 || solid.exponents[1] == 2.0),
        q_(q) {}

  /// g and its derivatives over a box. Throws std::domain_error where they are not defined on all of it. Between its
  /// planes of symmetry the gauge with an exponent p = 1 is smooth, and the formula of its Hessian does not tell that
  /// it has a kink in them.
  [[nodiscard]] NormExpansion<PreciseInterval> gauge(const PreciseVector& p) const {
    for (std::size_t k = 0; k < 3 && has_flat_faces_; ++k) {
      if (!(p[k].lower() > Real(0)) && !(p[k].upper() < Real(0))) throw std::domain_error("gauge: an edge");
    }
    return gauge_(p);
  }

  [[nodiscard]] SystemExpansion<4> operator()(const IntervalVector<4>& unknowns) const {
    const PreciseVector p = three_of(unknowns);
    const PreciseInterval& multiplier = unknowns[3];
    const NormExpansion<PreciseInterval> g = gauge(p);
    SystemExpansion<4> f;
    f.value.head<3>() = block(p - q_ - g.gradient * multiplier);
    f.value[3] = g.value - PreciseInterval(1);
    f.jacobian.topLeftCorner<3, 3>() = block(PreciseMatrix::identity() + -(g.hessian * multiplier));
    f.jacobian.topRightCorner<3, 1>() = block(-g.gradient);
    f.jacobian.bottomLeftCorner<1, 3>() = block(g.gradient).transpose();
    f.jacobian(3, 3) = PreciseInterval(0);
    return f;
  }

 private:
  NormFunction<PreciseInterval> gauge_;
  bool has_flat_faces_;
  PreciseVector q_;
};

}  // namespace verisq::verify
