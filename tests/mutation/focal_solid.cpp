/// This file implements the points that are known, and what is true of enclosures there.
#include "tests/mutation/focal_solid.hpp"

#include <cmath>
#include <cstddef>
#include <verisq/enclosure.hpp>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::mutation {
namespace {

using oracle::MixedNorm;
using oracle::RandomCases;
using oracle::Real;
using Vector = oracle::Vector;

constexpr double loose = 0x1p-24;
constexpr double loose_focus = 0x1p-20;  // seen beside that

}  // namespace

device::PrimitiveParameters loosened(device::PrimitiveParameters parameters) {
  parameters.fall_down *= 1.0 - loose;
  parameters.fall_up *= 1.0 + loose;
  parameters.taper_error += loose_focus;
  parameters.focus += std::copysign(0.98 * loose_focus, parameters.focus);
  return parameters;
}

device::BoxPrimitiveParameters with_wide_bounds(const Primitive& primitive) {
  device::BoxPrimitiveParameters parameters = device::box_primitive_parameters(primitive, 0);
  parameters.solid.fall_down *= 1.0 - 0x1p-20;
  parameters.solid.fall_up *= 1.0 + 0x1p-20;
  return parameters;
}

device::BoxPrimitiveParameters with_other_taper(Primitive primitive) {
  const auto coefficient = [](double ratio) { return (ratio - 1.0) / (ratio + 1.0); };
  const double k = coefficient(primitive.superquadric.taper);
  primitive.superquadric.taper *= 1.0 + 0x1p-20;
  device::BoxPrimitiveParameters parameters = device::box_primitive_parameters(primitive, 0);
  const auto& axes = primitive.superquadric.semi_axes;
  const double moved = coefficient(primitive.superquadric.taper);
  const double off = std::fabs(k - moved);
  const double magnitude = std::fabs(moved) + off;
  const double fall = 1.0 - magnitude * magnitude;
  const double error = off * (std::hypot(axes[0], axes[1]) * (1.0 + magnitude / fall) + axes[2] / fall + axes[2]);
  parameters.solid.taper_error += 1.01 * error;
  parameters.solid = loosened(parameters.solid);
  return parameters;
}

SurfacePoint at_direction(const Point& direction, const MixedNorm<Real>& norm) {
  const Vector x = oracle::widened(direction);
  const Vector u = oracle::scaled<Real>(x, 1 / norm.gauge(x));
  Vector n = norm.gradient({abs(u[0]), abs(u[1]), abs(u[2])}, Real(1));
  for (std::size_t i = 0; i < 3; ++i)
    if (u[i] < 0) n[i] = -n[i];
  return {u, n};
}

Point direction_of(RandomCases& random) {
  Point direction = random.direction();
  const std::size_t kind = random.choice(8);
  for (std::size_t i = 0; i < 3; ++i)
    if (kind < 3 && i != kind) direction[i] *= 0.01;
  if (kind == 3) direction[2] *= 1e-3;
  return direction;
}

Vector stepped(const Vector& from, const Vector& v, double apart) {
  const Vector step = oracle::scaled<Real>(v, Real(apart) / oracle::length<Real>(v));
  return {from[0] + step[0], from[1] + step[1], from[2] + step[2]};
}

bool proves(const Results& found, const Vector& q, const Vector& p) {
  const Vector v = oracle::widened({found[2], found[3], found[4]});
  if (!(std::isfinite(found[2]) && std::isfinite(found[3]) && std::isfinite(found[4]))) return found[0] == -infinity;
  return Real(found[0]) * oracle::length<Real>(v) <= oracle::dot<Real>(v, oracle::difference<Real>(q, p));
}

/// A query outside of a convex set at p, where `v` is normal.
bool encloses(const Results& found, const Vector& q, const Vector& p, const Vector& v) {
  const Vector apart = oracle::difference<Real>(q, p);
  const Real lower = oracle::dot<Real>(apart, v) / oracle::length<Real>(v);
  const Real upper = lower > 0 ? oracle::length<Real>(apart) : Real(0);
  return found[0] <= found[1] && Real(found[0]) <= upper && Real(found[1]) >= lower && proves(found, q, p);
}

}  // namespace verisq::mutation
