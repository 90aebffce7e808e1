/// Places of cells by gauges, half-spaces by support functions and tangents, and one step of Lagrangian duality.
#include "verify/proof/empty_ball.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "verify/proof/boundary.hpp"

namespace verisq::verify {

namespace {

using Vector = std::array<double, 3>;

Place opposite(Place place) {
  return static_cast<Place>(-static_cast<int>(place));
}

/// Of the set whose primitives have these places (docs/mathematics.md §11).
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

/// {centre + e : n·e <= offset for an n of `normal`} contains what counts of the cell.
struct Cut {
  PreciseVector normal;
  Real offset;
};

Vector middle(const PreciseVector& v) {
  const Proposal m = midpoint(v);
  return {static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
}

Place place_in(const PreciseVector& range, const SuperquadricBounds<Real>& bounds) {
  if (bounds.gauge_down(range) > Real(1)) return Place::outside;
  return bounds.gauge_up(range) < Real(1) ? Place::inside : Place::undecided;
}

/// The gradient of g, in plain floating point, where it is usable: any vector is as right.
std::optional<PreciseVector> near_gradient(const Superquadric& solid, const PreciseVector& at) {
  const Boundary<double> boundary(solid);
  const Vector x = middle(at);
  const Vector folded{std::fabs(x[0]), std::fabs(x[1]), is_tapered(solid) ? x[2] : std::fabs(x[2])};
  Vector w = boundary.normal(folded);
  const double scale = boundary.gauge(folded) / (w[0] * folded[0] + w[1] * folded[1] + w[2] * folded[2]);
  for (std::size_t i = 0; i < 3; ++i) w[i] = folded[i] == x[i] ? w[i] * scale : -(w[i] * scale);
  if (!usable({w[0], w[1], w[2]})) return std::nullopt;
  return precise(Point(w));
}

/// K lies in {w·y <= h(w)}.
Cut cut_inside(const OwnRegion& own, const SuperquadricBounds<Real>& bounds, const PreciseVector& w) {
  return {own.derivative.transpose() * w, (PreciseInterval(bounds.support_up(w)) - w.dot(own.centre)).upper()};
}

/// Where g(y) >= 1, w·(y - centre) >= -m if m >= g - 1 - w·(y - centre) at all corners of the cell, with any
/// derivative: that is convex, and every y lies in the hull of eight such corners, because one derivative serves for
/// it.
Cut cut_outside(const OwnRegion& own, const std::array<Real, 3>& half, const SuperquadricBounds<Real>& bounds,
                const PreciseVector& w) {
  Real excess(-infinity);
  for (unsigned n = 0; n < 8; ++n) {
    const auto end = [&](unsigned i) { return (n >> i & 1U) != 0 ? half[i] : -half[i]; };
    const PreciseVector step = own.derivative * PreciseVector(end(0), end(1), end(2));
    const Real gauge = bounds.gauge_up(own.centre + step);
    excess = std::max(excess, (PreciseInterval(gauge) - PreciseInterval(1) - w.dot(step)).upper());
  }
  return {-(own.derivative.transpose() * w), excess};
}

/// |o|² - |o + N|² - 2 Σ m b with N = Σ m n, the least of |o + e|² + 2 Σ m (n·e - b), from below: no centre + o + e in
/// all cuts is nearer to the centre, whatever m >= 0.
Real least_square(const PreciseVector& o, std::span<const Cut> cuts, std::span<const double> m) {
  PreciseVector sum = o;
  PreciseInterval result = o.dot(o);
  for (std::size_t j = 0; j < cuts.size(); ++j) {
    const PreciseInterval weight{Real(m[j])};
    sum = sum + cuts[j].normal * weight;
    result -= PreciseInterval(2) * weight * PreciseInterval(cuts[j].offset);
  }
  return (result - square(sum[0]) - square(sum[1]) - square(sum[2])).lower();
}

/// Multipliers for which that comes to `value` in plain floating point; nothing where none are found. Hildreth's
/// method: each of them in turn, as long as that helps.
std::optional<std::vector<double>> multipliers(const PreciseVector& o, std::span<const Cut> cuts, double value) {
  std::vector<double> m(cuts.size(), 0.0);
  std::vector<Vector> normals;
  for (const Cut& cut : cuts) normals.push_back(middle(cut.normal));
  const Vector offset = middle(o);
  const auto dot = [](const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  Vector nearest = offset;  // o + N
  double before = 0.0;
  for (int round = 0; round < 2000; ++round) {
    for (std::size_t j = 0; j < cuts.size(); ++j) {
      const double bound = cuts[j].offset.to_double(Direction::up);
      const double next = std::max(0.0, m[j] - (dot(normals[j], nearest) + bound) / dot(normals[j], normals[j]));
      if (!std::isfinite(next)) continue;
      for (std::size_t i = 0; i < 3; ++i) nearest[i] += (next - m[j]) * normals[j][i];
      m[j] = next;
    }
    double dual = dot(offset, offset) - dot(nearest, nearest);
    for (std::size_t j = 0; j < cuts.size(); ++j) dual -= 2 * m[j] * cuts[j].offset.to_double(Direction::up);
    if (dual > value) return m;
    if (round > 8 && !(dual - before > 1e-4 * (value - dual))) break;
    before = dual;
  }
  return std::nullopt;
}

}  // namespace

Place place_of(const Point& x, const SetExpression& set, std::span<const PosedPrimitive> primitives) {
  const auto place = [&](const auto& solid) {
    if (solid.lower_by_sphere(x) > 0.0) return Place::outside;
    const auto own = solid.over(precise(x), {});
    return own ? place_in(own->range, solid.bounds()) : Place::undecided;
  };
  std::vector<Place> places;
  for (const PosedPrimitive& primitive : primitives) places.push_back(std::visit(place, primitive));
  return place_of(set, places);
}

/// At one cell.
struct EmptyBall::Look {
  /// Begins with the cell's faces as cuts.
  Look(const EmptyBall& of, const Cell& at)
      : ball(of), cell(at), offset(at.offset[0], at.offset[1], at.offset[2]), places(of.places_), own(places.size()) {
    for (std::size_t i = 0; i < 6; ++i) {
      PreciseVector axis;
      axis[i / 2] = i % 2 == 0 ? 1 : -1;
      cuts.push_back({axis, at.half[i / 2]});
    }
  }

  void place_primitives() {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto look = [&](const auto& solid) {
        own[i] = solid.over(ball.centre_ + offset, cell.half);
        if (own[i]) places[i] = place_in(own[i]->range, solid.bounds());
      };
      if (places[i] == Place::undecided) std::visit(look, ball.primitives_[i]);
    }
  }

  [[nodiscard]] bool is_far() const {
    const Real least = ball.square_of_radius_.upper();
    const auto m = multipliers(offset, cuts, least.to_double(Direction::up));
    return m && least_square(offset, cuts, *m) >= least;
  }

  /// Where the set is one primitive.
  void cut_by(const SetExpression& set, Place wanted) {
    if (!set.operands.empty() || places[set.primitive] != Place::undecided || !own[set.primitive]) return;
    const auto add_cuts = [&](const auto& solid) {
      const OwnRegion& image = *own[set.primitive];
      const std::optional<PreciseVector> w = near_gradient(solid.superquadric(), image.centre);
      if (w && wanted == Place::inside) cuts.push_back(cut_outside(image, cell.half, solid.bounds(), *w));
      if (w && wanted == Place::outside) cuts.push_back(cut_inside(image, solid.bounds(), *w));
      const std::optional<PreciseVector>& touching = ball.touching_[set.primitive];
      if (touching && wanted == Place::outside) cuts.push_back(cut_inside(image, solid.bounds(), *touching));
    };
    std::visit(add_cuts, ball.primitives_[set.primitive]);
  }

  /// Whether what of the set, with Place::inside of the closure of its complement, lies in the cell and in the cuts is
  /// proven to be far. Leaves the cuts as they were.
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

  const EmptyBall& ball;
  const Cell& cell;
  PreciseVector offset;
  std::vector<Place> places;
  std::vector<std::optional<OwnRegion>> own;  ///< of primitives that are undecided in the whole ball
  std::vector<Cut> cuts;
};

EmptyBall::EmptyBall(const SetExpression& set, std::span<const PosedPrimitive> primitives, const Point& centre,
                     double radius, Place wanted, std::span<const Normal> normals, const std::optional<Point>& near)
    : set_(set),
      primitives_(primitives),
      centre_(precise(centre)),
      square_of_radius_(square(PreciseInterval(Real(radius)))),
      radius_(radius),
      wanted_(wanted),
      places_(primitives.size(), Place::undecided),
      touching_(primitives.size()) {
  for (const auto& [i, vector] : normals) {
    const Proposal v{vector[0], vector[1], vector[2]};
    const auto look = [&](const auto& solid) {
      if (solid.lower_by_normal(centre, v) >= radius) return Place::outside;
      return solid.contains(centre) && solid.contains_ball_about(centre, radius, v) ? Place::inside : Place::undecided;
    };
    if (places_[i] == Place::undecided) places_[i] = std::visit(look, primitives[i]);
  }
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const auto look = [&](const auto& solid) {
      if (solid.lower_by_sphere(centre) >= radius) places_[i] = Place::outside;
      const auto own = near ? solid.over(precise(*near), {}) : std::nullopt;
      if (own) touching_[i] = near_gradient(solid.superquadric(), own->centre);
    };
    if (places_[i] == Place::undecided) std::visit(look, primitives[i]);
  }
}

std::array<EmptyBall::Cell, 2> EmptyBall::halves(const Cell& cell) {
  const auto axis = static_cast<std::size_t>(cell.depth % 3);
  std::array<Cell, 2> result{cell, cell};
  for (Cell& each : result) each.half[axis] = multiply(cell.half[axis], Real(0.5), Direction::up);
  for (Cell& each : result) ++each.depth;
  result[0].offset[axis] = subtract(cell.offset[axis], result[0].half[axis], Direction::down);
  result[1].offset[axis] = add(cell.offset[axis], result[1].half[axis], Direction::up);
  return result;
}

bool EmptyBall::is_empty(const Cell& cell) const {
  Look look(*this, cell);
  if (look.is_far()) return true;
  look.place_primitives();
  return look.is_far(set_, wanted_);
}

bool EmptyBall::is_covered_by(const std::vector<bool>& cover) const {
  if (cover.size() > longest_cover) return false;
  std::vector<Cell> open{whole()};
  for (const bool halved : cover) {
    if (open.empty() || (halved && open.back().depth == deepest)) return false;
    const Cell cell = open.back();
    open.pop_back();
    if (!halved && !is_empty(cell)) return false;
    if (halved) open.insert(open.end(), {halves(cell)[1], halves(cell)[0]});
  }
  return open.empty();
}

}  // namespace verisq::verify
