/// This file finds the nearest of the triangles of wide_tree.hpp.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/search/triangle_geometry.hpp"
#include "verify/search/wide_tree.hpp"

namespace verisq::verify {

namespace {

/// Into the cache: it is needed soon.
[[gnu::always_inline]] inline void fetch(const void* data, std::size_t size) {
  constexpr std::size_t line = 64;
  for (std::size_t at = 0; at < size; at += line) __builtin_prefetch(static_cast<const char*>(data) + at);
}

}  // namespace

/// Triangles that may be nearest to one point.
struct WideTree::Candidates {
  static constexpr std::size_t most = 64;

  double limit = 0.0;  ///< of squares, scaled, that were not passed over; on entry, the least that is asked for
  std::size_t size = 0;
  bool crowded = false;  ///< there were more, of which not all are here
  std::array<std::uint32_t, most + width> place;
};

/// Bounds in binary64 of four candidates.
struct alignas(32) WideTree::Measured {
  std::array<double, 4> lower;
  std::array<double, 4> upper;
  std::array<std::array<double, 4>, 3> way;
  std::array<double, 4> side;  ///< of its plane on which the point is proven to lie; 0 where it is not
};

/// Boxes and leaves are seen in `Number`, scaled, and pass over what is proven to be farther than the nearest triangle;
/// what is left is measured in binary64. All operations are those of IEEE 754, none is fused.
///
/// Scaled coordinates of corners are at most 1 and off by 2^-24, those of the query, |q|, by e |q|, their differences
/// by e (1 + |q|), e = 2^-24 or 2^-53: S, the slack, 8 e (1 + |q|) + 2^-22, is at least four times all that together.
///
/// *Passed over.* Boxes displace by √3/4 S < 0.44 S. A product n·x of three terms rounds by 3.03 e |n||x|, |x| <= √3
/// (1 + |q|), which is below 0.67 S |n|; displacements add 0.44 S |n|. Squares, their sums, quotient and root round by
/// less than 10 e, relatively. So what exceeds the square of (reach + 2 S) (1 + 2^-19), by boxes or by n, is farther
/// than `reach`. Squares that underflow are beside S^2 > 2^-44 nothing, as |n|^2 >= 2^-80 is asked for.
///
/// *Approached.* By points of triangles a limit is proposed: displacements and roundings of a + v ab + w ac are
/// below 2.2 S. Nothing rests on it: `find` compares it with that of the proven upper end.
template <class Number>
class WideTree::Search {
 public:
  [[gnu::always_inline]] Search(const WideTree& tree, const Point& point) : tree_(tree) {
    const auto place = tree.scaled(point);
    for (std::size_t i = 0; i < 3; ++i) query_[i] = Vector{} + static_cast<Number>(place[i]);
    slack_ = static_cast<Number>(WideTree::slack(place));
  }

  [[gnu::always_inline]] void run(std::optional<std::uint32_t> hint, Candidates& found) {
    found.size = 0;
    found.crowded = false;
    least_limit_ = static_cast<Number>(found.limit * (1.0 + 0x1p-20));
    if (hint) {
      hinted_ = tree_.leaf_of_[tree_.place_of_[*hint]] | leaf_bit;
      look_at(tree_.leaves_[hinted_ & ~leaf_bit], found);
    }
    size_ = 0;
    divide(tree_.nodes_[0]);
    while (size_ > 0) {
      const Open next = open_[--size_];
      if (next.square > limit_ || next.child == hinted_) continue;
      if ((next.child & leaf_bit) != 0) {
        look_at(tree_.leaves_[next.child & ~leaf_bit], found);
      } else {
        divide(tree_.nodes_[next.child]);
      }
    }
    drop_farther(found);
    found.limit = limit_;
  }

  /// Bounds of squared distances, of a leaf's triangles, by boxes or by n.
  [[gnu::always_inline]] void bound(const Leaf& leaf, std::array<double, width>& lowers) const {
    const SeenLeaf seen = see(leaf);
    Vector box{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& [a, b, c] = std::array{seen.corner[0][i], seen.corner[1][i], seen.corner[2][i]};
      const auto outside = greater<Vector>(
          greater<Vector>(lesser<Vector>(lesser<Vector>(a, b), c), -greater<Vector>(greater<Vector>(a, b), c)),
          Vector{});
      box += outside * outside;
    }
    const auto best = greater<Vector>(box, seen.lower);
    for (std::size_t lane = 0; lane < width; ++lane) lowers[lane] = best[lane];
  }

 private:
  using Vector = Lanes<Number, 8>;
  using Space = std::array<Vector, 3>;

  struct Open {
    Number square;  ///< of the distance of its box
    std::uint32_t child;
  };

  /// Empty places of nodes are farther, everything else is nearer.
  static constexpr Number beyond_all = Number(0x1p110F);

  [[gnu::always_inline]] void divide(const Node& node) {
    Vector square{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto outside = greater<Vector>(
          greater<Vector>(load<Number>(node.lower[i]) - query_[i], query_[i] - load<Number>(node.upper[i])), Vector{});
      square += outside * outside;
    }
    std::array<Number, width> squares;
    std::memcpy(squares.data(), &square, sizeof square);
    // The nearest child comes next, the others in no order: most of them are passed over then.
    const std::size_t base = size_;
    for (unsigned near = bits_of(square <= limit_lanes()); near != 0; near &= near - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(near));
      Open added{squares[lane], node.child[lane]};
      if (size_ > base && open_[size_ - 1].square < added.square) std::swap(open_[size_ - 1], added);
      open_[size_++] = added;
    }
    if (size_ == base) return;
    const std::uint32_t next = open_[size_ - 1].child;
    if ((next & leaf_bit) != 0) {
      fetch(&tree_.leaves_[next & ~leaf_bit], sizeof(Leaf));
    } else {
      fetch(&tree_.nodes_[next], sizeof(Node));
    }
  }

  [[nodiscard, gnu::always_inline]] Vector limit_lanes() const { return Vector{} + limit_; }

  struct SeenLeaf {
    std::array<Space, 3> corner;  ///< less the query
    Vector square;                ///< of the distance of a point of each triangle
    Vector lower;                 ///< squared
  };

  [[nodiscard, gnu::always_inline]] SeenLeaf see(const Leaf& leaf) const {
    SeenLeaf seen;
    Space ab;
    Space ac;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) seen.corner[k][i] = load<Number>(leaf.corner[k][i]) - query_[i];
      ab[i] = seen.corner[1][i] - seen.corner[0][i];
      ac[i] = seen.corner[2][i] - seen.corner[0][i];
    }
    const auto& [a, b, c] = seen.corner;
    const Shares<Vector> shares = nearest_shares<Vector>(a, b, ab, ac);
    Space n;
    for (std::size_t i = 0; i < 3; ++i) n[i] = a[i] + shares.b * ab[i] + shares.c * ac[i];
    seen.square = inner(n, n);
    const auto least = greater<Vector>(lesser<Vector>(lesser<Vector>(inner(n, a), inner(n, b)), inner(n, c)), Vector{});
    seen.lower = seen.square >= Vector{} + Number(0x1p-80F) ? least * least / seen.square : Vector{};
    return seen;
  }

  [[gnu::always_inline]] void look_at(const Leaf& leaf, Candidates& found) {
    fetch(&tree_.triangles_[leaf.first], leaf.count * sizeof(Triangle));
    const SeenLeaf seen = see(leaf);
    std::array<Number, width> squares;
    std::array<Number, width> lowers;
    std::memcpy(squares.data(), &seen.square, sizeof squares);
    std::memcpy(lowers.data(), &seen.lower, sizeof lowers);
    approach(*std::min_element(squares.begin(), squares.end()));
    const unsigned open = ~bits_of(seen.lower > limit_lanes()) & ((1U << leaf.count) - 1U);
    for (unsigned lane = 0; lane < width; ++lane) {
      found.place[found.size] = leaf.first + lane;
      lower_[found.size] = lowers[lane];
      found.size += (open >> lane) & 1U;
    }
    if (found.size > Candidates::most) make_room(found);
  }

  /// A point of a triangle is so far, squared, about.
  [[gnu::always_inline]] void approach(Number square) {
    best_ = std::min(best_, square);
    const Number reach = (std::sqrt(best_) + 5 * slack_) * Number(1.0F + 0x1p-18F);
    limit_ = std::max(least_limit_, reach * reach);
  }

  [[gnu::always_inline]] void drop_farther(Candidates& found) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found.size; ++i) {
      found.place[kept] = found.place[i];
      lower_[kept] = lower_[i];
      kept += lower_[i] > limit_ ? 0 : 1;
    }
    found.size = kept;
  }

  [[gnu::always_inline]] void make_room(Candidates& found) {
    drop_farther(found);
    if (found.size <= Candidates::most) return;
    found.crowded = true;
    found.size = 0;
  }

  Space query_{};
  const WideTree& tree_;
  std::size_t size_ = 0;
  Number slack_;
  Number least_limit_ = 0;
  Number best_ = beyond_all;
  Number limit_ = beyond_all;
  std::uint32_t hinted_ = 0;                            ///< the leaf that was looked at before; 0 is the root
  std::array<Number, Candidates::most + width> lower_;  ///< squared, of candidates
  std::array<Open, most_open> open_;
};

/// S, and the limit of squares, both of `Search`.
double WideTree::slack(const std::array<double, 3>& place) {
  const double largest = largest_coordinate(place);
  const double rounding = largest <= near_in_sizes ? 0x1p-24 : 0x1p-53;
  return 8.0 * rounding * (1.0 + largest) + 0x1p-22;
}

double WideTree::limit_of(double reach, double slack) {
  const double limit = (reach + 2.0 * slack) * (1.0 + 0x1p-19);
  return limit * limit;
}

VERISQ_WIDEST_VECTORS
void WideTree::search_near(const Point& point, std::optional<std::uint32_t> hint, Candidates& found) const {
  Search<float>(*this, point).run(hint, found);
}

VERISQ_WIDEST_VECTORS
void WideTree::search_far(const Point& point, std::optional<std::uint32_t> hint, Candidates& found) const {
  Search<double>(*this, point).run(hint, found);
}

namespace {

using FourLanes = Lanes<double, 4>;

/// The corners of four triangles, one triangle a lane.
[[gnu::always_inline]] inline std::array<std::array<FourLanes, 3>, 3> in_lanes(
    const std::array<const Triangle*, 4>& triangles) {
  std::array<std::array<FourLanes, 3>, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      corners[k][i] =
          FourLanes{(*triangles[0])[k][i], (*triangles[1])[k][i], (*triangles[2])[k][i], (*triangles[3])[k][i]};
    }
  }
  return corners;
}

}  // namespace

/// By fours, the last one repeated. Needles, and what lies near the plane, are bounded one by one.
VERISQ_WIDEST_VECTORS
void WideTree::measure(const Point& point, std::span<const std::uint32_t> places, std::span<Measured> found) const {
  const std::array<FourLanes, 3> query{FourLanes{} + point[0], FourLanes{} + point[1], FourLanes{} + point[2]};
  for (std::size_t first = 0; first < places.size(); first += 4) {
    Measured& four = found[first / 4];
    std::array<const Triangle*, 4> triangles;
    for (std::size_t lane = 0; lane < 4; ++lane)
      triangles[lane] = &triangles_[places[std::min(first + lane, places.size() - 1)]];
    const SeenTriangle<FourLanes> seen(query, in_lanes(triangles));
    const Shares<FourLanes> shares = nearest_shares<FourLanes>(seen.a, seen.b, seen.ab, seen.ac);
    const BoundsOfDistance<FourLanes> bounds = bounds_at(seen, clamped(shares.b, shares.c));
    const FourLanes side = proven_side(seen);
    std::memcpy(four.lower.data(), &bounds.lower, sizeof bounds.lower);
    std::memcpy(four.upper.data(), &bounds.upper, sizeof bounds.upper);
    std::memcpy(four.way.data(), &bounds.way, sizeof bounds.way);
    std::memcpy(four.side.data(), &side, sizeof side);
    const auto loose = are_loose(seen, bounds);
    if ((loose[0] | loose[1] | loose[2] | loose[3]) == 0) continue;
    for (std::size_t lane = 0; lane < 4; ++lane) {
      if (loose[lane] == 0) continue;
      const DistanceBounds better = distance_bounds(point, *triangles[lane]);
      four.lower[lane] = better.lower;
      four.upper[lane] = better.upper;
      for (std::size_t i = 0; i < 3; ++i) four.way[i][lane] = better.way[i];
    }
  }
}

/// The mesh is within 2 √3 scaled units of the corner of its box, which is at least 2^46 - 2 of them away: 2^-44.
/// Differences and length round by less than 2^-49. A length beyond binary64 is at least its largest component.
void WideTree::see_from_afar(const Point& point, Nearest& found) const {
  const Point way{lower_[0] - point[0], lower_[1] - point[1], lower_[2] - point[2]};
  const double about = length(way[0], way[1], way[2]);
  const double margin = about * 0x1p-43;
  found.distance = {std::isfinite(about) ? subtract(about, margin, Direction::down) : largest_coordinate(way) / 2,
                    add(about, margin, Direction::up)};
  found.triangle = number_of_.front();
  const Point& corner = triangles_.front()[0];
  found.way = {corner[0] - point[0], corner[1] - point[1], corner[2] - point[2]};
  found.count = 0;
  found.complete = false;
}

double WideTree::least_upper(std::span<const Measured> measured, std::size_t count) {
  double least = infinity;
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, measured[i / 4].upper[i % 4]);
  return least;
}

/// Triangles that were passed over are farther than the reach of the limit. If that is no less than the upper end, they
/// hold no nearest point, and their upper ends are larger; else the search begins again with the limit of the upper
/// end.
void WideTree::find(const Point& point, std::optional<std::uint32_t> hint, Nearest& found) const {
  const auto place = scaled(point);
  const double off = slack(place);
  Candidates candidates;
  std::array<Measured, Candidates::most / 4 + 2> measured;
  for (;;) {
    if (largest_coordinate(place) <= near_in_sizes) {
      search_near(point, hint, candidates);
    } else {
      search_far(point, hint, candidates);
    }
    if (candidates.crowded) return find_in_crowd(point, std::sqrt(candidates.limit) / scale_, found);
    const std::span<const std::uint32_t> places(candidates.place.data(), candidates.size);
    measure(point, places, measured);
    const double upper = least_upper(measured, places.size());
    const double limit = limit_of(upper * scale_, off);
    if (limit <= candidates.limit) return choose(point, places, measured, upper, found);
    candidates.limit = limit;
  }
}

/// All within a cube about the ball that is wider by 4 S: what lies beyond is farther by boxes, too (`choose`).
void WideTree::find_in_crowd(const Point& point, double reach, Nearest& found) const {
  for (;;) {
    std::vector<std::uint32_t> places;
    within(point, reach + 4.0 * slack(scaled(point)) / scale_, places);
    for (std::uint32_t& place : places) place = place_of_[place];
    std::vector<Measured> measured((places.size() + 3) / 4);
    measure(point, places, measured);
    const double upper = least_upper(measured, places.size());
    if (upper <= reach) return choose(point, places, measured, upper, found);
    reach = upper;
  }
}

VERISQ_WIDEST_VECTORS
void WideTree::bound_near(const Point& point, const Leaf& leaf, std::array<double, width>& lowers) const {
  Search<float>(*this, point).bound(leaf, lowers);
}

VERISQ_WIDEST_VECTORS
void WideTree::bound_far(const Point& point, const Leaf& leaf, std::array<double, width>& lowers) const {
  Search<double>(*this, point).bound(leaf, lowers);
}

/// True proves that the triangle is farther than `reach`. Whatever a search passes over is, if its limit is at least
/// that of `reach`: so what is kept depends on the point alone.
bool WideTree::is_proven_farther(const Point& point, double reach, double upper, std::uint32_t place) const {
  const auto query = scaled(point);
  const double off = slack(query);
  if (upper * scale_ <= reach * scale_ + off / 2.0) return false;
  const Leaf& leaf = leaves_[leaf_of_[place]];
  std::array<double, width> lowers;
  if (largest_coordinate(query) <= near_in_sizes) {
    bound_near(point, leaf, lowers);
  } else {
    bound_far(point, leaf, lowers);
  }
  return lowers[place - leaf.first] > limit_of(reach * scale_, off);
}

/// The least upper end is that of all triangles, and of those as near the first in the tree. A triangle whose lower end
/// is loose counts unless it is proven farther: so the answer depends on neither the hint nor the order of the search.
void WideTree::choose(const Point& point, std::span<const std::uint32_t> places, std::span<const Measured> measured,
                      double upper, Nearest& found) const {
  found.distance = {upper, upper};
  found.count = 0;
  found.complete = true;
  std::uint32_t nearest = 0xFFFFFFFFU;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Measured& four = measured[i / 4];
    const std::size_t lane = i % 4;
    if (four.lower[lane] > upper) continue;
    if (four.upper[lane] == upper) {
      if (places[i] < nearest) {
        nearest = places[i];
        found.way = {four.way[0][lane], four.way[1][lane], four.way[2][lane]};
      }
    } else if (is_proven_farther(point, upper, four.upper[lane], places[i])) {
      continue;
    }
    found.distance.lo = std::min(found.distance.lo, four.lower[lane]);
    if (found.count == found.near.size()) {
      found.complete = false;
    } else {
      found.near[found.count++] = {four.lower[lane], number_of_[places[i]], static_cast<std::int8_t>(four.side[lane])};
    }
  }
  found.triangle = number_of_[nearest];
}

WideTree::Nearest WideTree::nearest(const Point& point, std::optional<std::uint32_t> hint) const {
  Nearest found;
  if (largest_coordinate(scaled(point)) <= farthest) {
    find(point, hint, found);
  } else {
    see_from_afar(point, found);
  }
  return found;
}

}  // namespace verisq::verify
