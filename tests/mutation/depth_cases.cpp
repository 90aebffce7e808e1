/// This file implements the choice of solids and cases, and what is true of them by the formulas of
/// docs/mathematics.md §9 at single points.
#include "tests/mutation/depth_cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/gauge_square.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/placed_primitive.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {
namespace {

using oracle::PlacedPrimitive;
using oracle::RandomCases;

constexpr std::size_t solids_of_kind = 8;
constexpr std::size_t metric_count = 20'000;
constexpr std::size_t seconds_of_solid = 480;
constexpr std::size_t ways_of_solid = 160;
constexpr std::size_t gradients_of_solid = 80;
constexpr std::size_t balls_of_solid = 320;
constexpr std::size_t depths_of_solid = 32;
constexpr double beside_boundary = 1e-11;  // of the gauge
constexpr double certain = 1e-9;           // of the gauge, for points of spheres

double norm(const Point& a) {
  return std::hypot(a[0], a[1], a[2]);
}
Point moved(const Point& x, double distance, const Point& direction) {
  return {x[0] + distance * direction[0], x[1] + distance * direction[1], x[2] + distance * direction[2]};
}
Point between(const Point& from, const Point& to) {
  return moved(to, -1.0, from);
}
Point normalized(const Point& a) {
  return moved({}, 1.0 / norm(a), a);
}
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Solids.

enum class Kind { sphere, ellipsoid, hardly_bent, mixed, slender, square, bent_sphere, flat, pointed, count };

Superquadric shape(RandomCases& random, Kind kind) {
  const auto exponent = [&] { return random.choice(4) == 0 ? 1.0 : random.uniform(0.15, 1.0); };
  const double a = random.uniform(0.3, 1.0);
  const double b = random.uniform(0.3, 1.0);
  switch (kind) {
    case Kind::sphere:
    case Kind::bent_sphere: return {{1.5 * a, 1.5 * a, 1.5 * a}, {1.0, 1.0}};
    case Kind::ellipsoid: return {{a, b, random.uniform(0.3, 1.9)}, {1.0, 1.0}};
    case Kind::slender: return {{0.3 * a, 0.3 * b, random.uniform(1.0, 1.9)}, {exponent(), exponent()}};
    case Kind::square:
      return {{a, a, random.uniform(0.3, 1.9)}, {random.uniform(0.15, 0.4), random.uniform(0.15, 0.4)}};
    case Kind::flat: return {{1.5 * a, 1.5 * b, random.uniform(0.1, 0.4)}, {exponent(), 1.0}};
    case Kind::pointed:
      return {{a, b, random.uniform(0.5, 1.9)},
              random.choice(2) == 0 ? std::array{random.uniform(1.1, 1.9), exponent()}
                                    : std::array{exponent(), random.uniform(1.1, 1.9)}};
    default: return {{a, b, random.uniform(0.5, 1.9)}, {exponent(), exponent()}};
  }
}

/// Ratios of the ends up to 19.
double taper(RandomCases& random) {
  const double ratio = random.choice(3) == 0 ? random.uniform(2.0, 19.0) : random.uniform(1.01, 3.0);
  return random.choice(2) == 0 ? ratio : 1.0 / ratio;
}

double taper_of(const Superquadric& s) {
  return (s.taper - 1.0) / (s.taper + 1.0);
}

Primitive solid(RandomCases& random, Kind kind, Tapers tapers) {
  Primitive made{"", shape(random, kind), {}, Bend{1.0, 0.0}};
  if (tapers == Tapers::some && random.choice(8) != 0) made.superquadric.taper = taper(random);
  const auto& axes = made.superquadric.semi_axes;
  const double widest = (1.0 + std::fabs(taper_of(made.superquadric))) * (axes[0] + axes[1]);
  const double most = std::min(1.0 / widest, 3.0 / axes[2]);
  const bool hardly = kind == Kind::sphere || kind == Kind::hardly_bent;
  made.bend->curvature = hardly ? 1e-200 : most * random.log_uniform(0.03, 0.8);
  if (random.choice(2) == 0) made.bend->curvature = -made.bend->curvature;
  made.bend->angle_degrees = random.choice(4) == 0 ? 0.0 : random.uniform(-180.0, 180.0);
  if (random.choice(4) != 0) {
    for (double& t : made.pose.translation) t = random.uniform(-3.0, 3.0);
    for (double& component : made.pose.quaternion) component = random.uniform(-1.0, 1.0);
  }
  return made;
}

// Metrics: in units of the radius of curvature, by polar coordinates about its centre; angles from that of q.

struct Polar {
  Long w, angle;
};

/// W and angle of a point of the disc of radius `sine` W_q about q.
Polar of_disc(Long w_q, Long radius, Long direction) {
  const Long x = w_q + radius * std::cos(direction);
  const Long y = radius * std::sin(direction);
  return {std::hypot(x, y), std::atan2(y, x)};
}

/// By how much f exceeds its tangent plane at c, and whether the point is in the ball.
struct Excess {
  Long value;
  bool in_ball;
};

Excess excess(Long w_q, const Polar& c, Long e, Long delta) {
  const Long half = std::sin(delta / 2);
  const Long u = -2 * std::sin(c.angle + delta / 2) * half;
  const Long rest =
      std::fabs(delta) < 1e-3L ? delta * delta * delta / 6 * (1 - delta * delta / 20) : delta - std::sin(delta);
  const Long big_e = 2 * half * half * std::cos(c.angle) - rest * std::sin(c.angle);
  const Long higher = e * (2 * c.w + e) - 2 * w_q * (e * std::cos(c.angle + delta) + c.w * u);
  return {e * e - 2 * e * w_q * u + 2 * c.w * w_q * big_e, higher <= 0};
}

MetricCase metric_case(RandomCases& random) {
  constexpr Long k = metric_curvature;
  const Long w_q = random.uniform(0.1, 2.0);
  const Long gamma_q = random.choice(3) == 0 ? random.uniform(3.0, 3.14) : random.uniform(-3.0, 3.0);
  const Long sine = random.choice(4) == 0   ? random.uniform(0.6, 1.0)
                    : random.choice(2) == 0 ? random.uniform(0.02, 0.65)
                                            : random.log_uniform(1e-6, 1.0);
  const Long radius = sine * w_q;
  const Long extreme = std::acos(-std::min<Long>(sine, 1));
  const bool at_extreme = random.choice(2) == 0;
  const Long direction = (random.choice(2) == 0 ? -1 : 1) *
                         (at_extreme ? extreme + (random.choice(2) == 0 ? 0.0L : 0.01L * random.uniform(-1.0, 1.0))
                                     : static_cast<Long>(random.uniform(0.0, std::numbers::pi)));
  const Polar c = of_disc(w_q, radius, direction);
  const Long gamma_c = c.angle + gamma_q;
  MetricCase made{};
  made.given = {static_cast<double>((1 - c.w * std::cos(gamma_c)) / k),
                static_cast<double>(c.w * std::sin(gamma_c) / k),
                static_cast<double>((1 - w_q * std::cos(gamma_q)) / k),
                static_cast<double>(w_q * std::sin(gamma_q) / k), static_cast<double>(radius / k)};
  made.apart = static_cast<double>(c.angle / k);
  const auto take = [&](Long e, Long delta) {
    const Excess found = excess(w_q, c, e, delta);
    if (!found.in_ball) return;
    made.points.push_back({static_cast<double>(found.value / (k * k)), static_cast<double>(e * e / (k * k)),
                           static_cast<double>(delta * delta / (k * k))});
  };
  for (int i = 0; i < 6; ++i) {
    const Polar y = of_disc(w_q, radius * std::sqrt(random.uniform(0.0, 1.0)), random.uniform(-3.2, 3.2));
    take(y.w - c.w, y.angle - c.angle);
  }
  // From one end of the ball to the other, and small steps.
  const Polar other = of_disc(w_q, radius * (1 - 1e-12L), -direction);
  take(other.w - c.w, other.angle - c.angle);
  const Long stretch = std::sqrt(c.w * w_q * std::max<Long>(std::cos(c.angle), 0));
  for (int i = 0; i < 8; ++i) {
    const Long size = radius * random.log_uniform(1e-5, 0.1);
    const Long way = i < 4 ? std::numbers::pi / 4 * (2 * i + 1) : random.uniform(-3.2, 3.2);
    take(stretch * size * std::cos(way), size * std::sin(way));
  }
  made.reach_r = static_cast<double>(radius * (1 - 1e-12L) / k);
  made.reach_z = sine < 1 ? static_cast<double>(std::asin(sine) * (1 - 1e-12L) / k) : 0.0;
  return made;
}

// Second derivatives.

/// Anywhere about the solid, at times by a plane or an axis.
LongVector place(RandomCases& random, const Superquadric& s) {
  LongVector x{};
  for (std::size_t i = 0; i < 3; ++i)
    x[i] = s.semi_axes[i] * (random.choice(6) == 0 ? random.log_uniform(1e-9, 1.0) : random.uniform(0.0, 1.0));
  if (random.choice(16) == 0) x[random.choice(3)] = 0;
  if (!is_tapered(s)) return x;
  // From the untapered solid to about the focus of the tapered one.
  const Long k = taper_of(s);
  const Long height = (random.choice(2) == 0 ? -1 : 1) * x[2] / s.semi_axes[2];
  const Long room = (1 - k * k) / (1 - k * height);
  return {room * x[0], room * x[1], room * height * s.semi_axes[2]};
}

/// Whether the coordinate may have the other sign as well.
bool is_symmetric(const Superquadric& s, std::size_t axis) {
  return axis < 2 || !is_tapered(s);
}

/// Where the bounds of both terms of the section and of z are alike, by one of the three estimates.
Long equal_stretch(RandomCases& random, const Superquadric& s, const LongMatrix& second, const LongVector& x) {
  const Long p_1 = 2 / static_cast<Long>(s.exponents[0]);
  const oracle::MixedNorm<Long> gauge(s);
  const Long share_z = std::pow(x[2] / s.semi_axes[2] / gauge.gauge(x), p_1);
  const Long excess = p_1 - 2;
  const Long share_r = 1 - share_z;
  constexpr std::array<std::array<Long, 2>, 4> multiples{{{2, 2}, {1.125L, 9}, {2, 2}, {1.125L, 9}}};
  const std::size_t kind = random.choice(5);
  const Long raised_r = kind == 4 ? 1 + excess : 1 + excess * multiples[kind][0] * share_z;
  const Long raised_z = kind == 4 ? 1 + excess : 1 + excess * multiples[kind][1] * share_r;
  // Of the section and of z without the fourth term.
  const Long of_z = second[2][2] / (1 + excess * share_r);
  LongMatrix section = second;
  section[0][2] = section[1][2] = section[2][0] = section[2][1] = section[2][2] = 0;
  const Long of_r = largest_step(section, 1).value / (1 + excess * share_z);
  const Long square = of_z * raised_z / (of_r * raised_r);
  return square > 1e-8L && square < 1e8L ? std::sqrt(square) : 1;
}

template <class Function>
Long stretch_at(RandomCases& random, const Superquadric& s, const LongVector& x) {
  if (random.choice(3) == 0) return random.uniform(0.2, 1.5);
  const LongMatrix second = Function(s).second_derivative(x);
  if (std::is_same_v<Function, GaugeSquare>) return equal_stretch(random, s, second, x);
  const LongMatrix section{second[0], second[1], LongVector{}};
  const Long square = second[2][2] / largest_step(section, 1).value;
  return square > 1e-8L && square < 1e8L ? std::sqrt(square) : 1;
}

/// Infinite where an entry is.
Long largest_of(const LongMatrix& second, Long stretch) {
  return std::isfinite(second[2][2]) ? largest_step(second, stretch).value : second[2][2];
}

template <class Function>
SecondCase second_case(RandomCases& random, const Superquadric& s) {
  const LongVector middle = place(random, s);
  const auto stretch = static_cast<double>(stretch_at<Function>(random, s, middle));
  SecondCase made{};
  const double size = random.choice(2) == 0 ? 0.0 : random.log_uniform(1e-9, 0.5);
  for (std::size_t i = 0; i < 3; ++i) {
    const double sign = is_symmetric(s, i) && random.choice(2) == 0 ? -1.0 : 1.0;
    const double at = sign * static_cast<double>(middle[i]);
    made.given[2 * i] = at - size * random.uniform(0.0, 1.0);
    made.given[2 * i + 1] = at + size * random.uniform(0.0, 1.0);
  }
  made.given[6] = stretch;
  const Function function(s);
  for (std::size_t n = 0; n < (size == 0.0 ? 1 : 16); ++n) {
    LongVector x{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Long lo = made.given[2 * i];
      const Long hi = made.given[2 * i + 1];
      x[i] = n < 8 ? ((n >> i & 1U) == 0 ? lo : hi) : lo + (hi - lo) * random.uniform(0.0, 1.0);
    }
    made.largest = std::max(made.largest, static_cast<double>(largest_of(function.second_derivative(x), stretch)));
  }
  return made;
}

/// 2 times the integral of (1 - s) e'f''(c + s e) e over |e|^2.
template <class Function>
Long weighted(const Function& function, const LongVector& c, const LongVector& e, Long stretch) {
  constexpr int pieces = 256;
  const Long square = e[0] * e[0] + e[1] * e[1] + stretch * stretch * e[2] * e[2];
  Long sum = 0;
  for (int i = 0; i < pieces; ++i) {
    const Long s = (i + 0.5L) / pieces;
    LongVector x{};
    LongVector step = e;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = c[k] + s * e[k];
      if (x[k] < 0) step[k] = -step[k];
    }
    const LongMatrix second = function.second_derivative(x);
    if (!std::isfinite(second[2][2])) return infinity;
    Long value = 0;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = 0; l < 3; ++l) value += step[k] * second[k][l] * step[l];
    sum += 2 * (1 - s) * value / pieces;
  }
  return sum / square;
}

template <class Function>
WayCase way_case(RandomCases& random, const Superquadric& s) {
  const Function function(s);
  const LongVector c = place(random, s);
  const auto stretch = static_cast<double>(stretch_at<Function>(random, s, c));
  const LongVector best = largest_step(function.second_derivative(c), stretch).step;
  const double length = (random.choice(2) == 0 ? -1.0 : 1.0) * random.log_uniform(1e-4, 1.0);
  const bool point = random.choice(2) == 0;
  WayCase made{};
  LongVector from{};
  LongVector step{};
  for (std::size_t i = 0; i < 3; ++i) {
    made.given[i] = static_cast<double>(c[i]);
    const double reach = point ? 1e-9 * random.uniform(0.5, 1.0) : random.log_uniform(1e-6, 0.5);
    const double end = made.given[i] + length * static_cast<double>(best[i]);
    const double share = random.choice(3) == 0 ? (random.choice(2) == 0 ? -1.0 : 1.0) : random.uniform(-1.0, 1.0);
    made.given[3 + i] = end + (1 - 1e-12) * share * reach;
    made.given[6 + i] = reach;
    from[i] = made.given[i];
    step[i] = static_cast<Long>(end) - made.given[i];
  }
  // The octant of c may be any.
  for (std::size_t i = 0; i < 3; ++i) {
    if (!is_symmetric(s, i) || random.choice(2) != 0) continue;
    made.given[i] = -made.given[i];
    made.given[3 + i] = -made.given[3 + i];
  }
  made.given[9] = stretch;
  made.weighted = static_cast<double>(weighted(function, from, step, stretch));
  return made;
}

template <class Function>
GradientCase gradient_case(RandomCases& random, const Superquadric& s) {
  const Function function(s);
  const LongVector at = place(random, s);
  const double size = random.choice(2) == 0 ? 0.0 : random.log_uniform(1e-9, 0.3);
  GradientCase made{};
  for (std::size_t i = 0; i < 3; ++i) {
    made.given[2 * i] = std::max(0.0, static_cast<double>(at[i]) - size * random.uniform(0.0, 1.0));
    made.given[2 * i + 1] = static_cast<double>(at[i]) + size * random.uniform(0.0, 1.0);
  }
  if (is_tapered(s)) made.given[4] = static_cast<double>(at[2]) - size;
  // Profiles end there.
  const double k = taper_of(s);
  const double end = 0.999 * (1.0 + k) * s.semi_axes[2];
  const double other_end = 0.999 * (k - 1.0) * s.semi_axes[2];
  for (std::size_t i = 4; i < 6; ++i) made.given[i] = std::clamp(made.given[i], other_end, end);
  made.least = {infinity, infinity, infinity};
  made.largest = {-infinity, -infinity, -infinity};
  made.twice = -infinity;
  for (std::size_t n = 0; n < 8; ++n) {
    LongVector x{};
    for (std::size_t i = 0; i < 3; ++i) x[i] = made.given[2 * i + (n >> i & 1U)];
    if (!(x[0] + x[1] > 0)) continue;
    const LongVector found = function.gradient(x);
    for (std::size_t i = 0; i < 3; ++i) {
      made.least[i] = std::min(made.least[i], static_cast<double>(found[i]));
      made.largest[i] = std::max(made.largest[i], static_cast<double>(found[i]));
    }
    made.twice = std::max(made.twice, static_cast<double>(2 * function.value(x)));
  }
  return made;
}

// Balls.

/// Of the level set of the gauge, in the model's frame; by differences, since what is near the normal is good enough.
Point normal_at(const PlacedPrimitive& solid, const Point& x) {
  constexpr double step = 1e-6;
  Point n{};
  for (std::size_t i = 0; i < 3; ++i) {
    Point up = x;
    Point down = x;
    up[i] += step;
    down[i] -= step;
    n[i] = solid.norm().gauge(solid.own(up)) - solid.norm().gauge(solid.own(down));
  }
  return normalized(n);
}

double gauge_at(const PlacedPrimitive& solid, const Point& x) {
  return solid.norm().gauge(solid.own(x));
}

/// The largest gauge on the sphere about q in some directions, most of them near the given one.
double largest_gauge(const PlacedPrimitive& solid, const Point& q, const Point& direction, double radius) {
  constexpr int azimuths = 36;
  constexpr std::array angles{0.0, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.14,
                              0.2, 0.3,  0.4,  0.55, 0.7,  0.9,  1.1,  1.3,  1.6,  2.1,  2.6};
  const Point u = normalized(cross(direction, std::fabs(direction[0]) < 0.7 ? Point{1, 0, 0} : Point{0, 1, 0}));
  const Point v = cross(direction, u);
  double largest = 0.0;
  for (const double angle : angles)
    for (int i = 0; i < azimuths; ++i) {
      const double turn = 2 * std::numbers::pi * i / azimuths;
      const Point around = moved(moved({}, std::cos(turn), u), std::sin(turn), v);
      const Point to = moved(moved({}, std::cos(angle), direction), std::sin(angle), around);
      largest = std::max(largest, gauge_at(solid, moved(q, radius, to)));
    }
  return largest;
}

/// Just outside of the boundary, with the normal there.
struct Witness {
  Point point;
  Point normal;
};

Witness witness(RandomCases& random, const PlacedPrimitive& solid) {
  Point foot = random.boundary_point(solid.primitive().superquadric).point;
  const bool has_edges = solid.primitive().superquadric.exponents[1] > 1.0;
  if (has_edges && random.choice(2) == 0) {  // on one: a plane of symmetry
    foot[random.choice(2)] = 0.0;
    foot = moved({}, 1.0 / solid.norm().gauge(foot), foot);
  }
  const Point at = solid.placed(moved({}, 1.0 + beside_boundary, foot));
  return {at, normal_at(solid, at)};
}

double least_axis(const PlacedPrimitive& solid) {
  const auto& axes = solid.primitive().superquadric.semi_axes;
  return std::min({axes[0], axes[1], axes[2]});
}

/// In the frame of the bend, as kernels have it.
Point in_frame(const device::BoxPrimitiveParameters& p, const Point& x) {
  Point y{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) y[i] += p.frame[3 * i + j] * (x[j] - p.solid.translation[j]);
  return y;
}

/// The border meets the solid's at the witness, or all but that; p is another point of it, at times far away.
BallCase ball_case(RandomCases& random, const PlacedPrimitive& solid, const device::BoxPrimitiveParameters& p) {
  const Witness w = witness(random, solid);
  const double depth = least_axis(solid) * random.log_uniform(1e-3, 0.9);
  const Point q = moved(w.point, -depth, w.normal);
  const double off = (random.choice(4) == 0 ? -1.0 : 1.0) * random.log_uniform(1e-13, 1e-2);
  const double tilt = random.choice(4) == 0 ? 0.0 : random.log_uniform(1e-7, 0.6);
  const Point direction = normalized(moved(w.normal, tilt, random.direction()));
  const double radius = norm(between(q, w.point)) * (1.0 + off);
  const Point border = moved(q, radius, direction);
  const Point bent_q = in_frame(p, q);
  const Point bent_p = in_frame(p, border);
  const bool beyond = off > 5e-13 || largest_gauge(solid, q, direction, radius) > 1.0 + certain;
  return {{bent_q[0], bent_q[1], bent_q[2], bent_p[0], bent_p[1], bent_p[2]}, beyond};
}

DepthCase depth_case(RandomCases& random, const PlacedPrimitive& solid) {
  const Witness w = witness(random, solid);
  const double depth = least_axis(solid) * random.log_uniform(1e-3, 0.5);
  const Point q = moved(w.point, -depth, w.normal);
  const double most = norm(between(q, w.point));
  const bool nearest = largest_gauge(solid, q, w.normal, most) < 1.0 + certain;
  // A taper moves heights apart by at most this much.
  const double k = std::fabs(taper_of(solid.primitive().superquadric));
  return {q, nearest ? most - 8 * beside_boundary * (1.0 + k) / (1.0 - k) : 0.0, most};
}

/// `make(random, solid)`, in their order.
template <class Case, class Make>
std::vector<Case> made(std::size_t solids, std::size_t of_solid, const Make& make) {
  const std::size_t at_a_time = cases_at_a_time;
  std::vector<Case> all(solids * of_solid);
  oracle::in_parallel(solids, [&](std::size_t index) {
    RandomCases random(index);
    for (std::size_t n = 0; n < of_solid; ++n)
      all[(n / at_a_time * solids + index) * at_a_time + n % at_a_time] = make(random, index);
  });
  return all;
}

template <class Function>
FunctionCases function_cases(const DepthSolids& solids) {
  const auto shape = [&](std::size_t i) { return solids.all[i].superquadric; };
  const std::size_t count = solids.of_lemmas;
  return {made<SecondCase>(count, seconds_of_solid,
                           [&](RandomCases& random, std::size_t i) { return second_case<Function>(random, shape(i)); }),
          made<WayCase>(count, ways_of_solid,
                        [&](RandomCases& random, std::size_t i) { return way_case<Function>(random, shape(i)); }),
          made<GradientCase>(count, gradients_of_solid, [&](RandomCases& random, std::size_t i) {
            return gradient_case<Function>(random, shape(i));
          })};
}

}  // namespace

DepthSolids depth_solids(Tapers tapers) {
  RandomCases random(5);
  DepthSolids made{{}, static_cast<std::size_t>(Kind::pointed) * solids_of_kind};
  for (std::size_t kind = 0; kind < static_cast<std::size_t>(Kind::count); ++kind)
    for (std::size_t n = 0; n < solids_of_kind; ++n) made.all.push_back(solid(random, static_cast<Kind>(kind), tapers));
  return made;
}

DepthCases::DepthCases(const DepthSolids& solids) : depths(solids.all.size()) {
  const std::vector<PlacedPrimitive> placed(solids.all.begin(), solids.all.end());
  const std::size_t count = solids.of_lemmas;
  metrics = made<MetricCase>(1, metric_count, [](RandomCases& random, std::size_t) { return metric_case(random); });
  of_gauge = function_cases<GaugeSquare>(solids);
  of_profile = function_cases<SectionProfile>(solids);
  balls = made<BallCase>(count, balls_of_solid, [&](RandomCases& random, std::size_t i) {
    return ball_case(random, placed[i], device::box_primitive_parameters(solids.all[i], 0));
  });
  oracle::in_parallel(solids.all.size(), [&](std::size_t i) {
    RandomCases random(i);
    for (std::size_t n = 0; n < depths_of_solid; ++n) depths[i].push_back(depth_case(random, placed[i]));
  });
}

}  // namespace verisq::mutation
