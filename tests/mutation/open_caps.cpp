/// This file implements the choice of such caps: about directions where the way out is short, and about any.
#include "tests/mutation/open_caps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace verisq::mutation {
namespace {

constexpr int tries = 48;  // directions of a cap in which the way out is measured

Vector unit(const Vector& v) {
  return scaled(v, 1.0L / length(v));
}

Vector positive(const Vector& v) {
  return {std::max(v[0], 0.0L), std::max(v[1], 0.0L), std::max(v[2], 0.0L)};
}

Point rounded(const Vector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

// Direction -> normal where its way leaves the solid.
Vector normal_beyond(const Vector& q, const Vector& w, const Norm& norm) {
  const Vector exit = along(q, way_out(q, w, norm), unit(w));
  return unit(norm.gradient(exit, norm.gauge(exit)));
}

Vector direction_near(const Vector& n, Extended size, oracle::RandomCases& random) {
  for (;;) {
    const Vector w = unit(positive(along(n, 2.0L * size * random.uniform(0.0, 1.0), extended(random.direction()))));
    if (length(along(w, -1.0L, n)) <= 0.999999L * size) return w;
  }
}

// The second derivative of g^p1 along e at x, for |e| = 1.
Extended second_derivative(const Vector& x, const Vector& e, const Norm& norm) {
  const Extended p1 = norm.outer().primal;
  const Extended p2 = norm.inner().primal;
  const auto& axes = norm.semi_axes();
  const auto section = oracle::planar_norm<Extended>(x[0] / axes[0], x[1] / axes[1], p2);
  const Extended share = std::pow(x[0] / axes[0] / section, p2);
  const Vector relative{e[0] / x[0], e[1] / x[1], e[2] / x[2]};
  const Extended mean = share * relative[0] + (1.0L - share) * relative[1];
  const Extended apart = relative[0] - relative[1];
  const Extended of_section = (p1 - 1.0L) * mean * mean + (p2 - 1.0L) * share * (1.0L - share) * apart * apart;
  return p1 *
         (std::pow(section, p1) * of_section + (p1 - 1.0L) * std::pow(x[2] / axes[2], p1) * relative[2] * relative[2]);
}

// The greatest on the ways from q + d to the directions, as far as they are in the solid.
Extended greatest_bend(const Vector& q, const Vector& d, const std::vector<Vector>& directions, const Norm& norm) {
  Extended greatest = 0.0L;
  for (const Vector& w : directions) {
    const Vector e = along(scaled(w, length(d)), -1.0L, d);
    for (const Extended part : {0.0L, 0.3L, 0.6L, 0.999L}) {
      const Vector x = along(along(q, 1.0L, d), part, e);
      if (norm.gauge(x) > 1.0L) break;
      greatest = std::max(greatest, second_derivative(x, scaled(e, 1.0L / length(e)), norm));
    }
  }
  return greatest;
}

}  // namespace

const char* const open_caps_kernel = R"(
kernel void open_caps(ulong groups, global const double* operands, ulong stride, constant const superquadric* s,
                      global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 q = {LOAD(group, operands), LOAD(group, operands + stride), LOAD(group, operands + 2 * stride)};
  const vector3 n = {LOAD(group, operands + 3 * stride), LOAD(group, operands + 4 * stride),
                     LOAD(group, operands + 5 * stride)};
  const real size = LOAD(group, operands + 6 * stride);
  const real t = LOAD(group, operands + 7 * stride);
  const cap_axis axis = cap_axis_along(q, t, n, s);
  STORE(TO_REAL(contains_cap(axis, size, s)), group, results);
  STORE(cap_cosine(q, t, n, INTEGER(-1), s), group, results + stride);
  STORE(select(REAL(INFINITY), cap_bend_up(axis, size, s), MASK(axis.needed < INFINITY)), group, results + 2 * stride);
}
)";

OpenCap open_cap(oracle::RandomCases& random, const Norm& norm) {
  const Point q = with_gauge(random.uniform(0.0, 0.98), random, norm);
  Vector n = unit(extended(point(random)));
  const std::size_t steps = random.choice(3) * 8;
  for (std::size_t i = 0; i < steps; ++i) n = normal_beyond(extended(q), n, norm);
  const double size = random.log_uniform(0.02, 1.4);
  Vector escape = n;
  Extended shortest = way_out(extended(q), n, norm);
  std::vector<Vector> directions;
  for (int i = 0; i < tries; ++i) {
    const Vector& w = directions.emplace_back(direction_near(n, size, random));
    const Extended way = way_out(extended(q), w, norm);
    if (way < shortest) escape = w;
    shortest = std::min(shortest, way);
  }
  const Extended beyond = 1.0L + random.log_uniform(1e-9, 0.1);
  // A vector shorter than 1 would have the ball proven that is shorter as much.
  const Extended factor = random.choice(8) == 0 ? 0.9L : 1.0L;
  const Extended t = beyond * shortest;
  const Extended bend = (1.0L - 1e-9L) * greatest_bend(extended(q), scaled(n, factor * t), directions, norm);
  return {q, rounded(scaled(n, factor)), size, static_cast<double>(t), rounded(escape), static_cast<double>(bend)};
}

Columns columns_of(const std::vector<OpenCap>& caps) {
  Columns columns(8);
  for (const OpenCap& cap : caps) {
    for (std::size_t k = 0; k < 3; ++k) {
      columns[k].push_back(cap.q[k]);
      columns[3 + k].push_back(cap.n[k]);
    }
    columns[6].push_back(cap.size);
    columns[7].push_back(cap.t);
  }
  return columns;
}

bool holds(double cosine, const OpenCap& cap) {
  return dot(extended(cap.escape), extended(cap.n)) >= cosine * length(extended(cap.escape));
}

std::string described(const OpenCap& cap) {
  return fmt::format(
      "cap about ({:.17g}, {:.17g}, {:.17g}) of size {:.17g} is proven for the ball of radius {:.17g} about ({:.17g}, "
      "{:.17g}, {:.17g}), which leaves the solid along ({:.17g}, {:.17g}, {:.17g})",
      cap.n[0], cap.n[1], cap.n[2], cap.size, cap.t, cap.q[0], cap.q[1], cap.q[2], cap.escape[0], cap.escape[1],
      cap.escape[2]);
}

}  // namespace verisq::mutation
