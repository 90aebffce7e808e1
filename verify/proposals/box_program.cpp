/// The simplex method on the dual program: six rows, the multipliers and two slacks a direction.
#include "verify/proposals/box_program.hpp"

#include <array>
#include <cmath>

namespace verisq::verify {

namespace {

constexpr std::size_t kRows = 6;
constexpr int kMostPivots = 64;
/// Reduced costs and pivots that are smaller, in parts of the box, count as 0.
constexpr double kNegligible = 1e-11;

/// min Σ λ c + Σ half (u + v) where u - v - Σ λ a = objective, all >= 0, directions scaled so that half is 1. A slack
/// of each row is the first basis.
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
  std::vector<double> cells_;  ///< of the rows, then reduced costs
  std::array<double, kRows> right_{};
  std::array<std::size_t, kRows> basis_{};
};

}  // namespace

Multipliers multipliers(const PoseParameters& objective, const PoseParameters& half,
                        std::span<const LinearConstraint> constraints) {
  return Tableau(objective, half, constraints).solved();
}

}  // namespace verisq::verify
