/// This file implements the derivatives by the shares of the coordinates.
#include "tests/mutation/gauge_square.hpp"

#include <cmath>
#include <limits>

namespace verisq::mutation {
namespace {

LongVector sizes(const LongVector& x) {
  return {std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])};
}

Long dot(const LongVector& a, const LongVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void add_outer(LongMatrix& sum, Long factor, const LongVector& a) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) sum[i][j] += factor * a[i] * a[j];
}

}  // namespace

Long GaugeSquare::value(const LongVector& x) const {
  const Long gauge = norm_.gauge(x);
  return gauge * gauge / 2;
}

LongVector GaugeSquare::gradient(const LongVector& x) const {
  const LongVector size = sizes(x);
  const Long gauge = norm_.gauge(size);
  LongVector n = norm_.gradient(size, gauge);
  for (Long& component : n) component *= gauge;
  return n;
}

// With the powers of 0 that are left over: 1 where an exponent is exactly 1, and 0 otherwise.
LongMatrix GaugeSquare::second_derivative(const LongVector& x) const {
  const LongVector size = sizes(x);
  const LongVector& axes = norm_.semi_axes();
  const Long p_1 = norm_.outer().primal;
  const Long p_2 = norm_.inner().primal;
  const Long section = oracle::planar_norm<Long>(size[0] / axes[0], size[1] / axes[1], p_2);
  const Long gauge = oracle::planar_norm<Long>(section, size[2] / axes[2], p_1);
  const Long in_x = size[0] / axes[0] / section;
  const Long in_y = size[1] / axes[1] / section;
  const Long in_r = section / gauge;
  const Long in_z = size[2] / axes[2] / gauge;
  const auto half = [](Long ratio, Long p) { return std::pow(ratio, p / 2 - 1); };
  const Long of_r = half(in_r, p_1);
  LongMatrix sum{};
  // g^2 A B u^2 and so on.
  add_outer(sum, 1, {of_r * half(in_x, p_2) / axes[0], 0, 0});
  add_outer(sum, 1, {0, of_r * half(in_y, p_2) / axes[1], 0});
  add_outer(sum, 1, {0, 0, half(in_z, p_1) / axes[2]});
  const Long share_z = std::pow(in_z, p_1 / 2);
  add_outer(sum, p_1 - 2,
            {of_r * share_z * std::pow(in_x, p_2 - 1) / axes[0], of_r * share_z * std::pow(in_y, p_2 - 1) / axes[1],
             -std::pow(in_r, p_1 / 2) * half(in_z, p_1) / axes[2]});
  add_outer(sum, p_2 - 2,
            {of_r * std::pow(in_y, p_2 / 2) * half(in_x, p_2) / axes[0],
             -of_r * std::pow(in_x, p_2 / 2) * half(in_y, p_2) / axes[1], 0});
  return sum;
}

SectionProfile::Height SectionProfile::height(Long z) const {
  const Long room = 1 - taper_ * taper_ + taper_ * z / end_;
  const Long untapered = z / end_ / room;
  const Long size = std::fabs(untapered);
  const Long rest = 1 - std::pow(size, p_1_);
  return {room, untapered, std::pow(rest, 1 / p_1_),
          -std::copysign(std::pow(size, p_1_ - 1), untapered) * std::pow(rest, 1 / p_1_ - 1)};
}

Long SectionProfile::value(const LongVector& x) const {
  const Height at = height(x[2]);
  return section_.value({x[0], x[1], 0}) - std::pow(at.room * at.profile, 2.0L) / 2;
}

// The derivatives of h by z/a3 are k h/S + (1 - k²)/S (h/S)' and (1 - k²)²/S³ (h/S)''.
LongVector SectionProfile::gradient(const LongVector& x) const {
  const Height at = height(x[2]);
  const Long fall = 1 - taper_ * taper_;
  LongVector n = section_.gradient({x[0], x[1], 0});
  n[2] = -at.profile * (taper_ * at.room * at.profile + fall * at.slope) / end_;
  return n;
}

LongMatrix SectionProfile::second_derivative(const LongVector& x) const {
  const Height at = height(x[2]);
  const Long fall = 1 - taper_ * taper_;
  const Long size = std::fabs(at.untapered);
  const Long first = taper_ * at.profile + fall / at.room * at.slope;
  const Long bent = fall * fall / (at.room * at.room) * (p_1_ - 1) * std::pow(size, p_1_ - 2) *
                    std::pow(1 - std::pow(size, p_1_), 2 / p_1_ - 2);
  LongMatrix second = section_.second_derivative({x[0], x[1], 0});
  second[2][2] =
      at.room > 0 && size < 1 ? (bent - first * first) / (end_ * end_) : std::numeric_limits<Long>::infinity();
  return second;
}

LargestStep largest_step(const LongMatrix& second, Long stretch) {
  LongMatrix scaled = second;
  for (std::size_t i = 0; i < 3; ++i) {
    scaled[i][2] /= stretch;
    scaled[2][i] /= stretch;
  }
  // From its longest row on: a power of it, as good as repeated squaring.
  for (int i = 0; i < 6; ++i) {
    Long size = 0;
    for (const LongVector& row : scaled)
      for (const Long entry : row) size = std::max(size, std::fabs(entry));
    if (!(size > 0)) return {{1, 0, 0}, 0};
    LongMatrix squared{};
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l) squared[j][k] += scaled[j][l] / size * scaled[l][k] / size;
    scaled = squared;
  }
  LongVector best{};
  for (const LongVector& row : scaled)
    if (dot(row, row) > dot(best, best)) best = row;
  const Long length = std::sqrt(dot(best, best));
  LongVector step{best[0] / length, best[1] / length, best[2] / (length * stretch)};
  Long value = 0;
  for (std::size_t i = 0; i < 3; ++i) value += step[i] * dot(second[i], step);
  return {step, value};
}

}  // namespace verisq::mutation
