/// This file implements the points that are known, the launches of the solid kernels, and the comparison.
#include "tests/mutation/solid_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>

#include "host/device/primitive_parameters.hpp"
#include "host/device/solid_model.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/mutation/focal_solid.hpp"
#include "tests/mutation/launch.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/placed_model.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {
namespace {

using oracle::Membership;
using oracle::PlacedModel;
using oracle::PlacedPrimitive;
using oracle::RandomCases;
using Witness = SolidJudge::Witness;

constexpr std::size_t primitive_count = 2;
constexpr int witnesses_of_scene = 2400;
constexpr double beside_boundary =
    1e-10;                          // of the gauge: far above the rounding, far below what arithmetics make of it
constexpr double rounding = 1e-12;  // of what is computed here, in units of the device
constexpr double search_tolerance = 1e-4;
constexpr double truth_tolerance = 1e-7;
constexpr cl_uint round_limit = 300;

constexpr const char* examination = R"(
ALWAYS_INLINE void put(global double* results, ulong stride, ulong group, uint* column, real value) {
  STORE(value, group, results + *column * stride);
  ++*column;
}
ALWAYS_INLINE void put_plane(global double* results, ulong stride, ulong group, uint* column, half_space h) {
  put(results, stride, group, column, h.normal.x);
  put(results, stride, group, column, h.normal.y);
  put(results, stride, group, column, h.normal.z);
  put(results, stride, group, column, h.offset);
}
kernel void examine_cubes(ulong groups, ulong stride, global const double* cubes,
                          constant const box_primitive* primitives, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const cube x = {{LOAD(group, cubes), LOAD(group, cubes + stride), LOAD(group, cubes + 2 * stride)},
                  LOAD(group, cubes + 3 * stride)};
  const vector3 query = {LOAD(group, cubes + 4 * stride), LOAD(group, cubes + 5 * stride),
                         LOAD(group, cubes + 6 * stride)};
  const cut_query relative = {between(x.centre, query), x.half_width, REAL(0.0), false};
  uint column = 0;
  for (uint i = 0; i < PRIMITIVES; ++i) {
    local_map y;
    if (i == 0) y = bent_focal_map(x, primitives); else y = focal_map(x, primitives + i);
    constant const superquadric* s = &primitives[i].solid;
    const vector3 extents = local_extents(y, x.half_width);
    const vector3 gradient = gauge_gradient(y, s);
    const colour c = colour_of(y, extents, primitives + i);
    put(results, stride, group, &column, TO_REAL(c.black));
    put(results, stride, group, &column, TO_REAL(c.white));
    put_plane(results, stride, group, &column, inside_half_space(y, x.half_width, gradient, s));
    put_plane(results, stride, group, &column, outside_half_space(y, x.half_width, extents, gradient, s));
  }
  const decided nothing = {0, 0};
  const double least[PRIMITIVES] = {0.0, 0.0};
  for (uint outside = 0; outside < 2; ++outside) {
    colour colours[PRIMITIVES];
    integer matters[PRIMITIVES];
    forget_colours(colours);
    none_matter(matters);
    const visit v = {x, relative, outside == 1, nothing, least, least, primitives, colours};
    const node n = solid_node(&v);
    solid_colour(colours, matters);
    const decided_lanes more = simplified(colours, matters);
    put(results, stride, group, &column, TO_REAL(n.colour.black));
    put(results, stride, group, &column, TO_REAL(n.colour.white));
    put(results, stride, group, &column, n.lower);
    put_plane(results, stride, group, &column, n.plane);
    put(results, stride, group, &column, TO_REAL(more.black));
    put(results, stride, group, &column, TO_REAL(more.white));
  }
}
kernel void examine_tangents(ulong groups, ulong stride, global const double* pairs,
                             constant const box_primitive* primitives, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  interval axes[4];
  for (uint i = 0; i < 4; ++i) axes[i] = interval_of(LOAD(group, pairs + i * stride), LOAD(group, pairs + i * stride));
  const unbent x = unbend(axes[0], axes[1], primitives->curvature);
  const unbent q = unbend(axes[2], axes[3], primitives->curvature);
  STORE(TO_REAL(above_tangent(x, q, LOAD(group, pairs + 4 * stride), primitives)), group, results);
}
)";

constexpr std::size_t columns_of_primitive = 10;
constexpr std::size_t columns_of_target = 9;
constexpr std::size_t first_of_targets = primitive_count * columns_of_primitive;
constexpr std::size_t all_columns = first_of_targets + 2 * columns_of_target;

double norm(const Point& a) {
  return std::hypot(a[0], a[1], a[2]);
}
Point between(const Point& from, const Point& to) {
  return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}
Point moved(const Point& x, const Point& direction, double distance) {
  return {x[0] + distance * direction[0], x[1] + distance * direction[1], x[2] + distance * direction[2]};
}

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
  const double length = norm(n);
  return {n[0] / length, n[1] / length, n[2] / length};
}

/// With the point anywhere in it, at times in a corner.
void place_cube(RandomCases& random, Witness& w) {
  w.half_width = random.log_uniform(random.choice(2) == 0 ? 1e-7 : 1e-2, 1.0);
  const bool corner = random.choice(2) == 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double share = corner ? (random.choice(2) == 0 ? 1.0 - 1e-9 : -1.0 + 1e-9) : random.uniform(-1.0, 1.0);
    w.centre[k] = w.point[k] + share * w.half_width;
  }
}

/// Of such a size that the point is on its border.
void place_cube_about(RandomCases& random, const Point& centre, Witness& w) {
  w.half_width = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    w.centre[k] = centre[k] + 1e-3 * random.uniform(-1.0, 1.0);
    w.half_width = std::max(w.half_width, (1.0 + 1e-9) * std::abs(w.point[k] - w.centre[k]));
  }
}

/// By the nearest of all points.
void bound_bent_distances(const PlacedPrimitive& bent, std::vector<Witness>& witnesses) {
  std::vector<Point> points;
  for (const Witness& w : witnesses)
    if (bent.membership(w.point) == Membership::inside) points.push_back(w.point);
  for (Witness& w : witnesses) {
    w.bent_upper = infinity;
    for (const Point& x : points) w.bent_upper = std::min(w.bent_upper, norm(between(x, w.query)));
  }
}

/// Just beside the boundary of a primitive, on either side, or anywhere near it, in cubes of many sizes.
std::vector<Witness> witnesses(const Model& model, std::uint64_t seed) {
  const PlacedModel placed(model);
  RandomCases random(seed);
  std::vector<Witness> all;
  for (int i = 0; i < witnesses_of_scene; ++i) {
    const PlacedPrimitive& solid = placed.primitives()[random.choice(primitive_count)];
    const oracle::BoundaryPoint foot = random.boundary_point(solid.primitive().superquadric);
    const double gauge = random.choice(8) == 0 ? random.uniform(0.2, 1.4)
                                               : 1.0 + (random.choice(2) == 0 ? beside_boundary : -beside_boundary);
    Witness w{};
    w.point = solid.placed({gauge * foot.point[0], gauge * foot.point[1], gauge * foot.point[2]});
    place_cube(random, w);
    if (random.choice(16) == 0) place_cube_about(random, solid.centre(), w);
    const Point direction = random.choice(2) == 0 ? normal_at(solid, w.point) : random.direction();
    w.query = moved(w.point, direction, (random.choice(4) == 0 ? -1.0 : 1.0) * random.log_uniform(1e-6, 1e4));
    all.push_back(w);
  }
  bound_bent_distances(placed.primitives()[0], all);
  return all;
}

/// What the kernel gave for one cube.
class Claims {
 public:
  Claims(const std::vector<std::vector<double>>& columns, std::size_t row) : columns_(columns), row_(row) {}

  [[nodiscard]] double operator[](std::size_t column) const { return columns_[column][row_]; }
  [[nodiscard]] bool mask(std::size_t column) const { return (*this)[column] != 0.0; }
  /// Whether the half-space in four columns has the point; NaN has none.
  [[nodiscard]] bool contains(std::size_t first, const Witness& w) const {
    const double offset = (*this)[first + 3];
    if (offset == infinity) return true;
    double height = 0.0;
    for (std::size_t k = 0; k < 3; ++k) height += (*this)[first + k] * (w.point[k] - w.centre[k]);
    const double size = std::abs((*this)[first]) + std::abs((*this)[first + 1]) + std::abs((*this)[first + 2]);
    return height <= offset + rounding * size;
  }

 private:
  const std::vector<std::vector<double>>& columns_;
  std::size_t row_;
};

std::string primitive_fault(const Claims& claims, std::size_t i, const Witness& w, Membership place) {
  const std::size_t first = i * columns_of_primitive;
  if (claims.mask(first) && place == Membership::outside) return "black";
  if (claims.mask(first + 1) && place == Membership::inside) return "white";
  if (place == Membership::inside && !claims.contains(first + 2, w)) return "half-space";
  if (place == Membership::outside && !claims.contains(first + 6, w)) return "half-space of the complement";
  return {};
}

/// `place` is the point's in the target.
std::string target_fault(const Claims& claims, std::size_t first, const Witness& w, Membership place) {
  if (claims.mask(first) && place == Membership::outside) return "black";
  if (place != Membership::inside) return {};
  if (claims.mask(first + 1)) return "white";
  if (!(claims[first + 2] <= (1.0 + rounding) * norm(between(w.point, w.query)) + rounding)) return "lower bound";
  if (!claims.contains(first + 3, w)) return "half-space";
  return {};
}

/// Decided primitives may be replaced by nothing and everything: the point's place must not change.
std::string decision_fault(const Claims& claims, std::size_t first, const std::vector<Membership>& places) {
  const auto bits = [&](std::size_t column) { return static_cast<unsigned>(static_cast<long>(claims[column])); };
  std::vector<Membership> replaced = places;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if ((bits(first) >> i & 1U) != 0) replaced[i] = Membership::inside;
    if ((bits(first + 1) >> i & 1U) != 0) replaced[i] = Membership::outside;
  }
  const auto in_model = [](const std::vector<Membership>& p) { return std::min(p[0], oracle::complement(p[1])); };
  const Membership was = in_model(places);
  const Membership is = in_model(replaced);
  return was != Membership::boundary && is != Membership::boundary && was != is ? "decided primitives" : "";
}

std::string cube_fault(const Claims& claims, const PlacedModel& placed, const Witness& w) {
  std::vector<Membership> places;
  for (std::size_t i = 0; i < primitive_count; ++i) {
    places.push_back(placed.primitives()[i].membership(w.point));
    const std::string fault = primitive_fault(claims, i, w, places.back());
    if (!fault.empty()) return fmt::format("primitive {}, {}", i, fault);
  }
  const Membership place = std::min(places[0], oracle::complement(places[1]));
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t first = first_of_targets + side * columns_of_target;
    std::string fault = target_fault(claims, first, w, side == 0 ? place : oracle::complement(place));
    if (fault.empty()) fault = decision_fault(claims, first + 7, places);
    if (!fault.empty()) return fmt::format("{}, {}", side == 0 ? "solid" : "complement", fault);
  }
  return {};
}

cl::Buffer loose_primitives(const CompiledKernels& kernels, const Model& model) {
  std::vector<device::BoxPrimitiveParameters> parameters;
  for (const Primitive& primitive : model.primitives) parameters.push_back(with_other_taper(primitive));
  return {kernels.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, parameters.size() * sizeof parameters.front(),
          parameters.data()};
}

class Launcher {
 public:
  Launcher(const CompiledKernels& kernels, const SolidScene& scene)
      : kernels_(kernels),
        queue_(kernels.context, kernels.device),
        primitives_(scene.loose_constants ? loose_primitives(kernels, scene.model)
                                          : device::uploaded_box_primitives(kernels, scene.model, 0)),
        root_(device::root_cube(scene.model, 0)) {}

  [[nodiscard]] Columns examined(const std::vector<Witness>& witnesses) const {
    const std::size_t length = padded(witnesses.size(), kernels_);
    Columns cubes(7);
    for (std::size_t n = 0; n < length; ++n) {
      const Witness& w = witnesses[std::min(n, witnesses.size() - 1)];
      for (std::size_t k = 0; k < 3; ++k) cubes[k].push_back(w.centre[k]);
      cubes[3].push_back(w.half_width);
      for (std::size_t k = 0; k < 3; ++k) cubes[4 + k].push_back(w.query[k]);
    }
    const cl::Buffer results = zeros(kernels_, all_columns * length);
    run("examine_cubes", groups_of(length), groups_of(length), cl_ulong{length}, uploaded(kernels_, cubes), primitives_,
        results);
    return split(results, all_columns, length);
  }

  /// Lower and upper ends, normals.
  [[nodiscard]] Columns bent(const std::vector<Point>& points) const {
    const std::size_t length = padded(points.size(), kernels_);
    const auto axes = uploaded_axes(points, length);
    std::array<cl::Buffer, 5> results;
    for (cl::Buffer& column : results) column = zeros(kernels_, length);
    const cl::Buffer listed = zeros(kernels_, length);
    const std::size_t blocks = (groups_of(length) + groups_per_block - 1) / groups_per_block;
    run("bent_distance", blocks, groups_of(length), groups_per_block, axes[0], axes[1], axes[2], primitives_,
        cl_uint{0}, listed, results[0], results[1], results[2], results[3], results[4]);
    Columns columns;
    for (const cl::Buffer& column : results) columns.push_back(read(queue_, column, length));
    return columns;
  }

  /// Of points and queries R, Z, R, Z in the plane of the bend, and bounds of a distance: what is said of the tangent
  /// plane.
  [[nodiscard]] std::vector<double> tangents(const Columns& pairs) const {
    const std::size_t length = pairs.front().size();
    const cl::Buffer results = zeros(kernels_, length);
    run("examine_tangents", groups_of(length), groups_of(length), cl_ulong{length}, uploaded(kernels_, pairs),
        primitives_, results);
    return read(queue_, results, length);
  }

  /// `of_primitives` are five columns of all primitives, one after the other.
  [[nodiscard]] std::vector<Enclosure> searched(const std::vector<Point>& points, const Columns& of_primitives) const {
    const std::size_t length = padded(points.size(), kernels_);
    const auto axes = uploaded_axes(points, length);
    std::vector<cl::Buffer> parts;
    for (const std::vector<double>& column : of_primitives) parts.push_back(uploaded(kernels_, Columns{column}));
    const std::array ends{uploaded(kernels_, Columns{std::vector<double>(length, -infinity)}),
                          uploaded(kernels_, Columns{std::vector<double>(length, infinity)})};
    run("solid_distance", points.size(), cl_ulong{points.size()}, cl_ulong{length}, axes[0], axes[1], axes[2],
        primitives_, root_.centre[0], root_.centre[1], root_.centre[2], root_.half_width, search_tolerance, round_limit,
        parts[0], parts[1], parts[2], parts[3], parts[4], ends[0], ends[1]);
    const std::vector<double> los = read(queue_, ends[0], points.size());
    const std::vector<double> his = read(queue_, ends[1], points.size());
    std::vector<Enclosure> found;
    for (std::size_t n = 0; n < points.size(); ++n) found.push_back({los[n], his[n]});
    return found;
  }

 private:
  [[nodiscard]] cl_ulong groups_of(std::size_t length) const {
    return length / static_cast<std::size_t>(kernels_.vector_width);
  }

  [[nodiscard]] std::array<cl::Buffer, 3> uploaded_axes(const std::vector<Point>& points, std::size_t length) const {
    std::array<cl::Buffer, 3> axes;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> column;
      for (std::size_t n = 0; n < length; ++n) column.push_back(points[std::min(n, points.size() - 1)][k]);
      axes[k] = uploaded(kernels_, Columns{column});
    }
    return axes;
  }

  [[nodiscard]] Columns split(const cl::Buffer& buffer, std::size_t count, std::size_t length) const {
    const std::vector<double> numbers = read(queue_, buffer, count * length);
    Columns columns;
    for (std::size_t c = 0; c < count; ++c)
      columns.emplace_back(numbers.begin() + static_cast<std::ptrdiff_t>(c * length),
                           numbers.begin() + static_cast<std::ptrdiff_t>((c + 1) * length));
    return columns;
  }

  template <class... Arguments>
  void run(const char* name, std::size_t work_items, const Arguments&... arguments) const {
    cl::Kernel kernel(kernels_.program, name);
    cl_uint next = 0;
    (kernel.setArg(next++, arguments), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(work_items));
    queue_.finish();  // a kernel does not keep the buffers that it is given
  }

  const CompiledKernels& kernels_;
  cl::CommandQueue queue_;
  cl::Buffer primitives_;
  verify::Cube root_;
};

/// NaN misses everything.
bool misses(const Enclosure& claimed, const Enclosure& truth) {
  return !(claimed.lo <= truth.hi + rounding && claimed.hi >= truth.lo - rounding);
}

std::string described(const Point& x, const Enclosure& claimed, const Enclosure& truth) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g}) gave [{:.17g}, {:.17g}], the truth is in [{:.17g}, {:.17g}]", x[0],
                     x[1], x[2], claimed.lo, claimed.hi, truth.lo, truth.hi);
}

/// A lower end of `bent_distance` beyond a point of the solid.
std::string bent_fault(const Launcher& launcher, const std::vector<Witness>& witnesses) {
  std::vector<Point> queries;
  queries.reserve(witnesses.size());
  for (const Witness& w : witnesses) queries.push_back(w.query);
  const Columns found = launcher.bent(queries);
  for (std::size_t n = 0; n < witnesses.size(); ++n) {
    const double upper = witnesses[n].bent_upper;
    if (!(found[0][n] <= (1.0 + rounding) * upper + rounding))
      return fmt::format("bent, lower end: {}", described(queries[n], {found[0][n], found[1][n]}, {0.0, upper}));
  }
  return {};
}

/// A point and a query in the plane of a bend by their polar coordinates about its centre, in units of its radius.
struct PolarPair {
  double w_0, gamma_0, w_q, gamma_q;
  double reach;  ///< in the same units: no point farther from the query counts
};

PolarPair random_pair(RandomCases& random, double largest_angle) {
  const double gamma_0 = std::clamp(1.2 * largest_angle * random.uniform(-1.0, 1.0), -3.1, 3.1);
  const double gamma_q =
      random.choice(2) == 0 ? random.uniform(-3.1, 3.1) : std::clamp(gamma_0 + random.uniform(-0.8, 0.8), -3.1, 3.1);
  return {random.uniform(0.05, 2.0), gamma_0, random.log_uniform(0.01, 10.0), gamma_q,
          random.choice(2) == 0 ? infinity : random.log_uniform(0.01, 10.0)};
}

/// Whether there is a point with this angle in reach of the query.
bool in_reach(const PolarPair& pair, double gamma) {
  const double apart = gamma - pair.gamma_q;
  const double least = std::cos(apart) > 0.0 ? pair.w_q * std::fabs(std::sin(apart)) : pair.w_q;
  return least < (1.0 - rounding) * pair.reach;
}

/// By how much f exceeds its tangent plane at the angle gamma where that is least (verify/search/bent_distance.hpp).
double excess(const PolarPair& pair, double gamma) {
  const double apart = pair.gamma_0 - pair.gamma_q;
  const double u = std::cos(gamma - pair.gamma_q) - std::cos(apart);
  const double e = -u - (gamma - pair.gamma_0) * std::sin(apart);
  return 2.0 * pair.w_0 * e - pair.w_q * u * u;
}

/// A tangent plane said to lie below f that cuts it over the solid.
std::string tangent_fault(const Launcher& launcher, const Primitive& bent) {
  constexpr std::size_t pairs_of_scene = 20'000;
  const double k = std::fabs(bent.bend->curvature);
  if (k < 1e-3) return {};  // coordinates about the centre would lose the plane
  const double largest_angle = k * bent.superquadric.semi_axes[2];
  RandomCases random(7);
  std::vector<PolarPair> pairs(pairs_of_scene);
  Columns columns(5, std::vector<double>(pairs_of_scene));
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    const PolarPair& pair = pairs[n] = random_pair(random, largest_angle);
    columns[0][n] = (1.0 - pair.w_0 * std::cos(pair.gamma_0)) / k;
    columns[1][n] = pair.w_0 * std::sin(pair.gamma_0) / k;
    columns[2][n] = (1.0 - pair.w_q * std::cos(pair.gamma_q)) / k;
    columns[3][n] = pair.w_q * std::sin(pair.gamma_q) / k;
    columns[4][n] = pair.reach / k;
  }
  const std::vector<double> said = launcher.tangents(columns);
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    if (said[n] == 0.0) continue;
    for (int i = -64; i <= 64; ++i) {
      const double gamma = i * largest_angle / 64;
      if (in_reach(pairs[n], gamma) && excess(pairs[n], gamma) < -1e-9)
        return fmt::format("tangent plane at W {}, angle {} of a query at W {}, angle {} within {} cuts at {}",
                           pairs[n].w_0, pairs[n].gamma_0, pairs[n].w_q, pairs[n].gamma_q, pairs[n].reach, gamma);
    }
  }
  return {};
}

/// Of the other primitive the host knows; it tells no normals. The last row fills the columns up.
void append_known(Columns& parts, const std::vector<Enclosure>& distances) {
  for (std::size_t c = 0; c < parts.size(); ++c) {
    const std::size_t length = parts[c].size();
    for (std::size_t n = 0; n < length; ++n) {
      const Enclosure& other = distances[std::min(n, distances.size() - 1)];
      parts[c].push_back(c == 0 ? other.lo : c == 1 ? other.hi : 0.0);
    }
  }
}

}  // namespace

SolidJudge::SolidJudge(std::vector<SolidScene> scenes) {
  for (SolidScene& scene : scenes) {
    KnownScene known{std::move(scene), {}, {}, {}};
    known.witnesses = witnesses(known.scene.model, scenes_.size());
    const auto distances = [&](const Model& model) {
      const SignedDistance host(model);
      std::vector<Enclosure> found(known.scene.points.size());
      oracle::in_parallel(found.size(),
                          [&](std::size_t n) { found[n] = host(known.scene.points[n], truth_tolerance); });
      return found;
    };
    known.distances = distances(known.scene.model);
    for (const Primitive& primitive : known.scene.model.primitives)
      known.of_primitives.push_back(distances(Model{"", {primitive}, {}}));
    scenes_.push_back(std::move(known));
  }
}

std::string SolidJudge::sources() const {
  const Model& model = scenes_.front().scene.model;
  const bool tapered = is_tapered(model.primitives.front().superquadric);
  std::string entry_points(tapered ? kernels::embedded_tapered_bent_distance() : kernels::embedded_bent_distance());
  entry_points += kernels::embedded_solid_distance();
  return device::model_source(model, entry_points + examination);
}

std::string SolidJudge::false_claim(const CompiledKernels& kernels, bool with_searches) const {
  for (const KnownScene& known : scenes_) {
    const PlacedModel placed(known.scene.model);
    const Launcher launcher(kernels, known.scene);
    const Columns claims = launcher.examined(known.witnesses);
    for (std::size_t n = 0; n < known.witnesses.size(); ++n) {
      const std::string fault = cube_fault(Claims(claims, n), placed, known.witnesses[n]);
      if (!fault.empty()) return fmt::format("{}, cube {}: {}", known.scene.name, n, fault);
    }
    std::string fault = tangent_fault(launcher, known.scene.model.primitives.front());
    if (fault.empty()) fault = bent_fault(launcher, known.witnesses);
    if (!fault.empty()) return fmt::format("{}: {}", known.scene.name, fault);
    Columns parts = launcher.bent(known.scene.points);
    for (std::size_t n = 0; n < known.scene.points.size(); ++n) {
      const Enclosure claimed{parts[0][n], parts[1][n]};
      if (misses(claimed, known.of_primitives[0][n]))
        return fmt::format("{}: bent {}", known.scene.name,
                           described(known.scene.points[n], claimed, known.of_primitives[0][n]));
    }
    if (!with_searches) continue;
    append_known(parts, known.of_primitives[1]);
    const std::vector<Enclosure> found = launcher.searched(known.scene.points, parts);
    for (std::size_t n = 0; n < found.size(); ++n)
      if (misses(found[n], known.distances[n]))
        return fmt::format("{}: search {}", known.scene.name,
                           described(known.scene.points[n], found[n], known.distances[n]));
  }
  return {};
}

}  // namespace verisq::mutation
