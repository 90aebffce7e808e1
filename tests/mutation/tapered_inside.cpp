/// Rays from the origin to the surface, and the test of docs/mathematics.md §18 about the focus.
#include "tests/mutation/tapered_inside.hpp"

#include "tests/oracle/mixed_norm.hpp"

namespace verisq::mutation {
namespace {

using oracle::Real;
using Vector = oracle::Vector;

Real exact_taper(const Superquadric& solid) {
  return (Real(solid.taper) - 1) / (Real(solid.taper) + 1);
}

}  // namespace

std::vector<Point> just_inside_tapered(const Superquadric& solid, const Point& centre, std::size_t count,
                                       oracle::RandomCases& random) {
  const oracle::MixedNorm<Real> norm(solid);
  const Real k = exact_taper(solid);
  const Real height(solid.semi_axes[2]);
  const auto contains = [&](const Point& x) {
    const Vector w{Real(x[0]) - centre[0], Real(x[1]) - centre[1], Real(x[2]) - centre[2] + k * height};
    return norm.gauge(w) < 1 - k * k + k * w[2] / height;
  };
  std::vector<Point> points;
  while (points.size() < count) {
    const Vector direction = oracle::widened(random.direction());
    const Vector u = oracle::scaled<Real>(direction, 1 / norm.gauge(direction));
    const Real shrunk = 1 - Real(random.log_uniform(1e-15, 1e-9));
    const Vector w = oracle::scaled<Real>(u, shrunk * (1 - k * k) / (1 - k * u[2] / height));
    const Point x = oracle::rounded({w[0] + centre[0], w[1] + centre[1], w[2] - k * height + centre[2]});
    if (contains(x)) points.push_back(x);
  }
  return points;
}

}  // namespace verisq::mutation
