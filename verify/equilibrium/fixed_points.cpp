/// Wider and wider boxes about 0 are tried.
#include "verify/equilibrium/fixed_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace verisq::verify {
namespace {

/// About 0, wider than `errors`, so that an operator may map it into itself.
PreciseBox inflated(const PreciseBox& errors) {
  constexpr double factor = 1.25;
  constexpr double share_of_largest = 0x1p-40;  // an error of one component reaches others
  constexpr double least = 0x1p-1000;
  double largest = 0.0;
  std::vector<double> sizes;
  for (const PreciseInterval& error : errors) {
    sizes.push_back(abs(error).upper().to_double(Direction::up));
    largest = std::max(largest, sizes.back());
  }
  PreciseBox wide;
  for (const double size : sizes) {
    const Real radius(factor * size + share_of_largest * largest + least);
    wide.emplace_back(-radius, radius);
  }
  return wide;
}

}  // namespace

std::optional<ApproximateMatrix> approximate_inverse(ApproximateMatrix m) {
  const std::size_t size = m.size();
  ApproximateMatrix inverse(size, std::vector<double>(size, 0.0));
  for (std::size_t i = 0; i < size; ++i) inverse[i][i] = 1.0;
  for (std::size_t column = 0; column < size; ++column) {
    std::size_t pivot = column;
    for (std::size_t i = column; i < size; ++i) {
      if (std::fabs(m[i][column]) > std::fabs(m[pivot][column])) pivot = i;
    }
    if (!(std::fabs(m[pivot][column]) > 0.0)) return std::nullopt;
    std::swap(m[column], m[pivot]);
    std::swap(inverse[column], inverse[pivot]);
    for (std::size_t i = 0; i < size; ++i) {
      const double share = m[i][column] / m[column][column];
      if (i == column || share == 0.0) continue;
      for (std::size_t k = 0; k < size; ++k) {
        m[i][k] -= share * m[column][k];
        inverse[i][k] -= share * inverse[column][k];
      }
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (double& entry : inverse[i]) entry /= m[i][i];
    if (!std::ranges::all_of(inverse[i], [](double entry) { return std::isfinite(entry); })) return std::nullopt;
  }
  return inverse;
}

std::optional<FixedPoints> fixed_points(const PreciseBox& z, const std::vector<PreciseBox>& c) {
  constexpr int most_inflations = 12;
  constexpr int refinements = 3;
  const auto image_of = [&](const PreciseBox& x) {
    PreciseBox image;
    for (std::size_t i = 0; i < z.size(); ++i) image.push_back(z[i] + dot(c[i], x));
    return image;
  };
  PreciseBox errors = z;
  for (int i = 0; i < most_inflations; ++i) {
    const PreciseBox wide = inflated(errors);
    errors = image_of(wide);
    if (!lies_inside(errors, wide)) continue;
    for (int k = 0; k < refinements; ++k) errors = image_of(errors);
    return FixedPoints{wide, errors};
  }
  return std::nullopt;
}

}  // namespace verisq::verify
