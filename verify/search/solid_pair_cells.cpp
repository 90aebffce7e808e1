/// This file implements solid_pair_cells.hpp.
#include "verify/search/solid_pair_cells.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>
#include <verisq/error.hpp>

#include "verify/proposals/support_mapping.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {

namespace {

double nearest(const PreciseInterval& x) {
  return 0.5 * (x.lower().to_double(Direction::down) + x.upper().to_double(Direction::up));
}

}  // namespace

BoundedMotion::BoundedMotion(const Pose& pose)
    : precise_(RigidMotion(pose)), inverse_(precise_.inverse()), rotation_{}, translation_(pose.translation) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      // Both ends are within 2^-52 of the exact entry: the roundings of 127 bits are negligible here.
      rotation_[i][j] = nearest(precise_.rotation(i, j));
    }
  }
}

Point BoundedMotion::to_a(const Point& in_b) const {
  Point x = translation_;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) x[i] += rotation_[i][j] * in_b[j];
  }
  return x;
}

Point BoundedMotion::to_b(const Point& in_a) const {
  return direction_in_b({in_a[0] - translation_[0], in_a[1] - translation_[1], in_a[2] - translation_[2]});
}

Point BoundedMotion::direction_in_b(const Point& direction) const {
  // Each product carries 2^-52 |direction_i| from its entry and three roundings of 2^-53: together less than
  // 2^-50 |direction|_1.
  Point turned{};
  for (std::size_t j = 0; j < 3; ++j) {
    turned[j] = rotation_[0][j] * direction[0] + rotation_[1][j] * direction[1] + rotation_[2][j] * direction[2];
  }
  return turned;
}

double BoundedMotion::distance_up(const Point& a, const Point& b) const {
  return length<Real>(PreciseVector(precise_(precise(b)) - precise(a))).upper().to_double(Direction::up);
}

Cube BoundedMotion::enclosed_in_b(const Point& x) const {
  const PreciseVector in_b = inverse_(precise(x));
  Cube cube{{}, 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval& component = in_b[i];
    cube.centre[i] = nearest(component);
    const PreciseInterval deviation = abs(component - PreciseInterval(Real(cube.centre[i])));
    cube.half_width = std::max(cube.half_width, deviation.upper().to_double(Direction::up));
  }
  return cube;
}

namespace {

double largest_side(const Box& box) {
  return std::max({box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2]});
}

/// Contains the set; nothing where the set need not be bounded.
std::optional<Box> box_of(const SetNode& set, const Model& model) {
  if (set.kind == SetNode::Kind::leaf) {
    if (set.side == Side::outside) return std::nullopt;
    return bounding_box(Model{"", {model.primitives[set.primitive]}});
  }
  std::optional<Box> box;
  for (const SetNode& operand : set.operands) {
    const std::optional<Box> other = box_of(operand, model);
    if (set.kind == SetNode::Kind::union_of) {
      if (!other) return std::nullopt;
      box = box ? hull(*box, *other) : *other;
    } else if (other && (!box || largest_side(*other) < largest_side(*box))) {
      box = other;
    }
  }
  return box;
}

Cube cube_around(const Box& box) {
  const std::optional<Cube> cube = root_cube(box);
  if (!cube) throw Error(ErrorKind::input, "the size of a model overflows: no search can cover it");
  return *cube;
}

/// Replaces a union by its operands, and those by theirs.
template <class Visit>
void for_each_part(const SetNode& set, const Visit& visit) {
  if (set.kind != SetNode::Kind::union_of) {
    visit(set);
    return;
  }
  for (const SetNode& operand : set.operands) for_each_part(operand, visit);
}

void append_half_spaces(const SearchSolid& solid, const SetNode& set, const Cube& cube,
                        std::vector<HalfSpace>& half_spaces) {
  switch (set.kind) {
    case SetNode::Kind::leaf: half_spaces.push_back(solid.primitives[set.primitive].half_space(cube, set.side)); return;
    case SetNode::Kind::intersection_of:
      for (const SetNode& operand : set.operands) append_half_spaces(solid, operand, cube, half_spaces);
      return;
    case SetNode::Kind::union_of: return;
  }
}

bool comparable(const CutCube& p, const CutCube& q) {
  return !p.half_spaces().empty() && p.half_spaces().size() == q.half_spaces().size();
}

/// The largest difference of the half-spaces' normals. Precondition: comparable.
double turn(const CutCube& p, const CutCube& q) {
  double largest = 0.0;
  for (std::size_t j = 0; j < p.half_spaces().size(); ++j) {
    const Point m = unit(p.half_spaces()[j].normal);
    const Point n = unit(q.half_spaces()[j].normal);
    largest = std::max(largest, std::hypot(m[0] - n[0], m[1] - n[1], m[2] - n[2]));
  }
  return largest;
}

}  // namespace

SearchSolid::SearchSolid(const Model& model) {
  primitives.reserve(model.primitives.size());
  separable.reserve(model.primitives.size());
  for (const Primitive& primitive : model.primitives) {
    primitives.emplace_back(primitive);
    separable.emplace_back(primitive);
  }
  const Box whole = bounding_box(model);
  for_each_part(normal_form(model, Side::inside), [&](const SetNode& set) {
    parts.push_back({set, cube_around(box_of(set, model).value_or(whole))});
  });
}

bool strictly_inside(const SearchSolid& solid, const SetNode& set, const Cube& cube) {
  const auto inside = [&](const SetNode& operand) { return strictly_inside(solid, operand, cube); };
  switch (set.kind) {
    case SetNode::Kind::leaf:
      return solid.primitives[set.primitive].colour(cube) == (set.side == Side::inside ? Colour::black : Colour::white);
    case SetNode::Kind::union_of: return std::ranges::any_of(set.operands, inside);
    case SetNode::Kind::intersection_of: return std::ranges::all_of(set.operands, inside);
  }
  return false;
}

CutCube relaxation(const SearchSolid& solid, const SetNode& set, const Cube& cube) {
  std::vector<HalfSpace> half_spaces;
  append_half_spaces(solid, set, cube, half_spaces);
  return {cube, half_spaces};
}

Cells::Cells(const SearchSolid& solid) : solid_(&solid), colours_(solid.primitives.size(), Colour::gray) {
  for (const SearchSolid::Part& part : solid.parts) evaluate(part.set, part.set, part.cube);
  // NOLINTNEXTLINE(cppcoreguidelines-prefer-member-initializer): so many there are now
  roots_ = static_cast<std::uint32_t>(cells_.size());
}

std::optional<CellRange> Cells::children(std::uint32_t index) {
  if (cells_[index].children) return cells_[index].children;
  const auto cubes = halves(cells_[index].polytope.cube());
  if (!cubes) return std::nullopt;
  const SetNode& set = *cells_[index].set;
  const SetNode& part = *cells_[index].part;
  const bool inside = cells_[index].inside;
  const auto first = static_cast<std::uint32_t>(cells_.size());
  for (const Cube& cube : *cubes) {
    if (inside) {
      add(set, part, cube, true);
    } else {
      evaluate(set, part, cube);
    }
  }
  const CellRange range{first, static_cast<std::uint32_t>(cells_.size())};
  cells_[index].children = range;
  estimate_slack(CutCube(cells_[index].polytope), cells_[index].slack, range);
  return range;
}

void Cells::estimate_slack(const CutCube& parent, double slack_of_parent, CellRange children) {
  const std::span<Cell> cells = std::span(cells_).subspan(children.first, children.end - children.first);
  double turned = 0.0;
  for (const Cell& cell : cells) {
    if (comparable(parent, cell.polytope)) turned = std::max(turned, turn(parent, cell.polytope));
  }
  for (Cell& cell : cells) {
    // Curvature leaves a quarter at a halving. Bounded, lest a symmetry looks like a plane.
    const double slack = comparable(parent, cell.polytope) ? turned * cell.polytope.cube().half_width : slack_of_parent;
    cell.slack = std::clamp(slack, slack_of_parent / 16.0, slack_of_parent / 2.0);
  }
}

void Cells::evaluate(const SetNode& set, const SetNode& part, const Cube& cube) {
  ++evaluated_;
  colour_primitives(set, cube);
  const Colour found = colour(set, colours_);
  if (found == Colour::white) return;
  if (found == Colour::black || set.kind == SetNode::Kind::leaf) {
    add(set, part, cube, found == Colour::black);
    return;
  }
  const SetNode& shorter = sets_.emplace_back(simplified(set, colours_));
  for_each_part(shorter, [&](const SetNode& operand) { add(operand, part, cube, false); });
}

void Cells::colour_primitives(const SetNode& set, const Cube& cube) {
  if (set.kind == SetNode::Kind::leaf) colours_[set.primitive] = solid_->primitives[set.primitive].colour(cube);
  for (const SetNode& operand : set.operands) colour_primitives(operand, cube);
}

void Cells::add(const SetNode& set, const SetNode& part, const Cube& cube, bool inside) {
  cells_.push_back(
      {inside ? CutCube(cube, {}) : relaxation(*solid_, set, cube), &set, &part, inside, cube.half_width, {}});
}

namespace {

/// Each doubles the accuracy of a direction that neighbours share already.
constexpr int kMostProjections = 8;

double absolute_dot(const Point& a, const Point& b) {
  return std::fabs(a[0] * b[0]) + std::fabs(a[1] * b[1]) + std::fabs(a[2] * b[2]);
}

double absolute_sum(const Point& a) {
  return std::fabs(a[0]) + std::fabs(a[1]) + std::fabs(a[2]);
}

}  // namespace

Point unit(const Point& n) {
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0.0) || !std::isfinite(length)) return {};
  return {n[0] / length, n[1] / length, n[2] / length};
}

template <Separable X, Separable Y>
double lower_by_direction(const X& x, const Y& y, const BoundedMotion& motion, const Point& n) {
  // n·(R y + t - x) = (R^T n)·y + n·t - n·x, with m for R^T n: the error of m is multiplied by at most |y|_1.
  const Point m = motion.direction_in_b(n);
  const double support_x = x.support(n);
  const double support_y = y.support({-m[0], -m[1], -m[2]});
  const Point& a = x.cube().centre;
  const Point& b = y.cube().centre;
  const double slab = dot(n, motion.translation()) + dot(m, b) - dot(n, a) - support_x - support_y;
  // Fewer than 16 roundings between an input and the sum: below 32 u times the absolute terms, computed so well too.
  const double terms = absolute_dot(n, motion.translation()) + absolute_dot(m, b) + absolute_dot(n, a) +
                       std::fabs(support_x) + std::fabs(support_y);
  const double turned =
      2.0 * BoundedMotion::rotation_error * absolute_sum(n) * (absolute_sum(b) + 3.0 * y.cube().half_width);
  const double proven = slab - 0x1p-47 * terms - turned - 0x1p-1000;
  if (!(proven > 0.0)) return 0.0;
  const double length = std::sqrt(dot(n, n)) * (1.0 + 0x1p-50);  // n is about as long as 1: nothing underflows
  return proven / length * (1.0 - 0x1p-50);
}

template <Separable X, Separable Y>
Approach approach(const X& x, const Y& y, const BoundedMotion& motion, const Point& guess, double enough) {
  Approach found{lower_by_direction(x, y, motion, guess), 0.0, x.cube().centre, y.cube().centre};
  const double little = 0x1p-10 * std::min(x.cube().half_width, y.cube().half_width);
  for (int step = 0; step < kMostProjections && found.lower < enough; ++step) {
    found.on_b = y.nearest(motion.to_b(found.on_a));
    const Point on_b = motion.to_a(found.on_b);
    found.on_a = x.nearest(on_b);
    const Point between{on_b[0] - found.on_a[0], on_b[1] - found.on_a[1], on_b[2] - found.on_a[2]};
    found.between = std::hypot(between[0], between[1], between[2]);
    found.lower = std::max(found.lower, lower_by_direction(x, y, motion, unit(between)));
    if (found.between - found.lower <= little) break;
  }
  return found;
}

template double lower_by_direction(const CutCube&, const CutCube&, const BoundedMotion&, const Point&);
template Approach approach(const CutCube&, const CutCube&, const BoundedMotion&, const Point&, double);
template Approach approach(const WholePrimitive&, const CutCube&, const BoundedMotion&, const Point&, double);
template Approach approach(const CutCube&, const WholePrimitive&, const BoundedMotion&, const Point&, double);

namespace {

constexpr int kMostMargins = 14;
constexpr int kMostDescents = 40;

double largest(const Point& x) {
  return std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])});
}

/// The tangent planes at x, lowered by `margin`, in a cube of this half-width about x.
CutCube lowered(const SearchSolid& solid, const SetNode& set, const Point& x, double half_width, double margin) {
  const CutCube tangent = relaxation(solid, set, {x, 0.0});
  std::vector<HalfSpace> half_spaces(tangent.half_spaces().begin(), tangent.half_spaces().end());
  for (HalfSpace& half_space : half_spaces) {
    const Point& n = half_space.normal;
    half_space.offset -= margin * std::hypot(n[0], n[1], n[2]);
  }
  return {{x, half_width}, half_spaces};
}

/// If no plane determines the shape, at a tip or an edge: tries points on the ways into the primitives whose tip it may
/// be. Bent or not, a primitive contains its centre.
std::optional<Point> settle_towards_centres(const SearchSolid& solid, const Cell& cell, const Point& x) {
  std::optional<Point> settled;
  for_each_containing(*cell.set, [&](std::uint32_t primitive) {
    const Point centre = solid.separable[primitive].about.point({});
    for (double part = 0x1p-46; !settled && part < 0x1p-4; part *= 16.0) {
      Point inside = x;
      for (std::size_t i = 0; i < 3; ++i) inside[i] += part * (centre[i] - x[i]);
      if (strictly_inside(solid, *cell.part, {inside, 0.0})) settled = inside;
    }
  });
  return settled;
}

/// A point proven to lie in the cell's part, near x. The tangent plane of a convex gauge lies outside, hence the
/// margins: they begin with the rounding error and grow until they cover the curvature.
std::optional<Point> settle(const SearchSolid& solid, const Cell& cell, Point x, double scale) {
  double margin = 0x1p-51 * (largest(x) + scale);
  for (int i = 0; i < kMostMargins; ++i) {
    x = lowered(solid, *cell.set, x, scale, margin).nearest(x);
    if (strictly_inside(solid, *cell.part, {x, 0.0})) return x;
    if (i > 0) margin *= 8.0;
  }
  return std::nullopt;
}

}  // namespace

std::optional<NearPoints> PointSearch::both(const std::optional<Point>& on_a, const std::optional<Point>& on_b) const {
  if (!on_a || !on_b) return std::nullopt;
  return NearPoints{*on_a, *on_b, motion_->distance_up(*on_a, *on_b)};
}

std::optional<NearPoints> PointSearch::settled(const Cell& x, const Cell& y, const Point& near_a, const Point& near_b,
                                               double scale) const {
  const std::optional<Point> on_a = settle(*a_, x, near_a, scale);
  return on_a ? both(on_a, settle(*b_, y, near_b, scale)) : std::nullopt;
}

std::optional<NearPoints> PointSearch::settled_towards_centres(const Cell& x, const Cell& y, const Point& near_a,
                                                               const Point& near_b) const {
  const std::optional<Point> on_a = settle_towards_centres(*a_, x, near_a);
  return on_a ? both(on_a, settle_towards_centres(*b_, y, near_b)) : std::nullopt;
}

NearPoints PointSearch::improved(const Cell& x, const Cell& y, NearPoints points, double scale, double gain) const {
  for (int i = 0; i < kMostDescents; ++i) {
    const CutCube around_a = lowered(*a_, *x.set, points.on_a, scale, 0.0);
    const CutCube around_b = lowered(*b_, *y.set, points.on_b, scale, 0.0);
    const Approach step = approach(around_a, around_b, *motion_, {}, points.distance);
    const double promised = points.distance - step.between;
    if (!(promised > gain)) break;  // a smaller cube promises less still
    const std::optional<NearPoints> next = settled(x, y, step.on_a, step.on_b, scale);
    const double gained = next ? points.distance - next->distance : 0.0;
    if (gained > 0.0) points = *next;
    if (gained < 0.5 * promised) scale *= 0.25;
  }
  return points;
}

bool PointSearch::common(const Cell& x, const Cell& y, const Point& at) const {
  return strictly_inside(*a_, *x.part, {at, 0.0}) && strictly_inside(*b_, *y.part, motion_->enclosed_in_b(at));
}

}  // namespace verisq::verify
