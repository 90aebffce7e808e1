/// Corners in and beyond a plane; a quaternion that turns one normal against another.
#include "tests/oracle/tapered_queries.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/oracle/tapered_contact.hpp"

namespace verisq::oracle {

namespace {

using Quaternion = std::array<Real, 4>;

double log_uniform(std::mt19937_64& random, double from, double to) {
  return std::exp(std::uniform_real_distribution(std::log(from), std::log(to))(random));
}

Triple<double> random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

Vector sum(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Quaternion product(const Quaternion& p, const Quaternion& q) {
  const Vector u{p[1], p[2], p[3]};
  const Vector v{q[1], q[2], q[3]};
  const Vector w = sum(sum(scaled<Real>(v, p[0]), scaled<Real>(u, q[0])), cross(u, v));
  return {p[0] * q[0] - dot(u, v), w[0], w[1], w[2]};
}

/// Turns the unit vector `from` to the unit vector `to`, then about it by a random angle.
std::array<double, 4> random_turn(std::mt19937_64& random, const Vector& from, const Vector& to) {
  const Vector axis = cross(from, to);
  const Quaternion shortest{1 + dot(from, to), axis[0], axis[1], axis[2]};
  const double half = std::uniform_real_distribution(0.0, std::numbers::pi)(random);
  const Vector about = scaled<Real>(to, Real(std::sin(half)));
  const Quaternion turn = product({Real(std::cos(half)), about[0], about[1], about[2]}, shortest);
  const Real size = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
  std::array<double, 4> result{};
  for (std::size_t i = 0; i < 4; ++i) result[i] = static_cast<double>(Real(turn[i] / size));
  return result;
}

double largest_axis(const Primitive& primitive) {
  return std::ranges::max(primitive.superquadric.semi_axes);
}

/// Where the nearest point lies: the weights of the corners.
Triple<double> random_weights(std::mt19937_64& random) {
  const auto share = [&] { return std::uniform_real_distribution(0.05, 1.0)(random); };
  switch (std::uniform_int_distribution(0, 3)(random)) {
    case 0: return {1.0, 0.0, 0.0};
    case 1: {
      const double w = std::uniform_real_distribution(0.05, 0.95)(random);
      return {w, 1.0 - w, 0.0};
    }
    default: {
      const Triple<double> w{share(), share(), share()};
      const double all = w[0] + w[1] + w[2];
      return {w[0] / all, w[1] / all, w[2] / all};
    }
  }
}

}  // namespace

KnownTriangle random_known_triangle(std::mt19937_64& random, const Primitive& primitive, double apart) {
  const TaperedSolid solid(primitive);
  const auto [point, normal] = solid.surface(random_direction(random));
  const Vector nearest = sum(point, scaled<Real>(normal, Real(apart)));
  const Triple<double> weights = random_weights(random);
  std::array<Vector, 3> offsets;
  for (std::size_t i = 0; i < 3; ++i) {
    const double reach = largest_axis(primitive) * log_uniform(random, 1e-3, 10.0);
    const Vector across = cross(normal, widened(random_direction(random)));
    const double beyond = weights[i] > 0.0 ? 0.0 : std::uniform_real_distribution(0.01, 1.0)(random);
    offsets[i] = scaled<Real>(sum(across, scaled<Real>(normal, Real(beyond))), Real(reach));
  }
  // The last corner with a weight makes up for the others.
  const std::size_t last = weights[2] > 0.0 ? 2 : weights[1] > 0.0 ? 1 : 0;
  offsets[last] = {};
  for (std::size_t i = 0; i < last; ++i)
    offsets[last] = difference(offsets[last], scaled<Real>(offsets[i], Real(weights[i]) / Real(weights[last])));
  KnownTriangle result;
  Vector on_triangle{};
  const Real all = Real(weights[0]) + Real(weights[1]) + Real(weights[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    result.triangle[i] = rounded(sum(nearest, offsets[i]));
    const Vector corner = widened(result.triangle[i]);
    on_triangle = sum(on_triangle, scaled<Real>(corner, Real(weights[i]) / all));
    const Real height = dot(normal, difference(corner, point));
    result.lower = i == 0 ? height : std::min(result.lower, height);
  }
  result.lower = std::max(result.lower, Real(0));
  result.upper = solid.contains(on_triangle) ? Real(0) : length(difference(on_triangle, point));
  std::ranges::shuffle(result.triangle, random);
  return result;
}

KnownPair random_known_pair(std::mt19937_64& random, double largest_ratio, double apart) {
  KnownPair result{random_tapered(random, largest_ratio), random_tapered(random, largest_ratio), {}, {}};
  auto& [a, b, lower, upper] = result;
  if (std::bernoulli_distribution(0.7)(random)) {  // of about the same size
    const double scale = largest_axis(a) / largest_axis(b) * log_uniform(random, 0.1, 10.0);
    for (double& axis : b.superquadric.semi_axes) axis *= scale;
  }
  const TaperedSolid solid_a(a);
  const auto [on_a, normal_a] = solid_a.surface(random_direction(random));
  const Triple<double> direction = random_direction(random);
  b.pose = {};
  b.pose.quaternion = random_turn(random, TaperedSolid(b).surface(direction).normal, scaled<Real>(normal_a, Real(-1)));
  const Real step = Real(apart) * std::max(largest_axis(a), largest_axis(b));
  const Vector target = sum(on_a, scaled<Real>(normal_a, step));
  b.pose.translation = rounded(difference(target, TaperedSolid(b).surface(direction).point));

  const TaperedSolid solid_b(b);
  const auto [on_b, normal_b] = solid_b.surface(direction);
  // No point b' of B has n_A·b' < n_A·b - |n_A + n_B| |b' - b|, because n_B·b' <= n_B·b.
  const Real gap = dot(normal_a, difference(on_b, on_a)) - length(sum(normal_a, normal_b)) * solid_b.diameter_up();
  lower = std::max(gap, Real(0));
  const bool common = solid_a.contains(on_b) || solid_b.contains(on_a);
  upper = common ? Real(0) : length(difference(on_b, on_a));
  return result;
}

}  // namespace verisq::oracle
