/// A tree of triangles, eight boxes a node and eight triangles a leaf in binary32, and the searches through it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Triangles are named by their places in the list that the tree was made of. Immutable: safe to ask from many threads.
class WideTree {
 public:
  /// Preconditions: at least one triangle, at most 2^31; every coordinate is 0 or finite; the largest lies in
  /// [least_size, largest_size].
  explicit WideTree(std::vector<Triangle> triangles);

  /// Range of the largest coordinate: within it no square of a difference that matters overflows or underflows.
  static constexpr double least_size = 0x1p-200;
  static constexpr double largest_size = 0x1p200;

  struct Near {
    double lower;  ///< no point of the triangle is nearer
    std::uint32_t triangle;
    std::int8_t side;  ///< of its plane on which the point is proven to lie: as near_orientation, or 0
  };

  struct Nearest {
    Enclosure distance;      ///< to the nearest of all triangles
    std::uint32_t triangle;  ///< one that is no farther than distance.hi
    Point way;               ///< from the query to the point that is proposed as the closest, which lies in `triangle`
    std::size_t count;       ///< of those in `near`
    bool complete;  ///< `near` holds every triangle of which it is not proven that it is farther than distance.hi
    std::array<Near, 32> near;
  };

  /// `hint`: a triangle to begin with, as that of a neighbour; it changes nothing but the order of `near`.
  /// Precondition: finite. Points farther away than `farthest` sizes of the mesh get bounds as wide as its size.
  [[nodiscard]] Nearest nearest(const Point& point, std::optional<std::uint32_t> hint = {}) const;

  static constexpr double farthest = 0x1p46;

  /// Appends all triangles that may be no farther than `reach`, and some more.
  void within(const Point& point, double reach, std::vector<std::uint32_t>& found) const;

  /// Appends all triangles whose boxes may meet that of this one, and some more; of each two only the later one in the
  /// tree's own order, never the triangle itself.
  void overlapping(std::uint32_t triangle, std::vector<std::uint32_t>& found) const;

  /// Appends all triangles that the ray from the point along the axis may meet, upward or downward, and some more.
  void along_ray(const Point& point, std::size_t axis, bool upward, std::vector<std::uint32_t>& found) const;

  [[nodiscard]] const Triangle& triangle(std::uint32_t n) const { return triangles_[place_of_[n]]; }
  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  /// Triangles in the order of the tree, in which near ones are near.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return number_of_; }
  [[nodiscard]] const Point& lower() const { return lower_; }
  [[nodiscard]] const Point& upper() const { return upper_; }

 private:
  static constexpr std::size_t width = 8;
  using Row = std::array<float, width>;

  struct alignas(64) Node {
    std::array<Row, 3> lower;  ///< of boxes, rounded outward; an empty place has an infinite one, turned inside out
    std::array<Row, 3> upper;
    std::array<std::uint32_t, width> child;  ///< a leaf has `leaf_bit`
  };
  struct alignas(64) Leaf {
    std::array<std::array<Row, 3>, 3> corner;  ///< by corner and axis, rounded to nearest; the last one is repeated
    std::uint32_t first;                       ///< place of its first triangle
    std::uint32_t count;
  };
  static constexpr std::uint32_t leaf_bit = 1U << 31U;

  /// So many sizes of the mesh away binary32 tells triangles apart.
  static constexpr double near_in_sizes = 16.0;

  /// Beyond it triangles are halved as they come: 31 times at most.
  static constexpr std::size_t deepest_by_cost = 24;
  /// Each level leaves seven of its children behind, at most.
  static constexpr std::size_t most_open = (width - 1) * (deepest_by_cost + 32) + 1;

  class Builder;
  void build();
  struct Candidates;
  struct Measured;
  template <class Number>
  class Search;
  static double slack(const std::array<double, 3>& place);
  static double limit_of(double reach, double slack);
  void search_near(const Point& point, std::optional<std::uint32_t> hint, Candidates& found) const;
  void search_far(const Point& point, std::optional<std::uint32_t> hint, Candidates& found) const;
  void bound_near(const Point& point, const Leaf& leaf, std::array<double, width>& lowers) const;
  void bound_far(const Point& point, const Leaf& leaf, std::array<double, width>& lowers) const;
  void measure(const Point& point, std::span<const std::uint32_t> places, std::span<Measured> found) const;
  static double least_upper(std::span<const Measured> measured, std::size_t count);
  void find(const Point& point, std::optional<std::uint32_t> hint, Nearest& found) const;
  void find_in_crowd(const Point& point, double reach, Nearest& found) const;
  void choose(const Point& point, std::span<const std::uint32_t> places, std::span<const Measured> measured,
              double upper, Nearest& found) const;
  [[nodiscard]] bool is_proven_farther(const Point& point, double reach, double upper, std::uint32_t place) const;
  /// Calls leaf(leaf) for those whose boxes meet this one, about the centre and scaled.
  template <class Visit>
  void visit(const std::array<float, 3>& lower, const std::array<float, 3>& upper, const Visit& leaf) const;
  [[nodiscard]] std::array<double, 3> scaled(const Point& point) const;
  void see_from_afar(const Point& point, Nearest& found) const;

  Point lower_{};
  Point upper_{};
  Point centre_{};
  double scale_ = 1.0;                    ///< a power of two: coordinates about the centre, scaled, lie in [-1, 1]
  std::vector<Triangle> triangles_;       ///< in the order of the tree
  std::vector<std::uint32_t> number_of_;  ///< by place
  std::vector<std::uint32_t> place_of_;   ///< by number
  std::vector<std::uint32_t> leaf_of_;    ///< by place
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
};

}  // namespace verisq::verify
