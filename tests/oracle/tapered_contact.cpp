/// The map, its derivative on the normal, random solids.
#include "tests/oracle/tapered_contact.hpp"

#include <cmath>

namespace verisq::oracle {

namespace {

Superquadric untapered(const Superquadric& solid) {
  return {solid.semi_axes, solid.exponents};
}

Triple<Real> magnitudes(const Vector& v) {
  using std::abs;
  return {abs(v[0]), abs(v[1]), abs(v[2])};
}

double log_uniform(std::mt19937_64& random, double from, double to) {
  return std::exp(std::uniform_real_distribution(std::log(from), std::log(to))(random));
}

/// Also the ends of what is allowed.
double exponent(std::mt19937_64& random) {
  switch (std::uniform_int_distribution(0, 7)(random)) {
    case 0: return 1.0;
    case 1: return 2.0;
    case 2: return log_uniform(random, 0.01, 0.1);
    default: return std::uniform_real_distribution(0.1, 2.0)(random);
  }
}

}  // namespace

TaperedSolid::TaperedSolid(const Primitive& primitive)
    : posed_(untapered(primitive.superquadric), primitive.pose),
      k_((Real(primitive.superquadric.taper) - 1) / (Real(primitive.superquadric.taper) + 1)),
      height_(primitive.superquadric.semi_axes[2]) {}

bool TaperedSolid::contains_own(const Vector& own) const {
  using std::abs;
  const Real scale = 1 + k_ * own[2] / height_;
  if (abs(own[2]) > height_) return false;
  return posed_.norm().gauge({own[0] / scale, own[1] / scale, (own[2] + k_ * height_) / scale}) <= 1;
}

SurfacePoint TaperedSolid::own_surface(const Triple<double>& direction) const {
  const MixedNorm<Real>& norm = posed_.norm();
  const Vector u = widened(direction);
  const Vector x = scaled<Real>(u, 1 / norm.gauge(u));
  Vector n = norm.gradient(magnitudes(x), Real(1));
  for (std::size_t i = 0; i < 3; ++i) n[i] = x[i] < 0 ? Real(-n[i]) : n[i];

  const Real z = (x[2] - k_ * height_) / (1 - k_ * x[2] / height_);
  const Real scale = 1 + k_ * z / height_;
  const Vector surface{scale * x[0], scale * x[1], z};
  // Of the composition with the inverse, (x, y, z) -> (x / s, y / s, (z + k a3) / s), s = 1 + k z / a3.
  const Real fall = (n[0] * surface[0] + n[1] * surface[1]) * k_ / height_ / (scale * scale);
  const Vector normal{n[0] / scale, n[1] / scale, n[2] * (1 - k_ * k_) / (scale * scale) - fall};
  return {surface, normal};
}

SurfacePoint TaperedSolid::surface(const Triple<double>& direction) const {
  const auto [point, normal] = own_surface(direction);
  const Vector tip = posed_.from_own_frame(scaled<Real>(normal, 1 / length(normal)));
  return {posed_.from_own_frame(point), difference(tip, posed_.centre())};
}

Real TaperedSolid::diameter_up() const {
  using std::abs;
  const Triple<Real>& axes = posed_.norm().semi_axes();
  const Real widest = 1 + abs(k_);
  return 2 * length(Vector{widest * axes[0], widest * axes[1], axes[2]});
}

KnownContact TaperedSolid::contact(const Triple<double>& direction, double apart) const {
  const auto [surface, normal] = own_surface(direction);
  const Vector step = scaled<Real>(normal, Real(apart) / length(normal));
  const Vector ideal{surface[0] + step[0], surface[1] + step[1], surface[2] + step[2]};
  const Point query = rounded(posed_.from_own_frame(ideal));
  const Vector q = posed_.to_own_frame(widened(query));  // of the rounded one
  const Vector from_surface = difference(q, surface);
  const Real lower = dot(from_surface, normal) / length(normal);
  return {query, lower, contains_own(q) ? Real(0) : length(from_surface)};
}

Primitive random_tapered(std::mt19937_64& random, double largest_ratio) {
  std::normal_distribution<double> normal;
  const double size = log_uniform(random, 1e-3, 1e3);
  const auto axis = [&] { return size * log_uniform(random, 0.05, 1.0); };
  const double ratio = log_uniform(random, 1.0, largest_ratio);
  const bool upper = std::bernoulli_distribution()(random);
  Primitive result{"tapered", {{axis(), axis(), axis()}, {exponent(random), exponent(random)}}, {}};
  result.superquadric.taper = upper ? ratio : 1.0 / ratio;
  for (double& t : result.pose.translation) t = size * normal(random);
  for (double& c : result.pose.quaternion) c = normal(random);
  return result;
}

}  // namespace verisq::oracle
