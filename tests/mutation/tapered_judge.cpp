/// This file implements the points that are known, the launches of the functions, and the comparison.
#include "tests/mutation/tapered_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <verisq/enclosure.hpp>

#include "host/batches/primitive_parameters.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::mutation {
namespace {

using oracle::MixedNorm;
using oracle::RandomCases;
using oracle::Real;
using Vector = oracle::Vector;
using Operands = TaperedJudge::Operands;
using Results = TaperedJudge::Results;
using Sample = TaperedJudge::Sample;

constexpr std::size_t samples = 256;  // of each function and solid
constexpr std::size_t operand_count = std::tuple_size_v<Operands>;
constexpr std::size_t result_count = std::tuple_size_v<Results>;

constexpr const char* examination = R"(
kernel void examine_tapered(uint function, ulong groups, global const double* operands, ulong stride,
                            constant const superquadric* s, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 a = {LOAD(group, operands), LOAD(group, operands + stride), LOAD(group, operands + 2 * stride)};
  const real b = LOAD(group, operands + 3 * stride);
  const real c = LOAD(group, operands + 4 * stride);
  const real d = LOAD(group, operands + 5 * stride);
  const real e = LOAD(group, operands + 6 * stride);
  const real k = LOAD(group, operands + 7 * stride);
  const vector3 sign = {copysign(REAL(1.0), a.x), copysign(REAL(1.0), a.y), copysign(REAL(1.0), a.z)};
  const local_point own = {magnitudes(a), sign, b};
  proven_distance found = {REAL(0.0), REAL(0.0), a};
  switch (function) { // numbered as in tests/mutation/tapered_judge.cpp
    case 0: {
      const focal_point q = about_focus(own, s);
      found.lo = q.point.z;
      found.hi = q.error;
      break;
    }
    case 1: {
      const tilted_normal tilted = tilted_up(a, b, k, s);
      found.hi = tilted.support;
      found.normal = tilted.normal;
      break;
    }
    case 2: {
      const log_unknowns at = {b, c, d, e, REAL(0.0)};
      const log_unknowns none = {REAL(0.0), REAL(0.0), REAL(0.0), REAL(0.0), REAL(0.0)};
      found = distance_by_tapered_contact(a, moved_contact(contact_at(at, s), none, s), k, s);
      break;
    }
    case 3: found = enclosure_from_afar(own, s); break;
    case 4: {
      const vector3 w = {c, d, e};
      found.lo = interior_terms_up(moved_out(a, b, w), s).power;
      break;
    }
    case 5: found.hi = interior_gauge_up(a, s); break;
    case 6: found.lo = REAL(inner_radius(s) * (1.0 - 0x1p-50)); break;
    case 7: {
      const vector3 v = {b, c, d};
      found = distance_by_plane(a, v, e, s);
      break;
    }
    case 8: {
      const vector3 base = {c, d, e};
      const integer below = MASK(k >= 2.0);
      const cone none = {a, REAL(INFINITY)};
      found.lo = TO_REAL(test_quarters(a, b, base, select(k, k - 2.0, below), select(REAL(1.0), REAL(-1.0), below), none, s).open);
      break;
    }
    default: found = enclosure_at(to_local(a, s), s); break;
  }
  STORE(found.lo, group, results);
  STORE(found.hi, group, results + stride);
  STORE(found.normal.x, group, results + 2 * stride);
  STORE(found.normal.y, group, results + 3 * stride);
  STORE(found.normal.z, group, results + 4 * stride);
}
)";

/// Widened far beyond rounding, as a host might that computes with fewer digits: bounds they still are.
constexpr double loose = 0x1p-24;
constexpr double loose_focus = 0x1p-20;  // seen beside that

struct TestedSolid {
  Superquadric superquadric;
  bool loose_constants;
};

/// Sharp, smooth and flat, wider at either end; the largest semi-axis in [1, 2), as the kernels have it.
constexpr TestedSolid tested_solids[] = {
    {{{1.0, 1.5, 0.7}, {1.0, 1.0}, 19.0}, false}, {{{1.1, 0.3, 0.6}, {0.3, 1.7}, 1.0 / 19.0}, false},
    {{{0.5, 1.2, 1.9}, {1.8, 0.4}, 2.0}, true},   {{{1.2, 1.0, 1.4}, {0.05, 0.9}, 0.02}, false},
    {{{1.3, 0.9, 1.0}, {1.2, 0.8}, 0.4}, true},   {{{1.0, 1.1, 1.7}, {0.7, 1.0}, 1.001}, false}};

/// The tapered solid as the kernels know it, or, with another k, as it is: about its focus, where it is the set of w
/// with N(w) <= 1 - k^2 + k w_z / a3. Its surface is M u, u on the untapered one, M = (1 - k^2) / (1 - k u_z / a3).
class FocalSolid {
 public:
  FocalSolid(const MixedNorm<Real>& norm, Real k) : norm_(norm), k_(std::move(k)) {}

  [[nodiscard]] const MixedNorm<Real>& norm() const { return norm_; }
  [[nodiscard]] const Real& k() const { return k_; }
  [[nodiscard]] const Real& height() const { return norm_.semi_axes()[2]; }
  [[nodiscard]] Real fall() const { return 1 - k_ * k_; }

  [[nodiscard]] Vector surface(const Vector& u) const {
    return oracle::scaled<Real>(u, fall() / (1 - k_ * u[2] / height()));
  }

  /// That of the surface where the untapered one has the normal n with n.u = 1.
  [[nodiscard]] Vector normal(const Vector& n) const { return {n[0], n[1], n[2] - k_ / height()}; }

  /// max v.w, or hardly less: (1 - k^2) t for the t with h_N(v + (0, 0, k t / a3)) = t. The difference is convex and
  /// falls: chords from the left stay there.
  [[nodiscard]] Real support(const Vector& v) const {
    const auto excess = [&](const Real& t) { return norm_.support({v[0], v[1], v[2] + k_ * t / height()}) - t; };
    Real t = 0;
    for (int round = 0; round < 16; ++round) {
      const Real at = excess(t);
      const Real back = Real(1e-25) * (t + 1);
      const Real slope = (at - excess(t - back)) / back;
      if (at <= 0 || slope >= 0) break;
      t -= at / slope;
    }
    return fall() * t * (1 - Real(1e-20));
  }

  /// How deep the focus lies at least: the ball lies in the octahedron of the semi-axes.
  [[nodiscard]] Real inradius() const {
    const auto& a = norm_.semi_axes();
    const Real steepness = sqrt(1 / (a[0] * a[0]) + 1 / (a[1] * a[1]) + 1 / (a[2] * a[2]));
    return fall() / (steepness + abs(k_) / height());
  }

 private:
  MixedNorm<Real> norm_;
  Real k_;
};

/// A point of the untapered surface and its normal n, n.u = 1.
struct SurfacePoint {
  Vector u, n;
};

SurfacePoint at_direction(const Point& direction, const MixedNorm<Real>& norm) {
  const Vector x = oracle::widened(direction);
  const Vector u = oracle::scaled<Real>(x, 1 / norm.gauge(x));
  Vector n = norm.gradient({abs(u[0]), abs(u[1]), abs(u[2])}, Real(1));
  for (std::size_t i = 0; i < 3; ++i)
    if (u[i] < 0) n[i] = -n[i];
  return {u, n};
}

/// Towards anywhere, one of the axes, or the widest section.
Point direction_of(RandomCases& random) {
  Point direction = random.direction();
  const std::size_t kind = random.choice(8);
  for (std::size_t i = 0; i < 3; ++i)
    if (kind < 3 && i != kind) direction[i] *= 0.01;
  if (kind == 3) direction[2] *= 1e-3;
  return direction;
}

Point in_octant(const Point& x) {
  return {std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])};
}

Vector sum(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

double rounded_up(const Real& x) {
  const auto nearest = x.convert_to<double>();
  return Real(nearest) >= x ? nearest : std::nextafter(nearest, infinity);
}

/// Whether a direction proves the lower end that it comes with, as far as one point p of the solid tells, whose
/// distance from q is known too: h(v) >= v.p.
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

}  // namespace

struct TaperedJudge::KnownSolid {
  Primitive primitive;
  device::PrimitiveParameters parameters;
  std::array<std::vector<Sample>, 5> of_functions;
};

namespace {

using KnownParameters = device::PrimitiveParameters;

/// Draws samples of the functions for one solid.
class Drawing {
 public:
  Drawing(const Primitive& primitive, const KnownParameters& parameters, std::uint64_t seed)
      : random_(seed),
        primitive_(primitive),
        parameters_(parameters),
        posed_({primitive.superquadric.semi_axes, primitive.superquadric.exponents}, primitive.pose),
        known_(std::make_shared<FocalSolid>(posed_.norm(), Real(parameters.taper))),
        exact_(posed_.norm(), (Real(primitive.superquadric.taper) - 1) / (Real(primitive.superquadric.taper) + 1)) {}

  /// The error of coordinates about the focus.
  Sample focus() {
    const Point direction = direction_of(random_);
    const double size = random_.log_uniform(0.1, 1e3);
    const Point q{size * direction[0], size * direction[1], size * direction[2]};
    const double error = random_.choice(2) == 0 ? 0.0 : random_.log_uniform(1e-17, 1e-14);
    const Real exact = Real(q[2]) + parameters_.focus;
    const Real unavoidable = Real(error) + parameters_.taper_error;
    return {{q[0], q[1], q[2], error}, [=](const Results& found) {
              return abs(found[0] - exact) + unavoidable <= Real(found[1]) && found[2] == q[0] && found[3] == q[1];
            }};
  }

  /// The support of a tilted normal; where nothing leads along z, by the solid's support, otherwise by the point where
  /// the exact normal touches.
  Sample tilt() {
    const Real k = sided_taper();
    const std::shared_ptr<FocalSolid> own = sided(k);
    const FocalSolid& solid = *own;
    const SurfacePoint at = at_direction(in_octant(direction_of(random_)), solid.norm());
    Point n = oracle::rounded(oracle::scaled<Real>(at.n, Real(random_.log_uniform(0.1, 10.0))));
    const bool level = random_.choice(8) == 0;
    if (level) n[2] = 0.0;
    const double support = rounded_up(solid.norm().support(oracle::widened(n)));
    const Vector w = solid.surface(at.u);
    return {{n[0], n[1], n[2], support, 0.0, 0.0, 0.0, k.convert_to<double>()}, [w, level, own](const Results& found) {
              const Vector v = oracle::widened({found[2], found[3], found[4]});
              return Real(found[1]) >= (level ? own->support(v) : oracle::dot<Real>(v, w));
            }};
  }

  /// Both ends, by a contact that lies off the surface by far more than rounding.
  Sample contact() {
    const Real k = sided_taper();
    const std::shared_ptr<FocalSolid> own = sided(k);
    const FocalSolid& solid = *own;
    const SurfacePoint at = at_direction(in_octant(direction_of(random_)), solid.norm());
    const Vector w = solid.surface(at.u);
    const Vector v = solid.normal(at.n);
    const Point q = oracle::rounded(stepped(w, v, random_.log_uniform(1e-2, 10.0)));
    const double off = random_.uniform(-1e-9, 1e-9);
    const auto& a = solid.norm().semi_axes();
    const Real section = oracle::planar_norm<Real>(at.u[0] / a[0], at.u[1] / a[1], solid.norm().inner().primal);
    const auto logarithm = [off](const Real& x) { return Real(log(x)).convert_to<double>() + off; };
    return {{q[0], q[1], q[2], logarithm(at.u[0] / a[0]), logarithm(at.u[1] / a[1]), logarithm(at.u[2] / a[2]),
             logarithm(section), k.convert_to<double>()},
            [q, w, v](const Results& found) { return encloses(found, oracle::widened(q), w, v); }};
  }

  /// What is claimed without a search: no more than by the sphere and the box about the solid, one in four inside.
  Sample afar() {
    const FocalSolid& solid = *known_;
    const SurfacePoint at = at_direction(direction_of(random_), solid.norm());
    const bool inside = random_.choice(4) == 0;
    const Vector w = solid.surface(at.u);
    const double shrunk = random_.uniform(0.0, 0.9);
    Vector ideal =
        inside ? oracle::scaled<Real>(w, Real(shrunk)) : stepped(w, solid.normal(at.n), random_.log_uniform(0.1, 1e3));
    ideal[2] -= parameters_.focus;
    const Point own = oracle::rounded(ideal);
    Vector q = oracle::widened(own);
    q[2] += parameters_.focus;
    const Real most = inside ? Real((shrunk - 1) * solid.inradius() * (1 - Real(1e-9))) : from_afar(q);
    return {{own[0], own[1], own[2], 0.0}, [most, q, w](const Results& found) {
              return Real(found[0]) <= most && found[1] == infinity && proves(found, q, w);
            }};
  }

  /// The enclosure of a posed query; now and then one that overflows.
  Sample enclosure() {
    const SurfacePoint at = at_direction(direction_of(random_), exact_.norm());
    const Vector w = exact_.surface(at.u);
    const Vector v = exact_.normal(at.n);
    Vector p = w;
    p[2] -= exact_.k() * exact_.height();
    const bool inside = random_.choice(8) == 0;
    const double apart = inside ? -random_.log_uniform(1e-6, 1e-2) : random_.log_uniform(1e-2, 10.0);
    Point x = oracle::rounded(posed_.from_own_frame(stepped(p, v, apart)));
    if (random_.choice(32) == 0) {
      const double far = random_.choice(2) == 0 ? 1e200 : 1.7e308;
      x = {far, -far, far};
      return {{x[0], x[1], x[2]}, [far](const Results& found) { return found[0] < infinity && found[1] >= far; }};
    }
    const Vector q = posed_.to_own_frame(oracle::widened(x));
    return {{x[0], x[1], x[2]}, [q, p, v](const Results& found) { return encloses(found, q, p, v); }};
  }

 private:
  [[nodiscard]] Real sided_taper() { return random_.choice(2) == 0 ? known_->k() : Real(-known_->k()); }

  [[nodiscard]] std::shared_ptr<FocalSolid> sided(const Real& k) const {
    return std::make_shared<FocalSolid>(known_->norm(), k);
  }

  [[nodiscard]] static Vector stepped(const Vector& from, const Vector& v, double apart) {
    return sum(from, oracle::scaled<Real>(v, Real(apart) / oracle::length<Real>(v)));
  }

  /// The farther of the sphere about the focus and the box.
  [[nodiscard]] Real from_afar(const Vector& q) const {
    const auto& a = known_->norm().semi_axes();
    const Real wider = 1 + abs(known_->k());
    const auto beyond = [](const Real& x) { return x > 0 ? x : Real(0); };
    const Vector apart{beyond(abs(q[0]) - wider * a[0]), beyond(abs(q[1]) - wider * a[1]),
                       beyond(abs(q[2] - known_->k() * a[2]) - a[2])};
    const Real sphere = oracle::length<Real>(q) - wider * reach();
    return std::max(sphere, oracle::length<Real>(apart));
  }

  /// Of the untapered solid, at least.
  [[nodiscard]] Real reach() const {
    const auto& [axes, exponents, taper] = primitive_.superquadric;
    const auto of_two = [](const Real& a, const Real& b, double e) -> Real {
      return e >= 1.0 ? std::max(a, b) : oracle::planar_norm<Real>(a, b, 2 / (1 - Real(e)));
    };
    return of_two(of_two(Real(axes[0]), Real(axes[1]), exponents[1]), Real(axes[2]), exponents[0]);
  }

  RandomCases random_;
  Primitive primitive_;
  KnownParameters parameters_;
  oracle::PosedSolid posed_;
  std::shared_ptr<FocalSolid> known_;  ///< of the rounded k
  FocalSolid exact_;
};

KnownParameters loosened(KnownParameters parameters) {
  parameters.fall_down *= 1.0 - loose;
  parameters.fall_up *= 1.0 + loose;
  parameters.taper_error += loose_focus;
  parameters.focus += std::copysign(0.98 * loose_focus, parameters.focus);
  return parameters;
}

/// Calls `examine_tapered` for all samples of a function.
std::vector<Results> called(const CompiledKernels& kernels, cl_uint function, const std::vector<Sample>& of_function,
                            KnownParameters parameters) {
  Columns columns(operand_count);
  for (const Sample& sample : of_function)
    for (std::size_t i = 0; i < operand_count; ++i) columns[i].push_back(sample.operands[i]);
  const cl::Buffer operands = uploaded(kernels, columns);
  const cl::Buffer primitive(kernels.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof parameters, &parameters);
  const std::size_t stride = of_function.size();
  const cl::Buffer output = zeros(kernels, result_count * stride);
  const cl_ulong groups = stride / static_cast<std::size_t>(kernels.vector_width);
  cl::Kernel kernel(kernels.program, "examine_tapered");
  kernel.setArg(0, function);
  kernel.setArg(1, groups);
  kernel.setArg(2, operands);
  kernel.setArg(3, cl_ulong{stride});
  kernel.setArg(4, primitive);
  kernel.setArg(5, output);
  const cl::CommandQueue queue(kernels.context, kernels.device);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups));
  const std::vector<double> numbers = read(queue, output, result_count * stride);
  std::vector<Results> results(stride);
  for (std::size_t n = 0; n < stride; ++n)
    for (std::size_t i = 0; i < result_count; ++i) results[n][i] = numbers[i * stride + n];
  return results;
}

constexpr std::array<const char*, 5> functions{"about_focus", "tilted_up", "distance_by_tapered_contact",
                                               "enclosure_from_afar", "enclosure_at"};

}  // namespace

TaperedJudge::TaperedJudge() {
  std::uint64_t seed = 0;
  for (const auto& [superquadric, loose_constants] : tested_solids) {
    const Primitive primitive{"", superquadric, {{1.0, 2.0, 3.0}, {0.3, 0.5, -0.7, 0.2}}};
    const KnownParameters parameters = device::primitive_parameters(primitive, 0);
    KnownSolid& known = solids_.emplace_back(KnownSolid{primitive, parameters, {}});
    if (loose_constants) known.parameters = loosened(parameters);
    Drawing drawing(primitive, parameters, ++seed);
    for (std::size_t i = 0; i < samples; ++i) {
      known.of_functions[0].push_back(drawing.focus());
      known.of_functions[1].push_back(drawing.tilt());
      known.of_functions[2].push_back(drawing.contact());
      known.of_functions[3].push_back(drawing.afar());
      known.of_functions[4].push_back(drawing.enclosure());
    }
  }
}

TaperedJudge::~TaperedJudge() = default;

std::string TaperedJudge::sources() {
  return std::string(kernels::embedded_tapered_sources()) + examination;
}

std::string TaperedJudge::false_claim(const CompiledKernels& kernels) const {
  for (const KnownSolid& known : solids_) {
    for (cl_uint function = 0; function < functions.size(); ++function) {
      const std::vector<Sample>& of_function = known.of_functions[function];
      const std::vector<Results> results = called(kernels, function, of_function, known.parameters);
      for (std::size_t n = 0; n < results.size(); ++n) {
        if (of_function[n].holds(results[n])) continue;
        const Operands& o = of_function[n].operands;
        const Results& r = results[n];
        return fmt::format(
            "{}, taper {:.3g}, of ({:.17g}, {:.17g}, {:.17g}), ... claims [{:.17g}, {:.17g}] by "
            "({:.17g}, {:.17g}, {:.17g})",
            functions[function], known.primitive.superquadric.taper, o[0], o[1], o[2], r[0], r[1], r[2], r[3], r[4]);
      }
    }
  }
  return {};
}

}  // namespace verisq::mutation
