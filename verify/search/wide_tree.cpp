/// This file implements wide_tree.hpp.
#include "verify/search/wide_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/search/triangle_geometry.hpp"

// Vectors are handed only to functions that are inlined: no interface between them depends on the processor.
#pragma GCC diagnostic ignored "-Wpsabi"

// Where the compiler makes several versions of a function and the program takes the widest that its processor knows.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VERISQ_WIDEST_VECTORS [[gnu::target_clones("default", "avx2", "arch=x86-64-v4")]]
#else
#define VERISQ_WIDEST_VECTORS
#endif

namespace verisq::verify {

namespace {

// Lanes: eight numbers at a time.

template <class Number>
struct LaneTypes;
template <>
struct LaneTypes<float> {
  typedef float Vector __attribute__((vector_size(32)));
  typedef std::int32_t Mask __attribute__((vector_size(32)));
};
template <>
struct LaneTypes<double> {
  typedef double Vector __attribute__((vector_size(64)));
  typedef std::int64_t Mask __attribute__((vector_size(64)));
};
template <class Number>
using Lanes = typename LaneTypes<Number>::Vector;
template <class Number>
using LaneMask = typename LaneTypes<Number>::Mask;

template <class Number>
[[gnu::always_inline]] inline Lanes<Number> load(const std::array<float, 8>& row) {
  Lanes<float> narrow;
  std::memcpy(&narrow, row.data(), sizeof narrow);
  return __builtin_convertvector(narrow, Lanes<Number>);
}

template <class Vector>
[[gnu::always_inline]] inline Vector greater(const Vector& a, const Vector& b) {
  return a > b ? a : b;
}

template <class Vector>
[[gnu::always_inline]] inline Vector lesser(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}

template <class Vector>
[[gnu::always_inline]] inline Vector dot(const std::array<Vector, 3>& a, const std::array<Vector, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// One bit a lane.
[[gnu::always_inline]] inline unsigned bits_of(const LaneMask<float>& mask) {
  const LaneMask<float> bits = mask & LaneMask<float>{1, 2, 4, 8, 16, 32, 64, 128};
  std::array<std::uint64_t, 4> words;
  std::memcpy(words.data(), &bits, sizeof words);
  const std::uint64_t both = (words[0] | words[1]) | (words[2] | words[3]);
  return static_cast<unsigned>(both | (both >> 32U));
}
[[gnu::always_inline]] inline unsigned bits_of(const LaneMask<double>& mask) {
  return bits_of(__builtin_convertvector(mask, LaneMask<float>));
}

}  // namespace

WideTree::WideTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  lower_ = upper_ = triangles_[0][0];
  for (const Triangle& triangle : triangles_) {
    for (const Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower_[i] = std::min(lower_[i], corner[i]);
        upper_[i] = std::max(upper_[i], corner[i]);
      }
    }
  }
  double radius = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    centre_[i] = lower_[i] / 2 + upper_[i] / 2;
    radius = std::max({radius, upper_[i] - centre_[i], centre_[i] - lower_[i]});
  }
  // A mesh of one point only has no size.
  scale_ = std::ldexp(1.0, -std::ilogb(std::max(radius, 0x1p-60 * largest_coordinate(std::array{lower_, upper_}))) - 1);
  build();
}

std::array<double, 3> WideTree::scaled(const Point& point) const {
  return {(point[0] - centre_[0]) * scale_, (point[1] - centre_[1]) * scale_, (point[2] - centre_[2]) * scale_};
}

// The nearest triangle.

namespace {

/// Into the cache: it is needed soon.
[[gnu::always_inline]] inline void fetch(const void* data, std::size_t size) {
  constexpr std::size_t line = 64;
  for (std::size_t at = 0; at < size; at += line) __builtin_prefetch(static_cast<const char*>(data) + at);
}

}  // namespace

/// Boxes and leaves are seen in `Number`, scaled, and pass over what is proven to be farther than the nearest triangle
/// so far; what is left is bounded in binary64.
///
/// Scaled coordinates of corners are at most 1 and off by 2^-24, those of the query, |q|, by e |q|, their differences
/// by e (1 + |q|), e = 2^-24 or 2^-53: `slack` is 4 e (1 + |q|) + 2^-22, four times all that together. A box's squared
/// distance rounds by 6 e, relatively. A product n·x of three terms rounds by 3.03 e |n||x|, |x| <= √3 (1 + |q|), and
/// displacements add √3/4 slack |n|: 1.8 slack |n| in all. So what exceeds the square of (reach + 4 slack) (1 + 2^-19),
/// by boxes or by n, is farther than `reach`. Squares that underflow are beside slack^2 > 2^-44 nothing, as |n|^2 >=
/// 2^-80 is asked for.
template <class Number>
class WideTree::Search {
 public:
  [[gnu::always_inline]] Search(const WideTree& tree, const Point& point, Nearest& found)
      : tree_(tree), point_(point), found_(found) {
    const auto place = tree.scaled(point);
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t lane = 0; lane < width; ++lane) query_[i][lane] = static_cast<Number>(place[i]);
      largest = std::max(largest, std::abs(place[i]));
    }
    constexpr double rounding = sizeof(Number) == sizeof(float) ? 0x1p-24 : 0x1p-53;
    slack_ = 4.0 * rounding * (1.0 + largest) + 0x1p-22;
    found.distance = {infinity, infinity};
    found.triangle = 0;
    found.count = 0;
    found.complete = true;
  }

  [[gnu::always_inline]] void run(std::optional<std::uint32_t> hint) {
    if (hint) {
      hinted_ = tree_.leaf_of_[tree_.place_of_[*hint]] | leaf_bit;
      look_at(tree_.leaves_[hinted_ & ~leaf_bit]);
    }
    size_ = 0;
    divide(tree_.nodes_[0]);
    while (size_ > 0) {
      const Open next = open_[--size_];
      if (next.square > limit_ || next.child == hinted_) continue;
      if ((next.child & leaf_bit) != 0) {
        look_at(tree_.leaves_[next.child & ~leaf_bit]);
      } else {
        divide(tree_.nodes_[next.child]);
      }
    }
    finish();
  }

 private:
  using Vector = Lanes<Number>;
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
      const Vector outside = greater<Vector>(
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

  [[gnu::always_inline]] Vector limit_lanes() const { return Vector{} + limit_; }

  /// The vector from the query to the nearest point, about, of each of eight triangles.
  [[gnu::always_inline]] static Space nearest_points(const Space& a, const Space& b, const Space& c) {
    Space ab, ac, bc;
    for (std::size_t i = 0; i < 3; ++i) {
      ab[i] = b[i] - a[i];
      ac[i] = c[i] - a[i];
      bc[i] = c[i] - b[i];
    }
    const Vector d00 = dot(ab, ab), d01 = dot(ab, ac), d11 = dot(ac, ac);
    const Vector d20 = -dot(a, ab), d21 = -dot(a, ac);
    const Vector one = Vector{} + Number(1);
    const Vector inverse = one / (d00 * d11 - d01 * d01);
    const Vector v = (d11 * d20 - d01 * d21) * inverse;
    const Vector w = (d00 * d21 - d01 * d20) * inverse;
    const auto inside = (v >= Vector{}) & (w >= Vector{}) & (v + w <= one);
    const Vector on_ab = clamp01(d20 / d00), on_ac = clamp01(d21 / d11), on_bc = clamp01(-dot(b, bc) / dot(bc, bc));
    Space to_ab, to_ac, to_bc;
    for (std::size_t i = 0; i < 3; ++i) {
      to_ab[i] = a[i] + on_ab * ab[i];
      to_ac[i] = a[i] + on_ac * ac[i];
      to_bc[i] = b[i] + on_bc * bc[i];
    }
    const Vector e1 = dot(to_ab, to_ab), e2 = dot(to_ac, to_ac), e3 = dot(to_bc, to_bc);
    const auto second = e2 < e1;
    const auto third = e3 < (second ? e2 : e1);
    Space nearest;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector side = third ? to_bc[i] : (second ? to_ac[i] : to_ab[i]);
      nearest[i] = inside ? a[i] + v * ab[i] + w * ac[i] : side;
    }
    return nearest;
  }

  [[gnu::always_inline]] static Vector clamp01(const Vector& x) {
    return lesser<Vector>(greater<Vector>(x, Vector{}), Vector{} + Number(1));
  }

  [[gnu::always_inline]] void look_at(const Leaf& leaf) {
    fetch(&tree_.triangles_[leaf.first], leaf.count * sizeof(Triangle));
    std::array<Space, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) corner[k][i] = load<Number>(leaf.corner[k][i]) - query_[i];
    }
    const Space n = nearest_points(corner[0], corner[1], corner[2]);
    const Vector square = dot(n, n);
    const Vector least = greater<Vector>(
        lesser<Vector>(lesser<Vector>(dot(n, corner[0]), dot(n, corner[1])), dot(n, corner[2])), Vector{});
    const Vector product = least * least;
    // No lane is passed over for a number that is none.
    const auto farther = (product > limit_lanes() * square) & (square >= Vector{} + Number(0x1p-80F));
    unsigned open = ~bits_of(farther) & ((1U << leaf.count) - 1U);
    if (open == 0) return;
    std::array<Number, width> squares, products;
    std::memcpy(squares.data(), &square, sizeof square);
    std::memcpy(products.data(), &product, sizeof product);
    auto nearest = static_cast<unsigned>(__builtin_ctz(open));
    for (unsigned rest = open & (open - 1); rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(rest));
      if (squares[lane] < squares[nearest]) nearest = lane;
    }
    look_at(leaf.first + nearest);
    for (open &= ~(1U << nearest); open != 0; open &= open - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(open));
      if (products[lane] > limit_ * squares[lane] && squares[lane] >= Number(0x1p-80F)) continue;
      look_at(leaf.first + lane);
    }
  }

  void look_at(std::uint32_t place) {
    const DistanceBounds bounds = distance_bounds(point_, tree_.triangles_[place]);
    if (bounds.lower > found_.distance.hi) return;
    if (bounds.upper < found_.distance.hi) {
      found_.distance.hi = bounds.upper;
      found_.triangle = place;
      found_.way = bounds.way;
      const double reach = (bounds.upper * tree_.scale_ + 4.0 * slack_) * (1.0 + 0x1p-19);
      limit_ = static_cast<Number>(std::min(reach * reach, double{beyond_all}));
    }
    if (found_.count == found_.near.size()) drop_farther();
    if (found_.count == found_.near.size()) {
      found_.complete = false;
      dropped_ = std::min(dropped_, bounds.lower);
    } else {
      found_.near[found_.count++] = {bounds.lower, place};
    }
  }

  void drop_farther() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found_.count; ++i) {
      if (found_.near[i].lower <= found_.distance.hi) found_.near[kept++] = found_.near[i];
    }
    found_.count = kept;
  }

  void finish() {
    drop_farther();
    found_.distance.lo = std::min(dropped_, found_.distance.hi);
    for (std::size_t i = 0; i < found_.count; ++i) {
      found_.distance.lo = std::min(found_.distance.lo, found_.near[i].lower);
      found_.near[i].triangle = tree_.number_of_[found_.near[i].triangle];
    }
    found_.triangle = tree_.number_of_[found_.triangle];
  }

  const WideTree& tree_;
  const Point& point_;
  Nearest& found_;
  Space query_{};
  double slack_ = 0.0;
  double dropped_ = infinity;
  Number limit_ = beyond_all;
  std::uint32_t hinted_ = 0;  ///< the leaf that was looked at before; 0 is the root
  std::size_t size_ = 0;
  std::array<Open, most_open> open_;
};

VERISQ_WIDEST_VECTORS
void WideTree::search_near(const Point& point, std::optional<std::uint32_t> hint, Nearest& found) const {
  Search<float>(*this, point, found).run(hint);
}

VERISQ_WIDEST_VECTORS
void WideTree::search_far(const Point& point, std::optional<std::uint32_t> hint, Nearest& found) const {
  Search<double>(*this, point, found).run(hint);
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

WideTree::Nearest WideTree::nearest(const Point& point, std::optional<std::uint32_t> hint) const {
  constexpr double near = 16.0;  // sizes: so far binary32 tells triangles apart
  const double place = largest_coordinate(scaled(point));
  Nearest found;
  if (place <= near) {
    search_near(point, hint, found);
  } else if (place <= farthest) {
    search_far(point, hint, found);
  } else {
    see_from_afar(point, found);
  }
  return found;
}

// All that is near a point, a triangle or a ray.

template <class Visit>
void WideTree::visit(const std::array<float, 3>& lower, const std::array<float, 3>& upper, const Visit& leaf) const {
  std::array<std::uint32_t, most_open> open;
  std::size_t size = 0;
  open[size++] = 0;
  while (size > 0) {
    const std::uint32_t next = open[--size];
    if ((next & leaf_bit) != 0) {
      leaf(leaves_[next & ~leaf_bit]);
      continue;
    }
    const Node& node = nodes_[next];
    LaneMask<float> meets = ~LaneMask<float>{};
    for (std::size_t i = 0; i < 3; ++i) {
      meets &= (load<float>(node.lower[i]) <= Lanes<float>{} + upper[i]) &
               (load<float>(node.upper[i]) >= Lanes<float>{} + lower[i]);
    }
    for (unsigned lanes = bits_of(meets); lanes != 0; lanes &= lanes - 1)
      open[size++] = node.child[__builtin_ctz(lanes)];
  }
}

namespace {

/// Bounds how far rounding to binary32 moves a corner, a point and the end of a box together, in scaled coordinates:
/// each is at most 2, and moves by at most 2^-24.
constexpr float displacement = 0x1p-21F;

/// Which triangles of a leaf meet a box.
unsigned lanes_that_meet(const std::array<std::array<std::array<float, 8>, 3>, 3>& corner,
                         const std::array<float, 3>& lower, const std::array<float, 3>& upper) {
  LaneMask<float> meets = ~LaneMask<float>{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto a = load<float>(corner[0][i]);
    const auto b = load<float>(corner[1][i]);
    const auto c = load<float>(corner[2][i]);
    meets &= (lesser(lesser(a, b), c) <= Lanes<float>{} + upper[i]) &
             (greater(greater(a, b), c) >= Lanes<float>{} + lower[i]);
  }
  return bits_of(meets);
}

}  // namespace

void WideTree::within(const Point& point, double reach, std::vector<std::uint32_t>& found) const {
  const auto place = scaled(point);
  const double half = reach * scale_ * (1.0 + 0x1p-20);
  std::array<float, 3> lower, upper;
  for (std::size_t i = 0; i < 3; ++i) {
    const double margin = half + displacement + std::abs(place[i]) * 0x1p-22;
    lower[i] = static_cast<float>(std::clamp(place[i] - margin, -2.0, 2.0));
    upper[i] = static_cast<float>(std::clamp(place[i] + margin, -2.0, 2.0));
  }
  visit(lower, upper, [&](const Leaf& leaf) {
    const unsigned lanes = lanes_that_meet(leaf.corner, lower, upper);
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      if ((lanes >> lane & 1U) != 0) found.push_back(number_of_[leaf.first + lane]);
    }
  });
}

void WideTree::overlapping(std::uint32_t triangle, std::vector<std::uint32_t>& found) const {
  const std::uint32_t own = place_of_[triangle];
  std::array<float, 3> lower{2.0F, 2.0F, 2.0F};
  std::array<float, 3> upper{-2.0F, -2.0F, -2.0F};
  for (const Point& corner : triangles_[own]) {
    const auto place = scaled(corner);
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], static_cast<float>(place[i]) - displacement);
      upper[i] = std::max(upper[i], static_cast<float>(place[i]) + displacement);
    }
  }
  visit(lower, upper, [&](const Leaf& leaf) {
    if (leaf.first + leaf.count <= own + 1) return;
    const unsigned lanes = lanes_that_meet(leaf.corner, lower, upper);
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      const std::uint32_t place = leaf.first + lane;
      if (place > own && (lanes >> lane & 1U) != 0) found.push_back(number_of_[place]);
    }
  });
}

void WideTree::along_ray(const Point& point, std::size_t axis, bool upward, std::vector<std::uint32_t>& found) const {
  const auto place = scaled(point);
  std::array<float, 3> lower, upper;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto here = static_cast<float>(std::clamp(place[i], -2.0, 2.0));
    lower[i] = i == axis && !upward ? -2.0F : here - displacement;
    upper[i] = i == axis && upward ? 2.0F : here + displacement;
  }
  visit(lower, upper, [&](const Leaf& leaf) {
    const unsigned lanes = lanes_that_meet(leaf.corner, lower, upper);
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      if ((lanes >> lane & 1U) != 0) found.push_back(number_of_[leaf.first + lane]);
    }
  });
}

}  // namespace verisq::verify
