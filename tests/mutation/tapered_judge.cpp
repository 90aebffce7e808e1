/// This file implements the points that are known, the launches of the functions, and the comparison.
#include "tests/mutation/tapered_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <verisq/enclosure.hpp>

#include "host/device/primitive_parameters.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/mutation/examination.hpp"
#include "tests/mutation/focal_solid.hpp"
#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::mutation {
namespace {

using oracle::MixedNorm;
using oracle::RandomCases;
using oracle::Real;
using Vector = oracle::Vector;

constexpr std::size_t samples = 256;  // of each function and solid

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
    default: found = enclosure_at(to_local(a, s), s); break;
  }
  STORE(found.lo, group, results);
  STORE(found.hi, group, results + stride);
  STORE(found.normal.x, group, results + 2 * stride);
  STORE(found.normal.y, group, results + 3 * stride);
  STORE(found.normal.z, group, results + 4 * stride);
}
)";

Point in_octant(const Point& x) {
  return {std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])};
}

double rounded_up(const Real& x) {
  const auto nearest = x.convert_to<double>();
  return Real(nearest) >= x ? nearest : std::nextafter(nearest, infinity);
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
      const std::vector<Results> results = called(kernels, "examine_tapered", function, of_function, known.parameters);
      for (std::size_t n = 0; n < results.size(); ++n) {
        if (of_function[n].holds(results[n])) continue;
        return fmt::format("{}, taper {:.3g}, {}", functions[function], known.primitive.superquadric.taper,
                           described(of_function[n].operands, results[n]));
      }
    }
  }
  return {};
}

}  // namespace verisq::mutation
