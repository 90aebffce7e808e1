/// This file implements the points and normals that are known, and the comparison.
#include "tests/mutation/unbent_judge.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <verisq/enclosure.hpp>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/examination.hpp"
#include "tests/mutation/focal_solid.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::mutation {
namespace {

using oracle::RandomCases;
using oracle::Real;
using Vector = oracle::Vector;

constexpr std::size_t samples = 512;  // of each function and solid
constexpr double interval = 0x1p-20;  // relative width of those whose far ends the operands are

constexpr const char* entry_point = R"(
ALWAYS_INLINE interval3 up_to(vector3 x, real width) {
  const vector3 y = {x.x * (1.0 - width), x.y * (1.0 - width), x.z * (1.0 - width)};
  const interval3 box = {interval_hull(interval_of(x.x, x.x), interval_of(y.x, y.x)),
                         interval_hull(interval_of(x.y, x.y), interval_of(y.y, y.y)),
                         interval_hull(interval_of(x.z, x.z), interval_of(y.z, y.z))};
  return box;
}
kernel void examine_unbent(uint function, ulong groups, global const double* operands, ulong stride,
                           constant const superquadric* s, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 w = {LOAD(group, operands), LOAD(group, operands + stride), LOAD(group, operands + 2 * stride)};
  const real width = LOAD(group, operands + 3 * stride);
  const vector3 v = {LOAD(group, operands + 4 * stride), LOAD(group, operands + 5 * stride),
                     LOAD(group, operands + 6 * stride)};
  const real found = function == 0 ? excess_up_at(up_to(w, width), s)
                                   : support_over_up(up_to(v, width), up_to(w, width), s);
  STORE(found, group, results);
}
)";

constexpr std::array<const char*, 2> functions{"excess_up_at", "support_over_up"};

/// Draws samples for one solid.
class Drawing {
 public:
  Drawing(const Superquadric& superquadric, const device::PrimitiveParameters& parameters, std::uint64_t seed)
      : random_(seed),
        solid_(oracle::MixedNorm<Real>({superquadric.semi_axes, superquadric.exponents}), Real(parameters.taper)) {}

  /// At the surface, or hardly off it.
  Sample point() {
    const auto [u, n] = at_direction(direction_of(random_), solid_.norm());
    const double off = random_.choice(4) == 0 ? 0.0 : random_.log_uniform(1e-16, 1e-6);
    const Real longer = random_.choice(2) == 0 ? Real(1) + off : Real(1) - off;
    const Point w = oracle::rounded(oracle::scaled<Real>(solid_.surface(u), longer));
    const Real gauge = gauge_of(oracle::widened(w));
    return {{w[0], w[1], w[2], width()}, [gauge](const Results& found) { return (1 - Real(found[0])) * gauge <= 1; }};
  }

  /// Where a normal touches the surface, or near there.
  Sample normal() {
    const auto [u, n] = at_direction(direction_of(random_), solid_.norm());
    const Real length = random_.log_uniform(1e-6, 1e3);
    const Point v = oracle::rounded(oracle::scaled<Real>(solid_.normal(n), length));
    const double share = random_.choice(2) == 0 ? 1.0 : random_.uniform(0.5, 1.0);
    const Point w = oracle::rounded(oracle::scaled<Real>(solid_.surface(u), Real(share)));
    const Real least = solid_.support(oracle::widened(v));
    return {{w[0], w[1], w[2], width(), v[0], v[1], v[2]},
            [least](const Results& found) { return Real(found[0]) >= least; }};
  }

 private:
  double width() { return random_.choice(2) == 0 ? 0.0 : interval; }

  [[nodiscard]] Real gauge_of(const Vector& w) const {
    return (solid_.norm().gauge(w) - solid_.k() * w[2] / solid_.height()) / solid_.fall();
  }

  RandomCases random_;
  FocalSolid solid_;
};

}  // namespace

struct UnbentJudge::KnownSolid {
  double taper;
  device::PrimitiveParameters parameters;
  std::array<std::vector<Sample>, functions.size()> of_functions;
};

UnbentJudge::UnbentJudge() {
  std::uint64_t seed = 500;
  for (const auto& [superquadric, loose_constants] : tested_solids) {
    const device::PrimitiveParameters parameters = device::primitive_parameters({"", superquadric, {}}, 0);
    KnownSolid& known =
        solids_.emplace_back(KnownSolid{superquadric.taper, loose_constants ? loosened(parameters) : parameters, {}});
    Drawing drawing(superquadric, parameters, ++seed);
    for (std::size_t i = 0; i < samples; ++i) {
      known.of_functions[0].push_back(drawing.point());
      known.of_functions[1].push_back(drawing.normal());
    }
  }
}

UnbentJudge::~UnbentJudge() = default;

std::string UnbentJudge::examination() {
  return entry_point;
}

std::string UnbentJudge::false_claim(const CompiledKernels& kernels) const {
  for (const KnownSolid& known : solids_) {
    for (cl_uint function = 0; function < functions.size(); ++function) {
      const std::vector<Sample>& of_function = known.of_functions[function];
      const std::vector<Results> results = called(kernels, "examine_unbent", function, of_function, known.parameters);
      for (std::size_t n = 0; n < results.size(); ++n)
        if (!of_function[n].holds(results[n]))
          return fmt::format("{}, taper {:.3g}, {}", functions[function], known.taper,
                             described(of_function[n].operands, results[n]));
    }
  }
  return {};
}

}  // namespace verisq::mutation
