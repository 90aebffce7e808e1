/// The exact inverses of bend and taper, and margins for the rounding.
#include "tests/oracle/exact_membership.hpp"

#include <boost/math/constants/constants.hpp>
#include <optional>

namespace verisq::oracle {

namespace {

/// 1595 bits: 1 - kR keeps 500 of them of R for the smallest k that binary64 has.
using WideReal =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<480, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

/// The point (r, s, z) that the bend moves to `bent`: with rho = 1/k - r, the forward formula says 1 - kR = k rho cos
/// kz and kZ = k rho sin kz, where k rho = 1 - kr > 0 in the solid. Empty beside the centre of curvature, which is
/// outside.
template <class Number>
[[nodiscard]] std::optional<Vector> unbent(const Vector& bent, const Bend& bend) {
  const Number k = bend.curvature;
  const Number angle = Number(bend.angle_degrees) * boost::math::constants::pi<Number>() / 180;
  const Number c = cos(angle);
  const Number s = sin(angle);
  const Number& x = bent[0];
  const Number& y = bent[1];
  const Number R = x * c + y * s;
  const Number across = y * c - x * s;
  const Number m = 1 - k * R;
  const Number n = k * Number(bent[2]);
  const Number scaled_radius = sqrt(m * m + n * n);
  if (scaled_radius < ldexp(Number(1), -30)) return std::nullopt;
  const Number r = (1 - scaled_radius) / k;
  const Number z = atan2(n, m) / k;
  return Vector{Real(r * c - across * s), Real(r * s + across * c), Real(z)};
}

}  // namespace

ExactMembership::ExactMembership(const Model& model) : model_(model) {
  for (const Primitive& primitive : model.primitives) {
    parts_.push_back({PosedSolid(primitive.superquadric, primitive.pose), primitive.bend.value_or(Bend{0.0, 0.0})});
  }
}

Membership ExactMembership::in_primitive(std::size_t index, const Vector& point) const {
  const auto& [solid, bend] = parts_[index];
  Vector local = solid.to_own_frame(point);
  if (bend.curvature != 0.0) {
    // Above 2^-40, 201 bits leave 160 of the local point.
    const bool is_tiny = abs(bend.curvature * solid.largest_semi_axis()) < ldexp(Real(1), -40);
    const std::optional<Vector> straight = is_tiny ? unbent<WideReal>(local, bend) : unbent<Real>(local, bend);
    if (!straight) return Membership::outside;
    local = *straight;
  }
  const Vector& axes = solid.norm().semi_axes();
  if (is_tapered(model_.primitives[index].superquadric)) {
    const Real ratio = model_.primitives[index].superquadric.taper;
    const Real k = (ratio - 1) / (ratio + 1);
    const Real scale = 1 + k * local[2] / axes[2];
    if (abs(local[2]) > (1 + ldexp(Real(1), -20)) * axes[2]) return Membership::outside;
    local = {local[0] / scale, local[1] / scale, (local[2] + k * axes[2]) / scale};
  }
  const Real magnitude = length(point) + length(solid.centre()) + solid.largest_semi_axis();
  const Real margin = ldexp(magnitude / *std::min_element(axes.begin(), axes.end()), -120);
  const Real gauge = solid.norm().gauge(local);
  if (gauge > 1 + margin) return Membership::outside;
  return gauge < 1 - margin ? Membership::inside : Membership::boundary;
}

Membership ExactMembership::operator()(const Vector& point) const {
  return membership(model_, [&](std::size_t i) { return in_primitive(i, point); });
}

}  // namespace verisq::oracle
