/// This file implements the points that are known, the launches, and the comparison.
#include "tests/mutation/tapered_interior_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <verisq/enclosure.hpp>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/examination.hpp"
#include "tests/mutation/focal_solid.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::mutation {
namespace {

using oracle::RandomCases;
using oracle::Real;
using Vector = oracle::Vector;

constexpr std::size_t samples = 256;      // of each function and solid
constexpr std::size_t scratch_size = 12;  // SCRATCH_SIZE in kernels/interior_depth.cl
constexpr double depth_tolerance = 1e-6;

constexpr const char* entry_point = R"(
kernel void examine_interior(uint function, ulong groups, global const double* operands, ulong stride,
                             constant const superquadric* s, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 a = {LOAD(group, operands), LOAD(group, operands + stride), LOAD(group, operands + 2 * stride)};
  const real b = LOAD(group, operands + 3 * stride);
  const vector3 c = {LOAD(group, operands + 4 * stride), LOAD(group, operands + 5 * stride),
                     LOAD(group, operands + 6 * stride)};
  const real d = LOAD(group, operands + 7 * stride);
  proven_distance found = {REAL(0.0), REAL(0.0), a};
  switch (function) { // numbered as in tests/mutation/tapered_interior_judge.cpp
    case 0: found.lo = interior_terms_up(moved_out(a, b, c), s).power; break;
    case 1: found.hi = interior_gauge_up(a, s); break;
    case 2: found.lo = REAL(inner_radius(s) * (1.0 - 0x1p-50)); break;
    case 3: found = distance_by_plane(a, c, d, s); break;
    default: {
      const integer below = MASK(d >= 2.0);
      const cone none = {a, REAL(INFINITY)};
      const real side = select(REAL(1.0), REAL(-1.0), below);
      found.lo = TO_REAL(test_quarters(a, b, c, select(d, d - 2.0, below), side, none, s).open);
      break;
    }
  }
  STORE(found.lo, group, results);
  STORE(found.hi, group, results + stride);
  STORE(found.normal.x, group, results + 2 * stride);
  STORE(found.normal.y, group, results + 3 * stride);
  STORE(found.normal.z, group, results + 4 * stride);
}
)";

constexpr std::array<const char*, 5> functions{"interior_terms_up", "interior_gauge_up", "inner_radius",
                                               "distance_by_plane", "test_quarters"};

/// A query of the whole kernel: the point, and what is true of it.
struct Query {
  Point point;
  std::function<bool(const Results&)> holds;
};

/// Of the quadrant that kernels fold points into: x and y not below 0.
Vector folded(const Vector& x) {
  return {abs(x[0]), abs(x[1]), x[2]};
}

/// The corners of a quarter of a cell of directions (kernels/spherical_cell.clh), x and y not below 0.
std::array<Vector, 3> corners_of(const Point& base, bool inverted, std::size_t quarter, double side) {
  std::array<Vector, 6> points;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) points[i][k] = base[k] + ((i == k) != inverted ? 1.0 : 0.0);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) points[3 + i][k] = (points[(i + 1) % 3][k] + points[(i + 2) % 3][k]) / 2;
  for (Vector& w : points) w[2] *= side;
  if (quarter == 3) return {points[3], points[4], points[5]};
  return {points[quarter], points[3 + (quarter + 1) % 3], points[3 + (quarter + 2) % 3]};
}

/// Draws samples for one solid.
class Drawing {
 public:
  Drawing(const Primitive& primitive, const device::PrimitiveParameters& parameters, std::uint64_t seed)
      : random_(seed),
        posed_({primitive.superquadric.semi_axes, primitive.superquadric.exponents}, primitive.pose),
        known_(posed_.norm(), Real(parameters.taper)),
        exact_(posed_.norm(), (Real(primitive.superquadric.taper) - 1) / (Real(primitive.superquadric.taper) + 1)) {}

  /// What is moved to beyond the surface does not lie in the solid.
  Sample beyond() {
    const double off = random_.log_uniform(1e-15, 1e-9);
    const Vector w = folded(known_.surface(at_direction(direction_of(random_), known_.norm()).u));
    const double reach = random_.log_uniform(0.01, 1.0);
    Point direction = random_.direction();
    for (std::size_t i = 0; i < 2; ++i) direction[i] = std::fabs(direction[i]);
    const Vector from = {w[0] - reach * direction[0], w[1] - reach * direction[1], w[2] - reach * direction[2]};
    const Point q = oracle::rounded(oracle::scaled<Real>(from, Real(1)));
    Vector moved = oracle::widened(q);
    for (std::size_t i = 0; i < 3; ++i) moved[i] += Real(reach) * direction[i];
    // Scaled about the focus, so that what is moved to lies beyond: where rounding undid it, nothing is claimed.
    const Real excess = gauge(moved) - 1;
    const Point shifted = oracle::rounded(stepped(oracle::widened(q), w, (off - excess).convert_to<double>()));
    Vector at = oracle::widened(shifted);
    for (std::size_t i = 0; i < 3; ++i) at[i] += Real(reach) * direction[i];
    const bool outside = at[0] >= 0 && at[1] >= 0 && shifted[0] >= 0 && shifted[1] >= 0 && gauge(at) > 1;
    return {{shifted[0], shifted[1], shifted[2], reach, direction[0], direction[1], direction[2]},
            [outside](const Results& found) { return !outside || !(found[0] <= 1.0); }};
  }

  Sample gauge_of_point() {
    const Vector w = folded(known_.surface(at_direction(direction_of(random_), known_.norm()).u));
    const Point q = oracle::rounded(oracle::scaled<Real>(w, Real(random_.uniform(0.0, 1.0))));
    const Real exact = gauge(oracle::widened(q));
    return {{q[0], q[1], q[2]}, [exact](const Results& found) { return Real(found[1]) >= exact; }};
  }

  /// No longer than to any point of the surface, the ends of the axis among them.
  Sample inner_ball() {
    const Point direction =
        random_.choice(4) == 0 ? Point{0.0, 0.0, random_.choice(2) == 0 ? 1.0 : -1.0} : direction_of(random_);
    const Real distance = oracle::length<Real>(known_.surface(at_direction(direction, known_.norm()).u));
    return {{}, [distance](const Results& found) { return Real(found[0]) <= distance; }};
  }

  /// The plane at a point of the surface, whose level is off now and then.
  Sample plane() {
    const auto contact = folded_contact();
    const auto& [w, v] = contact;
    const Real length = oracle::length<Real>(v);
    const Point q = oracle::rounded(stepped(w, v, -random_.log_uniform(1e-9, 0.1)));
    const Point unit = oracle::rounded(oracle::scaled<Real>(v, 1 / length));
    const double off = random_.choice(2) == 0 ? 0.0 : random_.uniform(-1e-3, 1e-3);
    const auto level = Real((1 + off) / length).convert_to<double>();
    return {{q[0], q[1], q[2], 0.0, unit[0], unit[1], unit[2], level},
            [q, touched = w](const Results& found) { return proves(found, oracle::widened(q), touched); }};
  }

  /// A ball that leaves the solid in one of the quarters, of a cell on either side.
  Sample quarter() {
    const Vector surface = folded(known_.surface(at_direction(direction_of(random_), known_.norm()).u));
    const Point q = oracle::rounded(oracle::scaled<Real>(surface, Real(random_.uniform(0.0, 0.9))));
    const auto level = random_.choice(random_.choice(2) == 0 ? 3 : 24);
    const bool inverted = level > 0 && random_.choice(2) == 0;
    const std::size_t sum = (std::size_t{1} << level) - (inverted ? 2 : 1);
    const std::size_t x = random_.choice(sum + 1);
    const std::size_t y = random_.choice(sum - x + 1);
    const Point base{static_cast<double>(x), static_cast<double>(y), static_cast<double>(sum - x - y)};
    const std::size_t chosen = random_.choice(4);
    const bool below = random_.choice(2) == 0;
    const std::array<Vector, 3> corners = corners_of(base, inverted, chosen, below ? -1.0 : 1.0);
    const Vector middle{corners[0][0] + corners[1][0] + corners[2][0], corners[0][1] + corners[1][1] + corners[2][1],
                        corners[0][2] + corners[1][2] + corners[2][2]};
    const auto t =
        ((1 + Real(random_.log_uniform(1e-13, 0.1))) * way_out(oracle::widened(q), middle)).convert_to<double>();
    const double kind = (inverted ? 1.0 : 0.0) + (below ? 2.0 : 0.0);
    return {{q[0], q[1], q[2], t, base[0], base[1], base[2], kind},
            [chosen](const Results& found) { return (static_cast<long>(found[0]) & (1L << chosen)) != 0; }};
  }

  /// A point below the surface, along its normal.
  Query query() {
    const SurfacePoint at = at_direction(direction_of(random_), exact_.norm());
    Vector p = exact_.surface(at.u);
    const Vector v = exact_.normal(at.n);
    p[2] -= exact_.k() * exact_.height();
    const Point x = oracle::rounded(posed_.from_own_frame(stepped(p, v, -random_.log_uniform(1e-7, 0.3))));
    const Vector q = posed_.to_own_frame(oracle::widened(x));
    return {x, [q, p, v](const Results& found) { return encloses(found, q, p, v); }};
  }

 private:
  [[nodiscard]] Real gauge(const Vector& w) const {
    return (known_.norm().gauge(w) - known_.k() * w[2] / known_.height()) / known_.fall();
  }

  [[nodiscard]] std::pair<Vector, Vector> folded_contact() {
    const SurfacePoint at = at_direction(direction_of(random_), known_.norm());
    return {folded(known_.surface(at.u)), folded(known_.normal(at.n))};
  }

  /// From q along w, or hardly more: the gauge is convex, so that chords from outside stay there.
  [[nodiscard]] Real way_out(const Vector& q, const Vector& w) const {
    const Real inverse = 1 / oracle::length<Real>(w);
    const auto excess = [&](const Real& s) -> Real {
      return gauge({q[0] + s * inverse * w[0], q[1] + s * inverse * w[1], q[2] + s * inverse * w[2]}) - 1;
    };
    Real far = 16;
    Real near = 15;
    Real far_excess = excess(far);
    while (far - near > Real(1e-25) * near) {
      const Real near_excess = excess(near);
      const Real next = near - near_excess * (far - near) / (far_excess - near_excess);
      far = std::exchange(near, next);
      far_excess = near_excess;
    }
    return far;
  }

  RandomCases random_;
  oracle::PosedSolid posed_;
  FocalSolid known_;  ///< of the rounded k
  FocalSolid exact_;
};

/// What the kernel finds of points of which nothing is known but that they may lie inside.
std::vector<Results> depths(const CompiledKernels& kernels, const std::vector<Query>& queries,
                            device::PrimitiveParameters parameters) {
  const std::size_t count = queries.size();
  const cl::Buffer primitive(kernels.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof parameters, &parameters);
  std::array<cl::Buffer, 3> coordinates;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Columns column(1);
    for (const Query& query : queries) column[0].push_back(query.point[axis]);
    coordinates[axis] = uploaded(kernels, column);
  }
  const std::array<cl::Buffer, 5> evidence{uploaded(kernels, {std::vector<double>(count, -1e300)}),
                                           uploaded(kernels, {std::vector<double>(count, 1e300)}),
                                           zeros(kernels, count), zeros(kernels, count), zeros(kernels, count)};
  const cl::Buffer scratch = zeros(kernels, scratch_size * count);
  cl::Kernel kernel(kernels.program, "interior_depth");
  const cl_ulong groups = count / static_cast<std::size_t>(kernels.vector_width);
  cl_uint argument = 0;
  kernel.setArg(argument++, groups);
  kernel.setArg(argument++, static_cast<cl_uint>(groups));
  for (const cl::Buffer& column : coordinates) kernel.setArg(argument++, column);
  kernel.setArg(argument++, primitive);
  kernel.setArg(argument++, cl_uint{0});
  kernel.setArg(argument++, depth_tolerance);
  kernel.setArg(argument++, scratch);
  for (const cl::Buffer& column : evidence) kernel.setArg(argument++, column);
  const cl::CommandQueue queue(kernels.context, kernels.device);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1));
  std::vector<Results> results(count);
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const std::vector<double> column = read(queue, evidence[i], count);
    for (std::size_t n = 0; n < count; ++n) results[n][i] = column[n];
  }
  return results;
}

}  // namespace

struct TaperedInteriorJudge::KnownSolid {
  Primitive primitive;
  device::PrimitiveParameters parameters;
  std::array<std::vector<Sample>, functions.size()> of_functions;
  std::vector<Query> queries;
};

TaperedInteriorJudge::TaperedInteriorJudge() {
  std::uint64_t seed = 100;
  for (const auto& [superquadric, loose_constants] : tested_solids) {
    const Primitive primitive{"", superquadric, {{1.0, 2.0, 3.0}, {0.3, 0.5, -0.7, 0.2}}};
    const device::PrimitiveParameters parameters = device::primitive_parameters(primitive, 0);
    KnownSolid& known =
        solids_.emplace_back(KnownSolid{primitive, loose_constants ? loosened(parameters) : parameters, {}, {}});
    Drawing drawing(primitive, parameters, ++seed);
    for (std::size_t i = 0; i < samples; ++i) {
      known.of_functions[0].push_back(drawing.beyond());
      known.of_functions[1].push_back(drawing.gauge_of_point());
      known.of_functions[2].push_back(drawing.inner_ball());
      known.of_functions[3].push_back(drawing.plane());
      known.of_functions[4].push_back(drawing.quarter());
      known.queries.push_back(drawing.query());
    }
  }
}

TaperedInteriorJudge::~TaperedInteriorJudge() = default;

std::string TaperedInteriorJudge::examination() {
  return entry_point;
}

std::string TaperedInteriorJudge::false_claim(const CompiledKernels& kernels) const {
  for (const KnownSolid& known : solids_) {
    const double taper = known.primitive.superquadric.taper;
    for (cl_uint function = 0; function < functions.size(); ++function) {
      const std::vector<Sample>& of_function = known.of_functions[function];
      const std::vector<Results> results = called(kernels, "examine_interior", function, of_function, known.parameters);
      for (std::size_t n = 0; n < results.size(); ++n)
        if (!of_function[n].holds(results[n]))
          return fmt::format("{}, taper {:.3g}, {}", functions[function], taper,
                             described(of_function[n].operands, results[n]));
    }
    const std::vector<Results> results = depths(kernels, known.queries, known.parameters);
    for (std::size_t n = 0; n < results.size(); ++n) {
      if (known.queries[n].holds(results[n])) continue;
      const Point& x = known.queries[n].point;
      return fmt::format("interior_depth, taper {:.3g}, {}", taper, described({x[0], x[1], x[2]}, results[n]));
    }
  }
  return {};
}

}  // namespace verisq::mutation
