/// This file implements wide_tree.hpp.
#include "verify/search/wide_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"

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

// The distance of a point from one triangle in binary64.

/// Shares of the second and the third corner: each in [0, 1], the sum at most 1 + u (u = 2^-53).
struct Shares {
  double b;
  double c;
};

struct Bounds {
  double lower;
  double upper;
  Point way;  ///< from the point to that of the triangle
};

/// Squares below it may underflow: no vector so short is a normal.
constexpr double least_square = 0x1p-900;
/// More than what underflows anywhere in these sums may hide, whose roots are below 2^-530.
constexpr double underflow = 0x1p-500;
/// Of the sums of magnitudes below: 10 u.
constexpr double share_of_magnitude = 10 * 0x1p-53;

/// A triangle as a point sees it. Differences of binary64 numbers round by u, relatively.
struct Seen {
  Point a, b, c;  ///< corners less the point
  Point ab, ac;
  double magnitude;  ///< no |a_i| + |ab_i| + |ac_i| is larger, but for rounding

  Seen(const Point& point, const Triangle& triangle) {
    magnitude = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = triangle[0][i] - point[i];
      b[i] = triangle[1][i] - point[i];
      c[i] = triangle[2][i] - point[i];
      ab[i] = triangle[1][i] - triangle[0][i];
      ac[i] = triangle[2][i] - triangle[0][i];
      magnitude = std::max(magnitude, std::abs(a[i]) + std::abs(ab[i]) + std::abs(ac[i]));
    }
  }
};

double inner(const Point& x, const Point& y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

Point outer(const Point& x, const Point& y) {
  return {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
}

Shares clamped(double b, double c) {
  const double first = b > 0.0 ? std::min(b, 1.0) : 0.0;  // false for NaN
  return {first, c > 0.0 ? std::min(c, 1.0 - first) : 0.0};
}

/// The triangle lies in {x : n·(x - q) >= least n·(corner - q)}, for any n (docs/mathematics.md §29). Products of n
/// with rounded differences X and their sums round by 4.01 u |n| |X|, |X| <= √3 magnitude: by 7.1 u magnitude in units
/// of |n|. |n|, the root and the quotient round by 4.01 u, of what is at most √3 magnitude: with the product below 8 u
/// of it are taken off by its factor.
double lower_by(const Seen& seen, const Point& n) {
  const double square = inner(n, n);
  if (!(square >= least_square)) return 0.0;
  const double least = std::min({inner(n, seen.a), inner(n, seen.b), inner(n, seen.c)});
  return std::max(0.0, least / std::sqrt(square) * (1.0 - 0x1p-50) - share_of_magnitude * seen.magnitude - underflow);
}

/// By the point a + b ab + c ac. Off it by at most u (3|a_i| + 4 b|ab_i| + 3 c|ac_i|) a coordinate, a little more for
/// products of errors, and by u|ac_i| for the sum of shares beyond 1: by 5.1 u √3 magnitude, which is below 9 u
/// magnitude. Its length rounds by 3 u, and each operation on it by one more: 8 u.
Bounds bounds_at(const Seen& seen, const Shares& shares) {
  Point way;
  for (std::size_t i = 0; i < 3; ++i) way[i] = seen.a[i] + shares.b * seen.ab[i] + shares.c * seen.ac[i];
  const double upper = std::sqrt(inner(way, way)) * (1.0 + 0x1p-50) + share_of_magnitude * seen.magnitude + underflow;
  return {lower_by(seen, way), upper, way};
}

/// The share of the end at the point of a side nearest to the origin; NaN where the ends coincide.
double near_share(const Point& from, const Point& way) {
  return -inner(from, way) / inner(way, way);
}

/// Needles, and what lies near the plane: sides and the plane's own normal know better.
Bounds with_sides_and_normal(const Seen& seen, Bounds bounds) {
  const Shares on_bc =
      clamped(near_share(seen.b, {seen.c[0] - seen.b[0], seen.c[1] - seen.b[1], seen.c[2] - seen.b[2]}), 0.0);
  const std::array sides{clamped(near_share(seen.a, seen.ab), 0.0), clamped(0.0, near_share(seen.a, seen.ac)),
                         Shares{1.0 - on_bc.b, on_bc.b}};
  for (const Shares& side : sides) {
    const Bounds other = bounds_at(seen, side);
    bounds.lower = std::max(bounds.lower, other.lower);
    if (other.upper < bounds.upper) {
      bounds.upper = other.upper;
      bounds.way = other.way;
    }
  }
  const Point normal = outer(seen.ab, seen.ac);
  bounds.lower = std::max({bounds.lower, lower_by(seen, normal), lower_by(seen, {-normal[0], -normal[1], -normal[2]})});
  return bounds;
}

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: which of corners, sides and face is nearest. It proposes only.
Shares near_shares(const Seen& seen) {
  const double d1 = -inner(seen.ab, seen.a);
  const double d2 = -inner(seen.ac, seen.a);
  if (d1 <= 0.0 && d2 <= 0.0) return {0.0, 0.0};
  const double d3 = -inner(seen.ab, seen.b);
  const double d4 = -inner(seen.ac, seen.b);
  if (d3 >= 0.0 && d4 <= d3) return {1.0, 0.0};
  const double d5 = -inner(seen.ab, seen.c);
  const double d6 = -inner(seen.ac, seen.c);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 1.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {d1 / (d1 - d3), 0.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {0.0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1.0 - share, share};
  }
  const double sum = va + vb + vc;
  return {vb / sum, vc / sum};
}

Bounds bounds_of(const Point& point, const Triangle& triangle) {
  const Seen seen(point, triangle);
  const Shares shares = near_shares(seen);
  const Bounds bounds = bounds_at(seen, clamped(shares.b, shares.c));
  if (bounds.upper - bounds.lower <= 64 * share_of_magnitude * seen.magnitude) return bounds;
  return with_sides_and_normal(seen, bounds);
}

}  // namespace

// Building.

/// Splits where the surface area heuristic is least among sixteen bins an axis (Wald 2007), and of all parts of a node
/// the one with the largest box first.
class WideTree::Builder {
 public:
  explicit Builder(WideTree& tree) : tree_(tree), items_(tree.triangles_.size()) {
    for (std::uint32_t n = 0; n < items_.size(); ++n) {
      Item& item = items_[n];
      item.triangle = n;
      for (const Point& corner : tree.triangles_[n]) {
        const auto place = tree.scaled(corner);
        for (std::size_t i = 0; i < 3; ++i) {
          item.box.lower[i] = std::min(item.box.lower[i], below(place[i]));
          item.box.upper[i] = std::max(item.box.upper[i], above(place[i]));
        }
      }
    }
  }

  void build() {
    tree_.nodes_.reserve(items_.size() / 16 + 1);
    tree_.leaves_.reserve(items_.size() / 4 + 1);
    build(std::span(items_), 0);
    std::vector<Triangle> ordered(items_.size());
    tree_.number_of_.resize(items_.size());
    tree_.place_of_.resize(items_.size());
    for (std::uint32_t place = 0; place < items_.size(); ++place) {
      const std::uint32_t n = items_[place].triangle;
      ordered[place] = tree_.triangles_[n];
      tree_.number_of_[place] = n;
      tree_.place_of_[n] = place;
    }
    tree_.triangles_ = std::move(ordered);
  }

 private:
  struct Box {
    std::array<float, 3> lower{HUGE_VALF, HUGE_VALF, HUGE_VALF};
    std::array<float, 3> upper{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

    void add(const Box& other) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower[i] = std::min(lower[i], other.lower[i]);
        upper[i] = std::max(upper[i], other.upper[i]);
      }
    }
    [[nodiscard]] float middle(std::size_t axis) const { return lower[axis] + upper[axis]; }  // twice, about
    [[nodiscard]] float area() const {
      const float x = upper[0] - lower[0];
      const float y = upper[1] - lower[1];
      const float z = upper[2] - lower[2];
      return x * y + y * z + z * x;
    }
  };
  struct Item {
    Box box;
    std::uint32_t triangle;
  };
  using Items = std::span<Item>;

  static constexpr std::size_t bins = 16;
  struct Bin {
    Box box;
    std::size_t count = 0;
  };
  struct Cut {
    std::size_t axis = 0;
    std::size_t bin = 0;
    float cost = HUGE_VALF;
  };

  /// Scaled coordinates are off by 2^-52 of themselves; a step of binary32 is a good deal more.
  static float below(double x) { return std::nextafter(static_cast<float>(x), -HUGE_VALF); }
  static float above(double x) { return std::nextafter(static_cast<float>(x), HUGE_VALF); }

  static Box box_of(Items items) {
    Box box;
    for (const Item& item : items) box.add(item.box);
    return box;
  }

  static std::size_t bin_of(const Item& item, std::size_t axis, float least, float scale) {
    return std::min(bins - 1, static_cast<std::size_t>(std::max(0.0F, (item.box.middle(axis) - least) * scale)));
  }

  /// The cheapest cut between two of the bins of an axis.
  static void improve(Cut& best, const std::array<Bin, bins>& filled, std::size_t axis) {
    std::array<float, bins> above_cost{};
    Bin sum;
    for (std::size_t b = bins - 1; b > 0; --b) {
      sum.box.add(filled[b].box);
      sum.count += filled[b].count;
      above_cost[b] = sum.count > 0 ? sum.box.area() * static_cast<float>(sum.count) : HUGE_VALF;
    }
    sum = {};
    for (std::size_t b = 1; b < bins; ++b) {
      sum.box.add(filled[b - 1].box);
      sum.count += filled[b - 1].count;
      if (sum.count == 0) continue;
      const float cost = sum.box.area() * static_cast<float>(sum.count) + above_cost[b];
      if (cost < best.cost) best = {axis, b, cost};
    }
  }

  /// Where the second part begins; neither is empty.
  static std::size_t split(Items items, bool by_cost) {
    if (!by_cost) return items.size() / 2;
    std::array<float, 3> least{HUGE_VALF, HUGE_VALF, HUGE_VALF};
    std::array<float, 3> greatest{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
    for (const Item& item : items) {
      for (std::size_t i = 0; i < 3; ++i) {
        least[i] = std::min(least[i], item.box.middle(i));
        greatest[i] = std::max(greatest[i], item.box.middle(i));
      }
    }
    Cut best;
    std::array<float, 3> scale{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scale[axis] = static_cast<float>(bins) / (greatest[axis] - least[axis]);
      if (!(greatest[axis] > least[axis]) || !std::isfinite(scale[axis])) continue;
      std::array<Bin, bins> filled;
      for (const Item& item : items) {
        Bin& bin = filled[bin_of(item, axis, least[axis], scale[axis])];
        bin.box.add(item.box);
        ++bin.count;
      }
      improve(best, filled, axis);
    }
    if (best.bin == 0) return items.size() / 2;
    const auto second = std::partition(items.begin(), items.end(), [&](const Item& item) {
      return bin_of(item, best.axis, least[best.axis], scale[best.axis]) < best.bin;
    });
    return static_cast<std::size_t>(second - items.begin());
  }

  /// Up to eight, in the order of the items.
  static std::vector<Items> parts_of(Items items, std::size_t depth) {
    std::vector<Items> parts{items};
    while (parts.size() < width) {
      std::size_t largest = parts.size();
      float area = -1.0F;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].size() <= width) continue;
        const float of_this = box_of(parts[i]).area();
        if (of_this > area) {
          area = of_this;
          largest = i;
        }
      }
      if (largest == parts.size()) break;
      const Items whole = parts[largest];
      const std::size_t second = split(whole, depth < deepest_by_cost);
      parts[largest] = whole.first(second);
      parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(largest) + 1, whole.subspan(second));
    }
    return parts;
  }

  std::uint32_t leaf(Items items) {
    Leaf leaf{};
    leaf.first = static_cast<std::uint32_t>(items.data() - items_.data());
    leaf.count = static_cast<std::uint32_t>(items.size());
    for (std::size_t lane = 0; lane < width; ++lane) {
      const Triangle& triangle = tree_.triangles_[items[std::min(lane, items.size() - 1)].triangle];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto place = tree_.scaled(triangle[k]);
        for (std::size_t i = 0; i < 3; ++i) leaf.corner[k][i][lane] = static_cast<float>(place[i]);
      }
    }
    tree_.leaves_.push_back(leaf);
    return static_cast<std::uint32_t>(tree_.leaves_.size() - 1) | leaf_bit;
  }

  std::uint32_t build(Items items, std::size_t depth) {
    const auto place = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    Node node{};
    for (std::size_t i = 0; i < 3; ++i) {
      node.lower[i].fill(HUGE_VALF);
      node.upper[i].fill(-HUGE_VALF);
    }
    const std::vector<Items> parts = parts_of(items, depth);
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      const Box box = box_of(parts[lane]);
      for (std::size_t i = 0; i < 3; ++i) {
        node.lower[i][lane] = box.lower[i];
        node.upper[i][lane] = box.upper[i];
      }
      node.child[lane] = parts[lane].size() <= width ? leaf(parts[lane]) : build(parts[lane], depth + 1);
    }
    tree_.nodes_[place] = node;
    return place;
  }

  WideTree& tree_;
  std::vector<Item> items_;
};

WideTree::WideTree(std::span<const Triangle> triangles) : triangles_(triangles.begin(), triangles.end()) {
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
  Builder(*this).build();
}

std::array<double, 3> WideTree::scaled(const Point& point) const {
  return {(point[0] - centre_[0]) * scale_, (point[1] - centre_[1]) * scale_, (point[2] - centre_[2]) * scale_};
}

// The nearest triangle.

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
    if (hint) look_at(tree_.place_of_[*hint]);
    hinted_ = hint ? tree_.place_of_[*hint] : no_place;
    size_ = 0;
    open_[size_++] = {Number(0), 0};
    while (size_ > 0) {
      const Open next = open_[--size_];
      if (next.square > limit_) continue;
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

  static constexpr std::uint32_t no_place = ~0U;
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
    const std::size_t base = size_;
    for (unsigned near = bits_of(square <= limit_lanes()); near != 0; near &= near - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(near));
      std::size_t place = size_++;
      for (; place > base && open_[place - 1].square < squares[lane]; --place) open_[place] = open_[place - 1];
      open_[place] = {squares[lane], node.child[lane]};
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
    if (place == hinted_) return;
    const Bounds bounds = bounds_of(point_, tree_.triangles_[place]);
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
  std::uint32_t hinted_ = no_place;
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
WideTree::Nearest WideTree::nearest_from_afar(const Point& point) const {
  const Point way{lower_[0] - point[0], lower_[1] - point[1], lower_[2] - point[2]};
  const double about = length(way[0], way[1], way[2]);
  const double margin = about * 0x1p-43;
  Nearest found;
  found.distance = {std::isfinite(about) ? subtract(about, margin, Direction::down) : largest_coordinate(way) / 2,
                    add(about, margin, Direction::up)};
  found.triangle = number_of_.front();
  const Point& corner = triangles_.front()[0];
  found.way = {corner[0] - point[0], corner[1] - point[1], corner[2] - point[2]};
  found.count = 0;
  found.complete = false;
  return found;
}

WideTree::Nearest WideTree::nearest(const Point& point, std::optional<std::uint32_t> hint) const {
  constexpr double near = 16.0;  // sizes: so far binary32 tells triangles apart
  const double place = largest_coordinate(scaled(point));
  if (!(place <= farthest)) return nearest_from_afar(point);
  Nearest found;
  if (place <= near) {
    search_near(point, hint, found);
  } else {
    search_far(point, hint, found);
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

/// Of corners rounded to binary32 and of points of at most 2 in scaled coordinates.
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
