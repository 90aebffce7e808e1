/// This file implements the points that are known, the launch, and the comparison.
#include "tests/mutation/tapered_cube_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <verisq/enclosure.hpp>

#include "host/device/primitive_parameters.hpp"
#include "host/device/solid_model.hpp"
#include "tests/mutation/focal_solid.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/tapered_contact.hpp"

namespace verisq::mutation {
namespace {

using oracle::RandomCases;
using oracle::Real;
using oracle::TaperedSolid;

constexpr std::size_t cubes_of_solid = 3072;

constexpr const char* examination = R"(
kernel void examine_cubes(ulong groups, ulong stride, global const double* cubes,
                          constant const box_primitive* primitives, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const cube x = {{LOAD(group, cubes), LOAD(group, cubes + stride), LOAD(group, cubes + 2 * stride)},
                  LOAD(group, cubes + 3 * stride)};
  constant const superquadric* s = &primitives->solid;
  const local_map y = focal_map(x, primitives);
  const vector3 gradient = gauge_gradient(y, s);
  const colour c = primitive_colour(x, primitives);
  const half_space inside = inside_half_space(y, x.half_width, gradient, s);
  const half_space outside = outside_half_space(y, x.half_width, local_extents(y, x.half_width), gradient, s);
  const real columns[10] = {TO_REAL(c.black), TO_REAL(c.white), inside.normal.x, inside.normal.y, inside.normal.z,
                            inside.offset, outside.normal.x, outside.normal.y, outside.normal.z, outside.offset};
  for (uint i = 0; i < 10; ++i) STORE(columns[i], group, results + i * stride);
}
)";

/// Columns of the results; four for a half-space.
enum Column : std::size_t { black = 0, white = 1, inside_plane = 2, outside_plane = 6, all_columns = 10 };

/// A cube with a point of it.
struct Witness {
  Point centre;
  double half_width;
  Point point;
  bool inside;  ///< the solid, without its boundary; outside otherwise
};

/// The least half-width, rounded up, with which the cube holds its point.
double least_half_width(const Witness& w) {
  Real apart = 0;
  for (std::size_t i = 0; i < 3; ++i) apart = std::max<Real>(apart, abs(Real(w.point[i]) - w.centre[i]));
  const auto nearest = apart.convert_to<double>();
  return nearest < apart ? std::nextafter(nearest, 2.0) : nearest;
}

/// A point hardly beside the surface in a corner, on a face, or anywhere in a cube; corners in all directions from it,
/// and most of all where a cube that is not cut has them.
Witness witness(RandomCases& random, const TaperedSolid& solid) {
  const oracle::SurfacePoint foot = solid.surface(direction_of(random));
  Witness w{};
  const double apart = random.log_uniform(1e-15, 1e-9) * (random.choice(2) == 0 ? 1.0 : -1.0);
  w.point = oracle::rounded(stepped(foot.point, foot.normal, apart));
  w.inside = solid.contains(oracle::widened(w.point));
  w.half_width = random.log_uniform(random.choice(2) == 0 ? 1e-9 : 1e-3, 1.0);
  const std::size_t kind = random.choice(4);
  for (std::size_t i = 0; i < 3; ++i) {
    const double outward = foot.normal[i] > 0 ? 1.0 : -1.0;
    double share = w.inside ? -outward : outward;  // the corner nearest to the solid's middle, or farthest from it
    if (kind == 1 && random.choice(2) == 0) share = -share;
    if (kind == 2 && i == 2) share = random.uniform(-1.0, 1.0);
    if (kind == 3) share = random.uniform(-1.0, 1.0);
    w.centre[i] = w.point[i] - share * w.half_width;
  }
  if (random.choice(16) == 0) {
    w.centre = w.point;
    w.half_width = 0.0;
  }
  w.half_width = std::max(w.half_width, least_half_width(w));
  return w;
}

/// Whether a half-space of the results has the point: at 200 bits.
bool contains(const Columns& found, std::size_t first, std::size_t n, const Witness& w) {
  if (found[first + 3][n] == infinity) return true;
  Real height = 0;
  for (std::size_t i = 0; i < 3; ++i) height += Real(found[first + i][n]) * (Real(w.point[i]) - w.centre[i]);
  return height <= found[first + 3][n];
}

std::string fault(const Columns& found, std::size_t n, const Witness& w) {
  if (!w.inside && found[black][n] != 0.0) return "black";
  if (w.inside && found[white][n] != 0.0) return "white";
  if (w.inside && !contains(found, inside_plane, n, w)) return "half-space";
  if (!w.inside && !contains(found, outside_plane, n, w)) return "half-space of the complement";
  return {};
}

/// Not turned and about the origin, where every coordinate is exact; and in any pose.
constexpr std::array poses{Pose{}, Pose{{1.0, 2.0, 3.0}, {0.3, 0.5, -0.7, 0.2}}};

Columns examined(const CompiledKernels& kernels, const std::vector<Witness>& witnesses,
                 device::BoxPrimitiveParameters parameters) {
  const std::size_t length = padded(witnesses.size(), kernels);
  Columns cubes(4);
  for (std::size_t n = 0; n < length; ++n) {
    const Witness& w = witnesses[std::min(n, witnesses.size() - 1)];
    for (std::size_t i = 0; i < 3; ++i) cubes[i].push_back(w.centre[i]);
    cubes[3].push_back(w.half_width);
  }
  const cl::Buffer primitive(kernels.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof parameters, &parameters);
  const cl::Buffer operands = uploaded(kernels, cubes);
  const cl::Buffer results = zeros(kernels, all_columns * length);
  const cl_ulong groups = length / static_cast<std::size_t>(kernels.vector_width);
  cl::Kernel kernel(kernels.program, "examine_cubes");
  kernel.setArg(0, groups);
  kernel.setArg(1, cl_ulong{length});
  kernel.setArg(2, operands);
  kernel.setArg(3, primitive);
  kernel.setArg(4, results);
  const cl::CommandQueue queue(kernels.context, kernels.device);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups));
  const std::vector<double> numbers = read(queue, results, all_columns * length);
  Columns found;
  for (std::size_t i = 0; i < all_columns; ++i) {
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(i * length);
    found.emplace_back(first, first + static_cast<std::ptrdiff_t>(length));
  }
  return found;
}

}  // namespace

struct TaperedCubeJudge::KnownSolid {
  Primitive primitive;
  device::BoxPrimitiveParameters parameters;
  std::vector<Witness> witnesses;
};

TaperedCubeJudge::TaperedCubeJudge() {
  std::uint64_t seed = 300;
  for (const Pose& pose : poses) {
    for (const auto& [superquadric, loose_constants] : tested_solids) {
      const Primitive primitive{"", superquadric, pose};
      KnownSolid& known =
          solids_.emplace_back(KnownSolid{primitive, device::box_primitive_parameters(primitive, 0), {}});
      const bool turned = pose.quaternion[0] != 1.0;
      if (loose_constants) known.parameters = turned ? with_wide_bounds(primitive) : with_other_taper(primitive);
      RandomCases random(++seed);
      const TaperedSolid solid(primitive);
      for (std::size_t n = 0; n < cubes_of_solid; ++n) known.witnesses.push_back(witness(random, solid));
    }
  }
}

TaperedCubeJudge::~TaperedCubeJudge() = default;

std::string TaperedCubeJudge::sources() {
  const Model model{"", {{"", tested_solids[0].superquadric, {}}}, {}};
  return device::model_source(model, examination);
}

std::string TaperedCubeJudge::false_claim(const CompiledKernels& kernels) const {
  for (const KnownSolid& known : solids_) {
    const Columns found = examined(kernels, known.witnesses, known.parameters);
    for (std::size_t n = 0; n < known.witnesses.size(); ++n) {
      const Witness& w = known.witnesses[n];
      const std::string what = fault(found, n, w);
      if (what.empty()) continue;
      return fmt::format("taper {:.3g}, cube of {:.3g} about ({:.17g}, {:.17g}, {:.17g}): {}",
                         known.primitive.superquadric.taper, w.half_width, w.centre[0], w.centre[1], w.centre[2], what);
    }
  }
  return {};
}

TaperedCubeJudge::Shares TaperedCubeJudge::shares(const CompiledKernels& kernels) const {
  std::size_t points = 0;
  std::size_t colours = 0;
  std::size_t cubes = 0;
  std::size_t half_spaces = 0;
  for (const KnownSolid& known : solids_) {
    const Columns found = examined(kernels, known.witnesses, known.parameters);
    for (std::size_t n = 0; n < known.witnesses.size(); ++n) {
      const auto& [centre, half_width, point, inside] = known.witnesses[n];
      if (half_width == 0.0) {
        ++points;
        colours += found[inside ? black : white][n] != 0.0 ? 1 : 0;
      } else {
        ++cubes;
        half_spaces += found[(inside ? inside_plane : outside_plane) + 3][n] < infinity ? 1 : 0;
      }
    }
  }
  return {static_cast<double>(colours) / static_cast<double>(points),
          static_cast<double>(half_spaces) / static_cast<double>(cubes)};
}

}  // namespace verisq::mutation
