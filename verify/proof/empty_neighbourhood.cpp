/// Places of cells by gauges, half-spaces by support functions and tangents, and one step of Lagrangian duality.
#include "verify/proof/empty_neighbourhood.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

namespace verisq::verify {

namespace {

Place opposite(Place place) {
  return static_cast<Place>(-static_cast<int>(place));
}

/// {centre + e : normal·e <= offset} contains the relevant part of the cell.
struct Cut {
  PreciseVector normal;  ///< exact
  Real offset;
};

/// The cut from n·e <= offset for some n of `range`: for no e of the cell is (n - normal)·e below the lower end of that
/// product.
Cut cut_of(const PreciseVector& range, const Real& offset, const std::array<Real, 3>& half) {
  const PreciseVector normal = precise(midpoint(range));
  return {normal, (PreciseInterval(offset) - PreciseVector(range - normal).dot(box_of(half))).upper()};
}

std::array<double, 3> middle(const PreciseVector& v) {
  const Proposal m = midpoint(v);
  return {static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
}

Place place_in(const PreciseVector& range, const SuperquadricBounds<Real>& bounds) {
  if (bounds.gauge_down(range) > Real(1)) return Place::outside;
  return bounds.gauge_up(range) < Real(1) ? Place::inside : Place::undecided;
}

/// About the gradient of g, where it is usable: any vector is as right.
std::optional<PreciseVector> near_gradient(const Superquadric& solid, const PreciseVector& at) {
  const Proposal w = proposed::gradient(solid, midpoint(at));
  return usable(w) ? std::optional(precise(w)) : std::nullopt;
}

/// K lies in {w·y <= h(w)}.
Cut cut_inside(const OwnRegion& own, const std::array<Real, 3>& half, const SuperquadricBounds<Real>& bounds,
               const PreciseVector& w) {
  const Real offset = (PreciseInterval(bounds.support_up(w)) - w.dot(own.centre)).upper();
  return cut_of(own.derivative.transpose() * w, offset, half);
}

/// If g(y) >= 1, then w·(y - centre) >= -m, if m >= g - 1 - w·(y - centre) at all corners of the cell, with any
/// derivative. For this expression is convex, and every y lies in the hull of eight such corners, because one
/// derivative applies to it.
Cut cut_outside(const OwnRegion& own, const std::array<Real, 3>& half, const SuperquadricBounds<Real>& bounds,
                const PreciseVector& w) {
  Real excess(-infinity);
  for (unsigned n = 0; n < 8; ++n) {
    const auto end = [&](unsigned i) { return (n >> i & 1U) != 0 ? half[i] : -half[i]; };
    const PreciseVector step = own.derivative * PreciseVector(end(0), end(1), end(2));
    const Real gauge = bounds.gauge_up(own.centre + step);
    excess = std::max(excess, (PreciseInterval(gauge) - PreciseInterval(1) - w.dot(step)).upper());
  }
  return cut_of(-(own.derivative.transpose() * w), excess, half);
}

/// The least of 2 N·(c - o) - |N|² - 2 Σ m b with N = Σ m n over all c of a convex region that `reach` bounds, rounded
/// down. No point o + e in all cuts has a smaller square of its distance from the region, whatever m >= 0.
template <class Reach>
Real least_square(const Reach& reach, const PreciseVector& o, std::span<const Cut> cuts, const std::vector<double>& m) {
  PreciseVector sum;
  PreciseInterval rest(0);
  for (std::size_t j = 0; j < cuts.size(); ++j) {
    const PreciseInterval weight{Real(std::max(0.0, m.at(j)))};
    sum = sum + cuts[j].normal * weight;
    rest += PreciseInterval(2) * weight * PreciseInterval(cuts[j].offset);
  }
  rest += square(sum[0]) + square(sum[1]) + square(sum[2]);
  return (-PreciseInterval(2) * (PreciseInterval(reach(-sum)) + sum.dot(o)) - rest).lower();
}

}  // namespace

Place place_of(const SetExpression& set, std::span<const Place> primitives) {
  if (set.operands.empty()) return primitives[set.primitive];
  const Place deciding = set.operation == SetOperation::unite ? Place::inside : Place::outside;
  Place result = opposite(deciding);
  for (std::size_t i = 0; i < set.operands.size(); ++i) {
    const Place found = place_of(set.operands[i], primitives);
    const bool removed = set.operation == SetOperation::subtract && i > 0;
    if ((removed ? opposite(found) : found) == deciding) return deciding;
    if (found == Place::undecided) result = found;
  }
  return result;
}

Place place_of(const PreciseVector& x, const PosedPrimitive& primitive) {
  const auto place = [&](const auto& solid) {
    if (solid.misses(x)) return Place::outside;
    const auto own = solid.over(x, {});
    return own ? place_in(own->range, solid.bounds()) : Place::undecided;
  };
  return std::visit(place, primitive);
}

Place place_of(const PreciseVector& x, const SetExpression& set, std::span<const PosedPrimitive> primitives) {
  std::vector<Place> places;
  for (const PosedPrimitive& primitive : primitives) places.push_back(place_of(x, primitive));
  return place_of(set, places);
}

/// The proof for one cell.
struct EmptyNeighbourhood::Look {
  /// Begins with the cell's faces as cuts.
  Look(const EmptyNeighbourhood& of, const Cell& at)
      : around(of), cell(at), offset(at.offset[0], at.offset[1], at.offset[2]), places(of.places_), own(places.size()) {
    for (std::size_t i = 0; i < 6; ++i) {
      PreciseVector axis;
      axis[i / 2] = i % 2 == 0 ? 1 : -1;
      cuts.push_back({axis, at.half[i / 2]});
    }
  }

  void place_primitives() {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto look = [&](const auto& solid) {
        const PreciseVector centre = around.centre_ + offset;
        own[i] = solid.over(centre, cell.half);
        if (own[i]) places[i] = place_in(own[i]->range, solid.bounds());
        if (solid.misses(centre + box_of(cell.half))) places[i] = Place::outside;
      };
      if (places[i] == Place::undecided) std::visit(look, around.primitives_[i]);
    }
  }

  [[nodiscard]] bool is_far() const {
    const Real least = around.square_of_radius_.upper();
    std::vector<std::array<double, 3>> corners;
    for (const PreciseVector& corner : around.corners_) corners.push_back(middle(corner - offset));
    std::vector<proposed::HalfSpace> half_spaces;
    for (const auto& [n, b] : cuts) half_spaces.push_back({middle(n), b.to_double(Direction::up)});
    const double value = least.to_double(Direction::up);
    const auto m = around.body_ == nullptr ? proposed::multipliers(corners, half_spaces, value)
                                           : proposed::multipliers(farthest(), middle(-offset), half_spaces, value);
    return m && least_square([this](const PreciseVector& v) { return around.reach(v); }, offset, cuts, *m) >= least;
  }

  /// The farthest point of the body, from the cell's centre.
  [[nodiscard]] proposed::FarthestPoint farthest() const {
    return [body = around.body_, from = middle(offset)](const std::array<double, 3>& v) {
      const auto [x, y, z] = body->farthest(v);
      return std::array{x - from[0], y - from[1], z - from[2]};
    };
  }

  /// Adds cuts if the set is one primitive.
  void cut_by(const SetExpression& set, Place wanted) {
    if (!set.operands.empty() || places[set.primitive] != Place::undecided || !own[set.primitive]) return;
    const auto add_cuts = [&](const auto& solid) {
      const OwnRegion& image = *own[set.primitive];
      const std::optional<PreciseVector> w = near_gradient(solid.superquadric(), image.centre);
      if (w && wanted == Place::inside) cuts.push_back(cut_outside(image, cell.half, solid.bounds(), *w));
      if (w && wanted == Place::outside) cuts.push_back(cut_inside(image, cell.half, solid.bounds(), *w));
      const std::optional<PreciseVector>& touching = around.touching_[set.primitive];
      if (touching && wanted == Place::outside) cuts.push_back(cut_inside(image, cell.half, solid.bounds(), *touching));
    };
    std::visit(add_cuts, around.primitives_[set.primitive]);
  }

  /// Returns whether the set's part in the cell and in the cuts is proven to be far; with Place::inside: the part of
  /// the closure of its complement. Leaves the cuts as they were.
  [[nodiscard]] bool is_far(const SetExpression& set, Place wanted) {
    const Place found = place_of(set, places);
    if (found != Place::undecided) return found == wanted || is_far();
    const std::vector<Cut> before = cuts;
    const bool subtracts = set.operation == SetOperation::subtract;
    const bool unites = !set.operands.empty() && (set.operation == SetOperation::unite) == (wanted == Place::outside);
    const auto side = [&](std::size_t i) { return subtracts && i > 0 ? opposite(wanted) : wanted; };
    cut_by(set, wanted);
    for (std::size_t i = 0; !unites && i < set.operands.size(); ++i) cut_by(set.operands[i], side(i));
    bool result = unites || is_far();  // of a union all operands have to be far, of an intersection one
    for (std::size_t i = 0; i < set.operands.size() && result == unites; ++i) {
      if (unites || !set.operands[i].operands.empty()) result = is_far(set.operands[i], side(i));
    }
    cuts = before;
    return result;
  }

  const EmptyNeighbourhood& around;
  const Cell& cell;
  PreciseVector offset;
  std::vector<Place> places;
  std::vector<std::optional<OwnRegion>> own;  ///< regions of the primitives that are undecided in the whole
                                              ///< neighbourhood
  std::vector<Cut> cuts;
};

namespace {

bool contains(const auto& solid, const Point& centre, double radius, const Proposal& v, const Hook& interrupted) {
  return solid.contains(centre) && solid.contains_ball_about(centre, radius, v, interrupted);
}

/// Proven by the balls about the corners, if the solid is convex.
template <class Solid>
bool contains(const Solid& solid, const Triangle& triangle, double radius, const Proposal& v, const Hook& interrupted) {
  const auto contains_ball = [&](const Point& x) { return contains(solid, x, radius, v, interrupted); };
  return std::is_same_v<Solid, PosedSuperquadric> && std::ranges::all_of(triangle, contains_ball);
}

std::span<const Point> corners_of(const Point& x) {
  return {&x, 1};
}

std::span<const Point> corners_of(const Triangle& triangle) {
  return triangle;
}

/// The centre of the axis-parallel box whose centre and half edges are binary64 numbers.
Point middle_of(std::span<const Point> corners) {
  Point result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [least, largest] = std::ranges::minmax(corners, {}, [i](const Point& x) { return x[i]; });
    result[i] = std::midpoint(least[i], largest[i]);
  }
  return result;
}

}  // namespace

EmptyNeighbourhood::EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives,
                                       std::span<const Point> corners, const ConvexBody* body, double radius,
                                       Place wanted)
    : set_(set),
      primitives_(primitives),
      centre_(precise(middle_of(corners))),
      body_(body),
      whole_({{}, {radius, radius, radius}}),
      square_of_radius_(square(PreciseInterval(Real(radius)))),
      wanted_(wanted),
      places_(primitives.size(), Place::undecided),
      touching_(primitives.size()) {
  for (const Point& corner : corners) corners_.push_back(precise(corner) - centre_);
  for (std::size_t i = 0; i < 3; ++i) {
    PreciseVector axis;
    axis[i] = 1;
    const PreciseInterval far(std::max(reach(axis), reach(-axis)));
    const Real edge((far + PreciseInterval(Real(radius))).upper().to_double(Direction::up));
    whole_.half[i] = std::max(whole_.half[i], edge);
  }
}

EmptyNeighbourhood::EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives,
                                       const ConvexBody& body, const Point& centre, double radius)
    : EmptyNeighbourhood(set, primitives, std::span(&centre, 1), &body, radius, Place::outside) {}

Real EmptyNeighbourhood::reach(const PreciseVector& v) const {
  if (body_ != nullptr) return body_->reach(v);
  Real farthest(-infinity);
  for (const PreciseVector& corner : corners_) farthest = std::max(farthest, v.dot(corner).upper());
  return farthest;
}

EmptyNeighbourhood::EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives,
                                       const PreciseVector& centre, const Real& half_width, Place wanted)
    : set_(set),
      primitives_(primitives),
      centre_(centre),
      corners_{PreciseVector{}},
      whole_({{}, {half_width, half_width, half_width}}),
      square_of_radius_(PreciseInterval(4) * square(PreciseInterval(half_width))),  // the corners are at √3 of it
      wanted_(wanted),
      places_(primitives.size(), Place::undecided),
      touching_(primitives.size()) {}

template <class PointOrTriangle>
EmptyNeighbourhood::EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives,
                                       const PointOrTriangle& query, double radius, Place wanted,
                                       std::span<const Normal> normals, const std::optional<Point>& near,
                                       const Hook& interrupted)
    : EmptyNeighbourhood(set, primitives, corners_of(query), nullptr, radius, wanted) {
  std::vector<bool> tried(primitives_.size());  // no normal changes the ball of a convex primitive
  for (const auto& [i, vector] : normals) {
    const Proposal v{vector[0], vector[1], vector[2]};
    const auto is_inside = [&](const auto& solid) { return contains(solid, query, radius, v, interrupted); };
    if (interrupted && interrupted()) return;
    if (places_[i] != Place::undecided) continue;
    if (lower_by_normal(primitives_[i], query, v) >= radius) {
      places_[i] = Place::outside;
    } else if (!tried[i] && std::visit(is_inside, primitives_[i])) {
      places_[i] = Place::inside;
    }
    tried[i] = std::holds_alternative<PosedSuperquadric>(primitives_[i]);
  }
  for (std::size_t i = 0; i < primitives_.size(); ++i) {
    const auto look = [&](const auto& solid) {
      if (lower_by_sphere(solid, query) >= radius) places_[i] = Place::outside;
      const auto own = near ? solid.over(precise(*near), {}) : std::nullopt;
      if (own) touching_[i] = near_gradient(solid.superquadric(), own->centre);
    };
    if (places_[i] == Place::undecided) std::visit(look, primitives_[i]);
  }
}

template EmptyNeighbourhood::EmptyNeighbourhood(const SetExpression&, std::span<const PosedPrimitive>, const Point&,
                                                double, Place, std::span<const Normal>, const std::optional<Point>&,
                                                const Hook&);
template EmptyNeighbourhood::EmptyNeighbourhood(const SetExpression&, std::span<const PosedPrimitive>, const Triangle&,
                                                double, Place, std::span<const Normal>, const std::optional<Point>&,
                                                const Hook&);

// Half edges of the whole are binary64 numbers, offsets are whole multiples of the cell's half edges. Down to 2^-59 of
// the whole both have no more than 53 + 59 bits.
std::optional<std::array<EmptyNeighbourhood::Cell, 2>> EmptyNeighbourhood::halves(const Cell& cell) const {
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(cell.half) - cell.half.begin());
  if (cell.half[axis] < multiply(whole_.half[axis], Real(0x1p-58), Direction::up)) return std::nullopt;
  std::array<Cell, 2> result{cell, cell};
  for (Cell& each : result) each.half[axis] = multiply(cell.half[axis], Real(0.5), Direction::up);
  result[0].offset[axis] = subtract(cell.offset[axis], result[0].half[axis], Direction::down);
  result[1].offset[axis] = add(cell.offset[axis], result[1].half[axis], Direction::up);
  return result;
}

bool EmptyNeighbourhood::is_empty(const Cell& cell) const {
  Look look(*this, cell);
  if (look.is_far()) return true;
  look.place_primitives();
  return look.is_far(set_, wanted_);
}

bool EmptyNeighbourhood::is_refuted_at_middle(const Cell& cell) const {
  const PreciseVector offset(cell.offset[0], cell.offset[1], cell.offset[2]);
  return verify::place_of(centre_ + offset, set_, primitives_) == opposite(wanted_);
}

bool EmptyNeighbourhood::is_covered_by(const std::vector<bool>& cover, const Hook& interrupted) const {
  if (cover.size() > longest_cover || !(std::ranges::max(whole_.half) < Real(infinity))) return false;
  std::vector<Cell> open{whole()};
  for (const bool halved : cover) {
    if (open.empty() || (interrupted && interrupted())) return false;
    const Cell cell = open.back();
    open.pop_back();
    if (!halved && !is_empty(cell)) return false;
    if (!halved) continue;
    const auto parts = halves(cell);
    if (!parts) return false;
    open.insert(open.end(), {(*parts)[1], (*parts)[0]});
  }
  return open.empty();
}

}  // namespace verisq::verify
