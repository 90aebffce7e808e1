/// Linear programs in two multipliers by enumeration; projections by coordinate ascent on the dual.
#include "verify/sets/solid_pair_polytope.hpp"

#include <algorithm>
#include <cmath>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Multipliers = std::array<double, 3>;

bool says_something(const HalfSpace& half_space) {
  return std::isfinite(half_space.offset) &&
         std::ranges::all_of(half_space.normal, [](double c) { return std::isfinite(c); });
}

/// h |direction - sum m_j n_j|_1 + sum m_j b_j, rounded up; infinity for multipliers that are no numbers of at least 0.
double dual_bound(double half_width, std::span<const HalfSpace> half_spaces, const Point& direction,
                  const Multipliers& multipliers) {
  // Fewer than 16 roundings lie between an input and the result: the error is below 32 u times the sum of the absolute
  // terms, `terms` being computed with a relative error that the same factor covers. What underflows loses less than
  // 2^-1070 each time, times the half-width at most.
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

/// The root of `excess` where it begins above 0, else 0: the multiplier of the target's projection. Of a half-space
/// that misses the cube, one that leads to the nearest corner.
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
  const auto try_multipliers = [&](const Multipliers& multipliers) {
    least = std::min(least, dual_bound(cube_.half_width, cuts, direction, multipliers));
  };
  // The bound is convex and piecewise linear in the multipliers: its least is at a corner, where as many of the
  // direction's components (or multipliers) vanish as there are multipliers.
  try_multipliers({});
  for (std::size_t j = 0; j < cuts.size(); ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      Multipliers single{};
      single[j] = direction[i] / cuts[j].normal[i];
      if (single[j] > 0.0) try_multipliers(single);
    }
    for (std::size_t k = j + 1; k < cuts.size(); ++k) {
      const Point& p = cuts[j].normal;
      const Point& q = cuts[k].normal;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t l = (i + 1) % 3;
        const double determinant = p[i] * q[l] - p[l] * q[i];
        Multipliers both{};
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
  Multipliers multipliers{};
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
