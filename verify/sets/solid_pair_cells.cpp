/// Trees are simplified on the way down.
#include "verify/sets/solid_pair_cells.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <verisq/error.hpp>

#include "verify/sets/bounding_box.hpp"
#include "verify/sets/cube_division.hpp"
#include "verify/sets/solid_pair_bound.hpp"

namespace verisq::verify {

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

/// By how much the half-spaces' normals differ. Precondition: comparable.
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

}  // namespace verisq::verify
