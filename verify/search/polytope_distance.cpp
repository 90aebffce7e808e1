/// This file implements polytope_distance.hpp.
#include "verify/search/polytope_distance.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Vector = Eigen::Vector3d;

/// The problem about the cube's centre, scaled by powers of two so that lengths and normals are about 1 and their
/// squares neither overflow nor vanish.
struct Scaled {
  Vector query;
  double half_width;
  std::vector<Vector> normals;
  std::vector<double> offsets;
};

using Multipliers = std::vector<double>;

double power_of_two_about(double size) {
  if (!(size > 0.0) || !std::isfinite(size)) return 1.0;
  int exponent = 0;
  std::frexp(size, &exponent);
  return std::ldexp(1.0, std::clamp(exponent, -1000, 1000));
}

double largest_magnitude(const Point& v) {
  return std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
}

/// The unit of length.
double unit_of(const Point& x, const Cube& cube) {
  const Point& c = cube.centre;
  return power_of_two_about(std::max(largest_magnitude({x[0] - c[0], x[1] - c[1], x[2] - c[2]}), cube.half_width));
}

Scaled scaled(const Point& x, const Cube& cube, std::span<const HalfSpace> half_spaces, double unit) {
  Scaled result{{}, cube.half_width / unit, {}, {}};
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    result.query[i] = (x[k] - cube.centre[k]) / unit;
  }
  for (const auto& [normal, offset] : half_spaces) {
    const double size = power_of_two_about(largest_magnitude(normal));
    result.normals.emplace_back(normal[0] / size, normal[1] / size, normal[2] / size);
    result.offsets.push_back(offset / size / unit);
  }
  return result;
}

/// The result of the search.
struct Solution {
  Vector nearest;
  Multipliers multipliers;
  std::optional<Multipliers> empty;  ///< multipliers of a combination of half-spaces that misses the cube
};

/// The dual active-set method of Goldfarb and Idnani (Mathematical Programming 27, 1983) for a Hessian of 1. It starts
/// at the query and moves onto one violated plane after the other, so that the multipliers stay nonnegative.
class ActiveSet {
 public:
  explicit ActiveSet(const Scaled& problem) : normals_(problem.normals), offsets_(problem.offsets) {
    for (std::size_t j = 0; j < normals_.size(); ++j) {
      const double length = normals_[j].norm();
      lengths_.push_back(length);
      normals_[j] /= length;
      offsets_[j] /= length;
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        normals_.emplace_back(sign * Vector::Unit(i));
        offsets_.push_back(problem.half_width);
      }
    }
    multipliers_.assign(normals_.size(), 0.0);
    nearest_ = problem.query;
  }

  [[nodiscard]] Solution solve() {
    constexpr int most_planes = 30;  // ends what rounding makes endless
    for (int n = 0; n < most_planes; ++n) {
      const std::size_t worst = most_violated();
      if (worst == normals_.size()) break;
      if (const auto impossible = move_onto(worst)) return {nearest_, of_half_spaces(multipliers_), impossible};
    }
    return {nearest_, of_half_spaces(multipliers_), std::nullopt};
  }

 private:
  using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
  using Rates = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;

  /// The multipliers for normals of the original lengths.
  [[nodiscard]] Multipliers of_half_spaces(const Multipliers& of_planes) const {
    Multipliers result;
    for (std::size_t j = 0; j < lengths_.size(); ++j) result.push_back(std::max(0.0, of_planes[j]) / lengths_[j]);
    return result;
  }

  [[nodiscard]] double violation(std::size_t j) const { return normals_[j].dot(nearest_) - offsets_[j]; }

  [[nodiscard]] std::size_t most_violated() const {
    double most = 1e-15;  // the rounding error of lengths about 1
    std::size_t found = normals_.size();
    for (std::size_t j = 0; j < normals_.size(); ++j) {
      const double excess = violation(j);
      if (!(excess > most) || std::ranges::find(active_, j) != active_.end()) continue;
      most = excess;
      found = j;
    }
    return found;
  }

  /// The rates at which the active multipliers fall as that of `normal` grows, so that all active planes are kept.
  [[nodiscard]] Rates rates(const Vector& normal, Vector& across) const {
    across = normal;
    if (active_.empty()) return {};
    Columns columns(3, static_cast<Eigen::Index>(active_.size()));
    for (std::size_t a = 0; a < active_.size(); ++a) columns.col(static_cast<Eigen::Index>(a)) = normals_[active_[a]];
    const Rates fall = columns.householderQr().solve(normal);
    across -= columns * fall;
    return fall;
  }

  /// If the planes leave no point, returns the multipliers of a combination that proves it.
  std::optional<Multipliers> move_onto(std::size_t plane) {
    constexpr double dependent = 1e-12;
    while (true) {
      Vector across;
      const Rates fall = rates(normals_[plane], across);
      const double squared = across.squaredNorm();
      const bool blocked = active_.size() == 3 || squared < dependent * dependent;
      const double full = blocked ? infinity : violation(plane) / squared;
      double step = full;
      std::size_t leaves = active_.size();
      for (std::size_t a = 0; a < active_.size(); ++a) {
        const double rate = fall[static_cast<Eigen::Index>(a)];
        if (!(rate > 0.0) || !(multipliers_[active_[a]] / rate < step)) continue;
        step = multipliers_[active_[a]] / rate;
        leaves = a;
      }
      if (step == infinity) {
        Multipliers impossible(multipliers_.size(), 0.0);
        impossible[plane] = 1.0;
        for (std::size_t a = 0; a < active_.size(); ++a) impossible[active_[a]] = -fall[static_cast<Eigen::Index>(a)];
        return of_half_spaces(impossible);
      }
      if (!blocked) nearest_ -= step * across;
      for (std::size_t a = 0; a < active_.size(); ++a) {
        multipliers_[active_[a]] -= step * fall[static_cast<Eigen::Index>(a)];
      }
      multipliers_[plane] += step;
      if (leaves == active_.size()) {
        active_.push_back(plane);
        return std::nullopt;
      }
      multipliers_[active_[leaves]] = 0.0;
      active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(leaves));
    }
  }

  std::vector<Vector> normals_;  ///< of length 1; the last six are the normals of the cube's faces
  std::vector<double> offsets_;
  std::vector<double> lengths_;  ///< lengths of the half-spaces' normals
  std::vector<double> multipliers_;
  std::vector<std::size_t> active_;
  Vector nearest_;
};

/// The same problem, enclosed.
struct Proof {
  Proof(const Point& x, const Cube& cube, double unit_length) : unit(Interval(1) / Interval(unit_length)) {
    for (std::size_t i = 0; i < 3; ++i) query[i] = (Interval(x[i]) - Interval(cube.centre[i])) * unit;
    half_width = Interval(cube.half_width) * unit;
  }

  /// min over |e| <= h of (e - d)^2 + 2 s e = dist(d - s, [-h, h])^2 + s (2 d - s), for each coordinate.
  [[nodiscard]] double squared_distance(const std::array<Interval, 3>& s, const Interval& offset) const {
    Interval sum = -(Interval(2) * offset);
    for (std::size_t i = 0; i < 3; ++i) {
      const Interval outside = abs(query[i] - s[i]) - half_width;
      sum += square(Interval(std::max(0.0, outside.lower()))) + s[i] * (Interval(2) * query[i] - s[i]);
    }
    return sum.lower();
  }

  /// Returns whether s.e > offset all over the cube.
  [[nodiscard]] bool empty(const std::array<Interval, 3>& s, const Interval& offset) const {
    Interval reach(0);
    for (std::size_t i = 0; i < 3; ++i) reach += abs(s[i]) * half_width;
    return (-reach - offset).lower() > 0.0;
  }

  Interval unit;
  std::array<Interval, 3> query;
  Interval half_width;
};

/// A combination of half-spaces, which contains their intersection: sum of m_j n_j.e <= sum of m_j b_j.
struct Combination {
  std::array<Interval, 3> normal{Interval(0), Interval(0), Interval(0)};
  Interval offset{0};
};

Combination combination(std::span<const HalfSpace> half_spaces, const Multipliers& multipliers, const Interval& unit) {
  Combination result;
  for (std::size_t j = 0; j < half_spaces.size(); ++j) {
    if (!(multipliers[j] > 0.0) || !std::isfinite(multipliers[j])) continue;
    const auto& [normal, offset] = half_spaces[j];
    const Interval weight = Interval(multipliers[j]) / Interval(power_of_two_about(largest_magnitude(normal)));
    for (std::size_t i = 0; i < 3; ++i) result.normal[i] += weight * Interval(normal[i]);
    result.offset += weight * Interval(offset) * unit;
  }
  return result;
}

}  // namespace

PolytopeDistance polytope_distance(const Point& x, const Cube& cube, std::span<const HalfSpace> half_spaces) {
  std::vector<HalfSpace> usable;
  for (const HalfSpace& half_space : half_spaces) {
    const double size = largest_magnitude(half_space.normal);
    if (size > 0.0 && std::isfinite(size) && std::isfinite(half_space.offset)) usable.push_back(half_space);
  }
  const double unit = unit_of(x, cube);
  const Scaled problem = scaled(x, cube, usable, unit);
  const Solution solution = ActiveSet(problem).solve();
  const Vector e = solution.nearest.cwiseMax(-problem.half_width).cwiseMin(problem.half_width) * unit;
  PolytopeDistance result{0.0, cube.centre};
  if (e.allFinite()) result.nearest = {cube.centre[0] + e[0], cube.centre[1] + e[1], cube.centre[2] + e[2]};

  const Proof proof(x, cube, unit);
  if (solution.empty) {
    const Combination impossible = combination(usable, *solution.empty, proof.unit);
    if (proof.empty(impossible.normal, impossible.offset)) {
      result.lower = infinity;
      return result;
    }
  }
  const Combination combined = combination(usable, solution.multipliers, proof.unit);
  const double squared = proof.squared_distance(combined.normal, combined.offset);
  if (squared > 0.0) result.lower = multiply(square_root(squared, Direction::down), unit, Direction::down);
  return result;
}

namespace {

/// The largest number of cuts that operands inherit. Three planes form a corner; a few more let them change within the
/// cube.
constexpr std::size_t kMostInheritedCuts = 16;

}  // namespace

HalfSpace SetRelaxation::half_space(const SetNode& leaf) const {
  HalfSpace result = primitives_[leaf.primitive].half_space(cube_, leaf.side);
  const Point& n = result.normal;
  if (margin_ != 0.0) result.offset -= margin_ * std::hypot(n[0], n[1], n[2]);
  return result;
}

PolytopeDistance SetRelaxation::distance(const SetNode& node, std::vector<HalfSpace> cuts) const {
  if (node.kind == SetNode::Kind::union_of) return union_distance(node, cuts);
  if (node.kind == SetNode::Kind::intersection_of) return intersection_distance(node, std::move(cuts));
  cuts.push_back(half_space(node));
  PolytopeDistance result = polytope_distance(x_, cube_, cuts);
  result.lower = std::max(result.lower, leaf_bound_(node));
  return result;
}

PolytopeDistance SetRelaxation::union_distance(const SetNode& node, const std::vector<HalfSpace>& cuts) const {
  PolytopeDistance nearest = distance(node.operands.front(), cuts);
  for (const SetNode& operand : std::span(node.operands).subspan(1)) {
    const PolytopeDistance other = distance(operand, cuts);
    if (other.lower < nearest.lower) nearest = other;
  }
  return nearest;
}

void SetRelaxation::keep_farthest(std::vector<HalfSpace>& cuts) const {
  if (cuts.size() <= kMostInheritedCuts) return;
  const auto excess = [&](const HalfSpace& cut) {
    const Point& n = cut.normal;
    double along = 0.0;
    for (std::size_t i = 0; i < 3; ++i) along += n[i] * (x_[i] - cube_.centre[i]);
    const double far = (along - cut.offset) / std::hypot(n[0], n[1], n[2]);
    return std::isnan(far) ? -infinity : far;
  };
  std::ranges::nth_element(cuts, cuts.begin() + kMostInheritedCuts, std::ranges::greater{}, excess);
  cuts.resize(kMostInheritedCuts);
}

PolytopeDistance SetRelaxation::intersection_distance(const SetNode& node, std::vector<HalfSpace> cuts) const {
  double proven = 0.0;
  bool leaves_only = true;
  for (const SetNode& operand : node.operands) {
    if (operand.kind == SetNode::Kind::leaf) {
      cuts.push_back(half_space(operand));
      proven = std::max(proven, leaf_bound_(operand));
    } else {
      leaves_only = false;
    }
  }
  PolytopeDistance farthest{0.0, cube_.centre};
  if (leaves_only) farthest = polytope_distance(x_, cube_, cuts);
  if (!leaves_only) keep_farthest(cuts);
  for (const SetNode& operand : node.operands) {
    if (operand.kind == SetNode::Kind::leaf) continue;
    const PolytopeDistance other = distance(operand, cuts);
    if (other.lower >= farthest.lower) farthest = other;
  }
  farthest.lower = std::max(farthest.lower, proven);
  return farthest;
}

namespace {

using CutMultipliers = std::array<double, 3>;

bool says_something(const HalfSpace& half_space) {
  return std::isfinite(half_space.offset) &&
         std::ranges::all_of(half_space.normal, [](double c) { return std::isfinite(c); });
}

/// h |direction - sum m_j n_j|_1 + sum m_j b_j, rounded up; infinity for multipliers that are no numbers of at least 0.
double dual_bound(double half_width, std::span<const HalfSpace> half_spaces, const Point& direction,
                  const CutMultipliers& multipliers) {
  // Fewer than 16 roundings lie between an input and the result. So the error is below 32 u times the sum of the
  // absolute terms; `terms` has a relative error that the same factor covers. Underflow costs less than 2^-1070 each
  // time, times the half-width at most.
  double bound = 0.0;
  double terms = 0.0;
  for (std::size_t j = 0; j < half_spaces.size(); ++j) {
    if (!(multipliers[j] >= 0.0)) return infinity;
    bound += multipliers[j] * half_spaces[j].offset;
    terms += multipliers[j] * std::fabs(half_spaces[j].offset);
  }
  double rest = 0.0;
  double rest_terms = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    double component = direction[i];
    rest_terms += std::fabs(component);
    for (std::size_t j = 0; j < half_spaces.size(); ++j) {
      const double product = multipliers[j] * half_spaces[j].normal[i];
      component -= product;
      rest_terms += std::fabs(product);
    }
    rest += std::fabs(component);
  }
  const double result =
      bound + half_width * rest + 0x1p-47 * (terms + half_width * rest_terms) + 0x1p-1000 * (1.0 + half_width);
  return std::isnan(result) ? infinity : result;
}

/// n·clamp(target - m n) - b, where the clamp is to the cube: in m it falls, and is piecewise linear.
double excess(const HalfSpace& half_space, const Point& target, double half_width, double m) {
  const Point& n = half_space.normal;
  double sum = -half_space.offset;
  for (std::size_t i = 0; i < 3; ++i) sum += n[i] * std::clamp(target[i] - m * n[i], -half_width, half_width);
  return sum;
}

/// The root of `excess` if it begins above 0, else 0: the multiplier of the target's projection. For a half-space that
/// misses the cube, a multiplier that leads to the nearest corner.
double projection_multiplier(const HalfSpace& half_space, const Point& target, double half_width) {
  double m = 0.0;
  double before = excess(half_space, target, half_width, m);
  if (!(before > 0.0)) return 0.0;
  std::array<double, 6> kinks{};
  for (std::size_t i = 0; i < 3; ++i) {
    kinks[2 * i] = (target[i] - half_width) / half_space.normal[i];
    kinks[2 * i + 1] = (target[i] + half_width) / half_space.normal[i];
  }
  std::ranges::replace_if(
      kinks, [](double kink) { return !(kink > 0.0); }, infinity);
  std::ranges::sort(kinks);
  for (const double kink : kinks) {
    if (!std::isfinite(kink)) break;
    const double after = excess(half_space, target, half_width, kink);
    if (after <= 0.0) return m + (kink - m) * (before / (before - after));
    m = kink;
    before = after;
  }
  return m;
}

}  // namespace

CutCube::CutCube(const Cube& cube, std::span<const HalfSpace> half_spaces) : cube_(cube) {
  for (const HalfSpace& half_space : half_spaces) {
    if (count_ < half_spaces_.size() && says_something(half_space)) half_spaces_[count_++] = half_space;
  }
}

double CutCube::support(const Point& direction) const {
  const std::span<const HalfSpace> cuts = half_spaces();
  double least = infinity;
  const auto try_multipliers = [&](const CutMultipliers& multipliers) {
    least = std::min(least, dual_bound(cube_.half_width, cuts, direction, multipliers));
  };
  // The bound is convex and piecewise linear in the multipliers. Its least is at a corner: there as many of the
  // direction's components (or multipliers) vanish as there are multipliers.
  try_multipliers({});
  for (std::size_t j = 0; j < cuts.size(); ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      CutMultipliers single{};
      single[j] = direction[i] / cuts[j].normal[i];
      if (single[j] > 0.0) try_multipliers(single);
    }
    for (std::size_t k = j + 1; k < cuts.size(); ++k) {
      const Point& p = cuts[j].normal;
      const Point& q = cuts[k].normal;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t l = (i + 1) % 3;
        const double determinant = p[i] * q[l] - p[l] * q[i];
        CutMultipliers both{};
        both[j] = (direction[i] * q[l] - direction[l] * q[i]) / determinant;
        both[k] = (p[i] * direction[l] - p[l] * direction[i]) / determinant;
        if (both[j] > 0.0 && both[k] > 0.0) try_multipliers(both);
      }
    }
  }
  return least;
}

CutCube CutCube::shrunk(double margin) const {
  CutCube result = *this;
  result.cube_.half_width = std::max(0.0, cube_.half_width - margin);
  for (std::size_t j = 0; j < count_; ++j) {
    HalfSpace& cut = result.half_spaces_[j];
    cut.offset -= margin * std::hypot(cut.normal[0], cut.normal[1], cut.normal[2]);
  }
  return result;
}

Point CutCube::nearest(const Point& x) const {
  const double h = cube_.half_width;
  const Point free{x[0] - cube_.centre[0], x[1] - cube_.centre[1], x[2] - cube_.centre[2]};
  CutMultipliers multipliers{};
  Point target = free;
  // One half-space needs one sweep; several are solved in turn, each for the others' last multipliers.
  for (int sweep = 0; sweep < (count_ > 1 ? 6 : 1); ++sweep) {
    for (std::size_t j = 0; j < count_; ++j) {
      const Point& n = half_spaces_[j].normal;
      for (std::size_t i = 0; i < 3; ++i) target[i] += multipliers[j] * n[i];
      multipliers[j] = projection_multiplier(half_spaces_[j], target, h);
      for (std::size_t i = 0; i < 3; ++i) target[i] -= multipliers[j] * n[i];
    }
  }
  Point nearest = cube_.centre;
  for (std::size_t i = 0; i < 3; ++i) nearest[i] += std::clamp(target[i], -h, h);
  return nearest;
}

}  // namespace verisq::verify
