/// This file implements multipliers.hpp.
#include "verify/proposals/multipliers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Vector = std::array<double, 3>;

/// Rows of A x = b, each ending with its number of b: of three cuts and two edges at most.
struct LinearSystem {
  std::array<std::array<double, 6>, 5> rows{};
  std::size_t size;

  /// The solution by Gauss's method, in plain floating point. It is not finite if there is none.
  [[nodiscard]] std::array<double, 5> solution() {
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = i + 1; j < size; ++j) {
        if (std::fabs(rows[j][i]) > std::fabs(rows[i][i])) std::swap(rows[i], rows[j]);
      }
      for (std::size_t j = 0; j < size; ++j) {
        const double factor = j == i ? 0.0 : rows[j][i] / rows[i][i];
        for (std::size_t k = i; k <= size; ++k) rows[j][k] -= factor * rows[i][k];
      }
    }
    std::array<double, 5> x{};
    for (std::size_t i = 0; i < size; ++i) x[i] = rows[i][size] / rows[i][i];
    return x;
  }
};

/// Pairs of a point of the half-spaces and a point of the hull that are nearest to each other. Only pairs are tried
/// that at most three half-spaces and one of the hull's corners, its edges or its face determine. A quadratic program
/// this small is solved by trying all of them; ascent in one multiplier at a time hardly moves between nearly parallel
/// planes.
class MultipliersOfCorners {
 public:
  MultipliersOfCorners(std::span<const Vector> corners, std::span<const proposed::HalfSpace> half_spaces)
      : corners_(corners), half_spaces_(half_spaces) {}

  /// The best, if `value` is exceeded, where one corner is all there is.
  [[nodiscard]] std::optional<std::vector<double>> best(double value) const {
    std::optional<std::vector<double>> result;
    while (auto better = (*this)(value)) {
      value = dual(*better);
      result = std::move(better);
    }
    return result;
  }

  /// The least of 2 N·c - |N|² - 2 Σ m offset over the corners c.
  [[nodiscard]] double dual(const std::vector<double>& m) const { return least_over_corners(normal_of(m)); }

  struct Normal {
    Vector sum;   ///< N
    double rest;  ///< |N|² + 2 Σ m offset
  };

  [[nodiscard]] Normal normal_of(const std::vector<double>& m) const {
    Normal result{{}, 0.0};
    for (std::size_t r = 0; r < m.size(); ++r) {
      result.sum = along(result.sum, half_spaces_[r].normal, m[r]);
      result.rest += 2 * m[r] * half_spaces_[r].offset;
    }
    result.rest += dot(result.sum, result.sum);
    return result;
  }

  /// Nothing if no multipliers are found.
  [[nodiscard]] std::optional<std::vector<double>> operator()(double value) const {
    for (unsigned corners = 1; corners < 1U << corners_.size(); ++corners) {
      for (std::size_t i = 0; i < half_spaces_.size(); ++i) {
        if (auto found = from(i, corners, value)) return found;
      }
    }
    return std::nullopt;
  }

 private:
  using Indices = std::span<const std::size_t>;

  /// Multipliers of half-space i and at most two later ones.
  [[nodiscard]] std::optional<std::vector<double>> from(std::size_t i, unsigned corners, double value) const {
    for (std::size_t j = i; j < half_spaces_.size(); ++j) {
      for (std::size_t k = j == i ? i : j + 1; k < half_spaces_.size(); ++k) {
        const std::array<std::size_t, 3> three{i, j, k};
        const auto cuts = std::span(three).last(k == i ? 1 : j == i ? 2 : 3);
        const std::array<double, 5> m = of(corners, cuts);
        if (dual(cuts, m) > value) return all(cuts, m);
      }
    }
    return std::nullopt;
  }

  /// The solution for the pair of e in all these cuts and t in the hull of these corners; N = t - e is normal to both.
  [[nodiscard]] std::array<double, 5> of(unsigned corners, Indices cuts) const {
    const auto first = static_cast<std::size_t>(std::countr_zero(corners));
    LinearSystem system{{}, cuts.size()};
    for (std::size_t i = first + 1; i < corners_.size(); ++i) {
      if ((corners >> i & 1U) == 0) continue;
      const Vector edge = difference(corners_[i], corners_[first]);
      for (std::size_t r = 0; r < cuts.size(); ++r) {
        system.rows[system.size][r] = dot(half_spaces_[cuts[r]].normal, edge);
        system.rows[r][system.size] = -system.rows[system.size][r];
      }
      ++system.size;
    }
    for (std::size_t r = 0; r < cuts.size(); ++r) {
      const Vector& n = half_spaces_[cuts[r]].normal;
      for (std::size_t c = 0; c < cuts.size(); ++c) system.rows[r][c] = dot(n, half_spaces_[cuts[c]].normal);
      system.rows[r][system.size] = dot(n, corners_[first]) - half_spaces_[cuts[r]].offset;
    }
    return system.solution();
  }

  /// Minus infinity for an unusable proposal.
  [[nodiscard]] double dual(Indices cuts, const std::array<double, 5>& m) const {
    Vector sum{};
    double rest = 0.0;
    for (std::size_t r = 0; r < cuts.size(); ++r) {
      if (!(m[r] >= 0.0) || !std::isfinite(m[r])) return -infinity;
      sum = along(sum, half_spaces_[cuts[r]].normal, m[r]);
      rest += 2 * m[r] * half_spaces_[cuts[r]].offset;
    }
    return least_over_corners({sum, rest + dot(sum, sum)});
  }

  [[nodiscard]] double least_over_corners(const Normal& n) const {
    double least = infinity;
    for (const Vector& corner : corners_) least = std::min(least, 2 * dot(n.sum, corner) - n.rest);
    return least;
  }

  [[nodiscard]] std::vector<double> all(Indices cuts, const std::array<double, 5>& m) const {
    std::vector<double> result(half_spaces_.size(), 0.0);
    for (std::size_t r = 0; r < cuts.size(); ++r) result[cuts[r]] = m[r];
    return result;
  }

  std::span<const Vector> corners_;
  std::span<const proposed::HalfSpace> half_spaces_;
};

}  // namespace

std::optional<std::vector<double>> proposed::multipliers(std::span<const Vector> corners,
                                                         std::span<const HalfSpace> half_spaces, double value) {
  return MultipliersOfCorners(corners, half_spaces)(value);
}

// Gilbert's algorithm: p is a point of the body, N leads from the nearest point of the half-spaces to p. If the body
// reaches farther against N, p moves there as long as it comes nearer.
std::optional<std::vector<double>> proposed::multipliers(const FarthestPoint& body, const Vector& inside,
                                                         std::span<const HalfSpace> half_spaces, double value) {
  constexpr int most_steps = 256;  // flat bodies take hundreds, others a few
  Vector p = inside;
  for (int step = 0; step < most_steps; ++step) {
    const MultipliersOfCorners of_p(std::span(&p, 1), half_spaces);
    auto m = of_p.best(value);
    if (!m) return std::nullopt;  // p itself is nearer
    const auto [n, rest] = of_p.normal_of(*m);
    const Vector q = body({-n[0], -n[1], -n[2]});
    if (2 * dot(n, q) - rest > value) return m;
    const Vector way = difference(q, p);
    const double share = -dot(n, way) / dot(way, way);
    if (!(share > 0.0)) return std::nullopt;
    p = along(p, way, std::min(1.0, share));
  }
  return std::nullopt;
}

namespace {

using Vector = Coordinates<double>;

double largest_difference(const Vector& a, const Vector& b) {
  return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

InnerWalk first_walk(const Boundary<double>& boundary, bool is_tapered, const Vector& q) {
  InnerWalk shortest{{}, infinity};
  const auto consider = [&](const Vector& direction) {
    const double length = boundary.exit(q, direction);
    if (length < shortest.length) shortest = {direction, length};
  };
  consider({1.0, 0.0, 0.0});
  consider({0.0, 1.0, 0.0});
  consider({0.0, 0.0, 1.0});
  if (is_tapered) consider({0.0, 0.0, -1.0});
  if (boundary.gauge(q) > 0.0) consider(boundary.normal(q));
  return shortest;
}

}  // namespace

// A plane through x with normal n(x) supports the solid. So the walk from q along n(x) ends no later than at that
// plane, which is no farther from q than x.
InnerWalk shortest_walk(const Boundary<double>& boundary, bool is_tapered, const Vector& q,
                        const InnerWalkLimits& limits) {
  InnerWalk walk = first_walk(boundary, is_tapered, q);
  for (int i = 0; i < limits.most_walks; ++i) {
    const Vector normal = boundary.normal(along(q, walk.direction, walk.length));
    const double change = largest_difference(normal, walk.direction);
    const double length = boundary.exit(q, normal);
    if (!(length <= walk.length)) break;
    walk = {normal, length};
    if (change < limits.steady_direction) break;
  }
  return walk;
}

}  // namespace verisq::verify

namespace verisq::verify::proposed {

long double exit(const Superquadric& solid, const Proposal& q, const Proposal& w, long double level) {
  return Boundary<long double>(solid).exit(q, w, level);
}

Proposal gradient(const Superquadric& solid, const Proposal& x) {
  using Vector = std::array<double, 3>;
  const Boundary<double> boundary(solid);
  Vector folded{static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
  for (std::size_t i = 0; i < (is_tapered(solid) ? 2 : 3); ++i) folded[i] = std::fabs(folded[i]);
  const Vector w = boundary.normal(folded);
  const double scale = boundary.gauge(folded) / dot(w, folded);  // Euler: g is homogeneous
  Proposal result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = std::copysign(scale * w[i], x[i]);
  if (is_tapered(solid)) result[2] = scale * w[2];
  return result;
}

Proposal closest_to_origin(const std::array<Proposal, 3>& corners) {
  return verify::closest_to_origin(corners[0], corners[1], corners[2]);
}

long double support_root(long double section, long double height, long double k, long double q) {
  return near_root_of_support(section, height, k, q);
}

}  // namespace verisq::verify::proposed

namespace verisq::verify {

namespace {

constexpr std::size_t kRows = 6;
constexpr int kMostPivots = 64;
/// Reduced costs and pivots that are smaller, in parts of the box, count as 0.
constexpr double kNegligible = 1e-11;

/// min Σ λ c + Σ half (u + v) where u - v - Σ λ a = objective, all >= 0, directions scaled so that half is 1. A slack
/// of each row forms the first basis.
class Tableau {
 public:
  Tableau(const PoseParameters& objective, const PoseParameters& half, std::span<const LinearConstraint> constraints)
      : count_(constraints.size()), columns_(2 * kRows + count_), cells_((kRows + 1) * columns_) {
    for (std::size_t k = 0; k < kRows; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double scaled = objective[row] * half[row];
      const double sign = scaled < 0.0 ? -1.0 : 1.0;
      right_[k] = sign * scaled;
      at(k, 2 * k) = sign;
      at(k, 2 * k + 1) = -sign;
      basis_[k] = 2 * k + (sign < 0.0 ? 1 : 0);
      for (std::size_t j = 0; j < count_; ++j) at(k, 2 * kRows + j) = -sign * constraints[j].slope[row] * half[row];
    }
    for (std::size_t column = 0; column < columns_; ++column) {
      double cost = column < 2 * kRows ? 1.0 : constraints[column - 2 * kRows].constant;
      for (std::size_t k = 0; k < kRows; ++k) cost -= at(k, column);  // every basic slack costs 1
      at(kRows, column) = cost;
    }
  }

  Multipliers solved() {
    for (int pivot = 0; pivot < kMostPivots; ++pivot) {
      std::size_t entering = 0;
      for (std::size_t column = 1; column < columns_; ++column)
        if (at(kRows, column) < at(kRows, entering)) entering = column;
      if (at(kRows, entering) > -kNegligible) break;
      std::size_t leaving = kRows;
      for (std::size_t k = 0; k < kRows; ++k) {
        if (at(k, entering) <= kNegligible) continue;
        if (leaving == kRows || right_[k] * at(leaving, entering) < right_[leaving] * at(k, entering)) leaving = k;
      }
      if (leaving == kRows) return ray(entering);
      exchange(leaving, entering);
    }
    Multipliers result{std::vector<double>(count_, 0.0)};
    for (std::size_t k = 0; k < kRows; ++k)
      if (basis_[k] >= 2 * kRows) result.values[basis_[k] - 2 * kRows] = std::fmax(right_[k], 0.0);
    return result;
  }

 private:
  [[nodiscard]] double& at(std::size_t row, std::size_t column) { return cells_[row * columns_ + column]; }

  /// Along it the cost falls without end.
  Multipliers ray(std::size_t entering) {
    Multipliers result{std::vector<double>(count_, 0.0), true};
    if (entering >= 2 * kRows) result.values[entering - 2 * kRows] = 1.0;
    for (std::size_t k = 0; k < kRows; ++k)
      if (basis_[k] >= 2 * kRows) result.values[basis_[k] - 2 * kRows] = std::fmax(-at(k, entering), 0.0);
    return result;
  }

  void exchange(std::size_t leaving, std::size_t entering) {
    const double pivot = at(leaving, entering);
    for (std::size_t column = 0; column < columns_; ++column) at(leaving, column) /= pivot;
    right_[leaving] /= pivot;
    for (std::size_t k = 0; k <= kRows; ++k) {
      const double factor = at(k, entering);
      if (k == leaving || factor == 0.0) continue;
      for (std::size_t column = 0; column < columns_; ++column) at(k, column) -= factor * at(leaving, column);
      if (k < kRows) right_[k] -= factor * right_[leaving];
    }
    basis_[leaving] = entering;
  }

  std::size_t count_;
  std::size_t columns_;
  std::vector<double> cells_;  ///< the rows, then the reduced costs
  std::array<double, kRows> right_{};
  std::array<std::size_t, kRows> basis_{};
};

}  // namespace

Multipliers multipliers(const PoseParameters& objective, const PoseParameters& half,
                        std::span<const LinearConstraint> constraints) {
  return Tableau(objective, half, constraints).solved();
}

}  // namespace verisq::verify
