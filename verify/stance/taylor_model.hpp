/// Taylor models in the time of one step and in the deviations of parameters: a polynomial with interval coefficients,
/// and a bound of what it leaves out (Makino and Berz; docs/stance.md §9).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "verify/numbers/functions.hpp"
#include "verify/stance/scalar.hpp"

namespace verisq::stance {

/// All functions f of (t, d, e) in [-1, 1]^(1 + n + m) with
///
///     |f(t, d, e) - sum over i of t^i (c_i + sum over k of c_ki d_k + sum over l <= k of c_kli d_k d_l
///                                          + sum over k of b_ki e_k)| <= remainder
///
/// for some numbers within the coefficients. Degrees: at most `Degree` in t, at most 2 in the deviations d of
/// parameters, 1 in the errors e, with no product of the two; what an operation has of others goes to the remainder. So
/// dependence on parameters of first and second order cancels as numbers do, and on errors of first order.
///
/// Where it is open which branch of a piecewise function holds, the result is the hull of both.
template <std::size_t Degree>
class TaylorModel {
 public:
  static constexpr std::size_t row_size = Degree + 1;
  using Row = std::array<Interval, row_size>;
  /// The kinds of terms: of order 0, 1 and 2 in deviations, and of order 1 in errors.
  static constexpr std::size_t orders = 4;
  static constexpr std::size_t of_errors = 3;

  TaylorModel() : TaylorModel(Interval(0)) {}
  TaylorModel(double constant) : TaylorModel(Interval(constant)) {}     // NOLINT(google-explicit-constructor): exact
  TaylorModel(int constant) : TaylorModel(Interval(constant)) {}        // NOLINT(google-explicit-constructor): exact
  TaylorModel(const Interval& constant) { rows_[0][0][0] = constant; }  // NOLINT(google-explicit-constructor)

  /// Precondition: at most row_size coefficients; of the rest the remainder takes care.
  [[nodiscard]] static TaylorModel of_time(const std::vector<Interval>& coefficients) {
    TaylorModel result;
    result.add_row(0, 0, coefficients);
    return result;
  }

  /// d_k.
  [[nodiscard]] static TaylorModel deviation(std::size_t k) {
    TaylorModel result;
    result.add_row(1, k, {Interval(1)});
    return result;
  }

  /// Where d_k d_l is among the products of two deviations, l <= k.
  [[nodiscard]] static std::size_t pair_index(std::size_t k, std::size_t l) {
    return k < l ? pair_index(l, k) : k * (k + 1) / 2 + l;
  }

  /// Adds sum of coefficients[i] t^i, times the k-th product of `order` deviations, or the k-th error. Terms beyond the
  /// degree go to the remainder.
  void add_row(std::size_t order, std::size_t k, const std::vector<Interval>& coefficients) {
    std::vector<Row>& rows = rows_[order];
    while (rows.size() <= k) rows.emplace_back(zero_row());
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      if (i < row_size) {
        rows[k][i] += coefficients[i];
      } else {
        remainder_ = upward(remainder_ + size_of(coefficients[i]));
      }
    }
    constant_ = false;
  }

  /// Adds numbers of at most this size.
  void widen(double radius) {
    remainder_ = upward(remainder_ + radius);
    constant_ = constant_ && remainder_ == 0.0;
  }

  /// Coefficients of the powers of t by a product of `order` deviations, with pair_index for two, or by errors.
  [[nodiscard]] const std::vector<Row>& rows(std::size_t order) const { return rows_[order]; }
  [[nodiscard]] const Interval& constant() const { return rows_[0][0][0]; }

  /// Contains all values.
  [[nodiscard]] Interval range() const { return constant() + symmetric(size_without_constant()); }

  /// From above, of the absolute values.
  [[nodiscard]] double size() const { return size_of(range()); }

  TaylorModel& operator+=(const TaylorModel& b) {
    if (b.is_exactly_zero()) return *this;
    for (std::size_t order = 0; order < orders; ++order) {
      std::vector<Row>& mine = rows_[order];
      const std::vector<Row>& others = b.rows_[order];
      while (mine.size() < others.size()) mine.emplace_back(zero_row());
      for (std::size_t k = 0; k < others.size(); ++k) {
        for (std::size_t i = 0; i < row_size; ++i) {
          if (!is_zero(others[k][i])) mine[k][i] += others[k][i];
        }
      }
    }
    remainder_ = upward(remainder_ + b.remainder_);
    constant_ = constant_ && b.constant_;
    return *this;
  }
  TaylorModel& operator-=(const TaylorModel& b) { return *this += -b; }
  TaylorModel& operator*=(const TaylorModel& b) { return *this = *this * b; }
  TaylorModel& operator/=(const TaylorModel& b) { return *this = *this / b; }

  friend TaylorModel operator-(const TaylorModel& a) { return scaled(a, Interval(-1)); }
  friend TaylorModel operator+(TaylorModel a, const TaylorModel& b) { return a += b; }
  friend TaylorModel operator-(TaylorModel a, const TaylorModel& b) { return a += -b; }
  friend TaylorModel operator*(const TaylorModel& a, const TaylorModel& b) {
    if (a.is_exactly_zero() || b.is_exactly_zero()) return {};
    if (a.constant_) return scaled(b, a.constant());
    if (b.constant_) return scaled(a, b.constant());
    return product(a, b);
  }
  friend TaylorModel operator/(const TaylorModel& a, const TaylorModel& b) { return a * reciprocal(b); }

  friend TaylorModel square(const TaylorModel& a) { return a * a; }

  friend TaylorModel sin(const TaylorModel& a) {
    const Interval c = a.constant();
    const Interval s0 = sin(c);
    const Interval c0 = cos(c);
    return composed(
        a, {s0, c0, -s0, -c0}, [] { return 1.0; }, [&] { return sin(a.range()); });
  }
  friend TaylorModel cos(const TaylorModel& a) {
    const Interval c = a.constant();
    const Interval s0 = sin(c);
    const Interval c0 = cos(c);
    return composed(
        a, {c0, -s0, -c0, s0}, [] { return 1.0; }, [&] { return cos(a.range()); });
  }
  friend TaylorModel exp(const TaylorModel& a) {
    const Interval e0 = exp(a.constant());
    const Interval whole = exp(a.range());
    return composed(
        a, {e0, e0, e0, e0}, [&] { return size_of(whole); }, [&] { return whole; });
  }
  friend TaylorModel log(const TaylorModel& a) { return TaylorModel::within(log(a.range())); }
  /// Of the part that is not negative.
  friend TaylorModel sqrt(const TaylorModel& a) {
    const Interval whole = a.range();
    const Interval root = sqrt(whole);
    if (!(whole.lower() > 0.0)) return TaylorModel::within(root);
    // (1/2 choose j) x^(1/2 - j)
    std::vector<Interval> coefficients;
    const auto coefficient = [](const Interval& at, std::size_t j) {
      Interval value = sqrt(at);
      for (std::size_t i = 0; i < j; ++i) {
        const auto order = static_cast<int>(i);
        value = value * (Interval(1 - 2 * order) / Interval(2 * (order + 1))) / at;
      }
      return value;
    };
    for (std::size_t j = 0; j < terms; ++j) coefficients.push_back(coefficient(a.constant(), j));
    return series(a, coefficients, size_of(coefficient(whole, terms)), root);
  }
  /// For the exponents of contact: 1 and 3/2.
  friend TaylorModel pow(const TaylorModel& base, const TaylorModel& exponent) {
    const Interval n = exponent.constant();
    if (exponent.constant_ && n.lower() == n.upper()) {
      if (n.lower() == 1.0) return base;
      if (n.lower() == 1.5) return base * sqrt(base);
      if (n.lower() == 0.5) return sqrt(base);
      if (n.lower() == 0.0) return 1.0;
    }
    return TaylorModel::within(pow(base.range(), exponent.range()));
  }

  friend TaylorModel max(const TaylorModel& a, const TaylorModel& b) {
    if (certainly_less(a, b)) return b;
    if (certainly_less(b, a)) return a;
    return either(a, b);
  }
  friend TaylorModel min(const TaylorModel& a, const TaylorModel& b) { return -max(-a, -b); }

  friend bool is_zero(const TaylorModel& a) { return a.is_exactly_zero(); }
  /// Of the difference: what both depend on in the same way does not hide it.
  friend bool certainly_less(const TaylorModel& a, const TaylorModel& b) { return (b - a).range().lower() > 0.0; }
  /// All between the two.
  friend TaylorModel either(const TaylorModel& a, const TaylorModel& b) {
    const Interval between = hull((b - a).range(), Interval(0));
    return a + TaylorModel::within(between);
  }
  /// The same function, of which the caller asks for a part.
  friend TaylorModel part_below(const TaylorModel& a, double) { return a; }
  friend TaylorModel part_above(const TaylorModel& a, double) { return a; }

  /// A function with values in an interval, of which nothing else is known.
  [[nodiscard]] static TaylorModel within(const Interval& values) {
    const double middle = 0.5 * values.lower() + 0.5 * values.upper();
    TaylorModel result{middle};
    result.remainder_ = size_of(values - Interval(middle));
    result.constant_ = false;
    return result;
  }

  /// times one number within `factor`.
  friend TaylorModel scaled(const TaylorModel& a, const Interval& factor) {
    TaylorModel result = a;
    for (std::vector<Row>& rows : result.rows_) {
      for (Row& row : rows) {
        for (Interval& c : row) {
          if (!is_zero(c)) c *= factor;
        }
      }
    }
    result.remainder_ = upward(product_of_sizes(a.remainder_, size_of(factor)));
    return result;
  }

 private:
  static constexpr std::size_t terms = Degree + 3;  ///< of Taylor series: further powers have no term that is kept

  static Row zero_row() {
    Row row;
    row.fill(Interval(0));
    return row;
  }

  static double size_of(const Interval& a) { return std::max(std::fabs(a.lower()), std::fabs(a.upper())); }
  /// Rounded; what would underflow is larger than it is.
  static double product_of_sizes(double a, double b) { return a > 0.0 && b > 0.0 ? std::max(a * b, 0x1p-1000) : 0.0; }
  static Interval symmetric(double radius) { return {-radius, radius}; }

  /// Of a sum of `product_of_sizes`, by fewer than 2^13 operations in a row on numbers that are not negative, each
  /// within a factor of 1 + 2^-52 of the exact result: so that is at most this.
  static double upward(double a) { return a > 0.0 ? a * (1.0 + 0x1p-38) + 0x1p-1000 : a; }

  [[nodiscard]] bool is_exactly_zero() const {
    const auto zero_row = [](const Row& row) {
      return std::all_of(row.begin(), row.end(), [](const Interval& c) { return is_zero(c); });
    };
    return remainder_ == 0.0 && std::all_of(rows_.begin(), rows_.end(), [&](const std::vector<Row>& rows) {
             return std::all_of(rows.begin(), rows.end(), zero_row);
           });
  }

  /// Of the function less its constant coefficient.
  [[nodiscard]] double size_without_constant() const {
    double sum = remainder_;
    for (std::size_t order = 0; order < orders; ++order) {
      for (const Row& row : rows_[order]) {
        for (std::size_t i = order == 0 ? 1 : 0; i < row_size; ++i) sum += size_of(row[i]);
      }
    }
    return upward(sum);
  }

  using Sizes = std::array<double, row_size>;

  /// Of the coefficients of the powers of t, by the kind of term.
  [[nodiscard]] std::array<Sizes, orders> sizes() const {
    std::array<Sizes, orders> result{};
    for (std::size_t order = 0; order < orders; ++order) {
      for (const Row& row : rows_[order]) {
        for (std::size_t i = 0; i < row_size; ++i) result[order][i] += size_of(row[i]);
      }
    }
    return result;
  }

  static void add_product(Row& sum, const Row& a, const Row& b) {
    for (std::size_t i = 0; i < row_size; ++i) {
      if (is_zero(a[i])) continue;
      for (std::size_t j = 0; i + j < row_size; ++j) {
        if (!is_zero(b[j])) sum[i + j] += a[i] * b[j];
      }
    }
  }

  static double total(const Sizes& a) {
    double sum = 0.0;
    for (const double x : a) sum += x;
    return sum;
  }

  /// Of the terms beyond the degree.
  static double beyond(const Sizes& a, const Sizes& b) {
    double sum = 0.0;
    for (std::size_t i = 1; i < row_size; ++i) {
      if (a[i] == 0.0) continue;
      for (std::size_t j = row_size - i; j < row_size; ++j) sum += product_of_sizes(a[i], b[j]);
    }
    return sum;
  }

  static TaylorModel product(const TaylorModel& a, const TaylorModel& b) {
    TaylorModel result;
    result.constant_ = false;
    for (std::size_t order = 1; order < orders; ++order)
      result.rows_[order].assign(std::max(a.rows_[order].size(), b.rows_[order].size()), zero_row());
    const Row& a0 = a.rows_[0][0];
    const Row& b0 = b.rows_[0][0];
    add_product(result.rows_[0][0], a0, b0);
    for (std::size_t order = 1; order < orders; ++order) {
      std::vector<Row>& rows = result.rows_[order];
      for (std::size_t k = 0; k < a.rows_[order].size(); ++k) add_product(rows[k], a.rows_[order][k], b0);
      for (std::size_t k = 0; k < b.rows_[order].size(); ++k) add_product(rows[k], a0, b.rows_[order][k]);
    }
    std::vector<Row>& pairs = result.rows_[2];
    for (std::size_t k = 0; k < a.rows_[1].size(); ++k) {
      for (std::size_t l = 0; l < b.rows_[1].size(); ++l) {
        const std::size_t index = pair_index(k, l);
        while (pairs.size() <= index) pairs.emplace_back(zero_row());
        add_product(pairs[index], a.rows_[1][k], b.rows_[1][l]);
      }
    }
    // Bounded upward: |t|, |d_k|, |e_k| <= 1.
    const std::array<Sizes, orders> p = a.sizes();
    const std::array<Sizes, orders> q = b.sizes();
    const double deviations_a = total(p[1]) + total(p[2]);
    const double deviations_b = total(q[1]) + total(q[2]);
    const double errors_a = total(p[of_errors]);
    const double errors_b = total(q[of_errors]);
    const double size_a = total(p[0]) + deviations_a + errors_a;
    const double size_b = total(q[0]) + deviations_b + errors_b;
    double left_out = beyond(p[0], q[0]) + beyond(p[0], q[1]) + beyond(p[1], q[0]);
    left_out += beyond(p[0], q[2]) + beyond(p[1], q[1]) + beyond(p[2], q[0]);
    left_out += product_of_sizes(total(p[1]), total(q[2])) + product_of_sizes(total(p[2]), total(q[1])) +
                product_of_sizes(total(p[2]), total(q[2]));
    left_out += beyond(p[0], q[of_errors]) + beyond(p[of_errors], q[0]);
    left_out += product_of_sizes(errors_a, deviations_b + errors_b) + product_of_sizes(deviations_a, errors_b);
    result.remainder_ = upward(left_out + product_of_sizes(size_a, b.remainder_) +
                               product_of_sizes(size_b, a.remainder_) + product_of_sizes(a.remainder_, b.remainder_));
    return result;
  }

  friend TaylorModel reciprocal(const TaylorModel& a) {
    if (a.constant_) return Interval(1) / a.constant();
    const Interval whole = a.range();
    if (!(whole.lower() > 0.0 || whole.upper() < 0.0)) throw std::domain_error("Taylor model: division by 0");
    const Interval inverse = Interval(1) / a.constant();
    std::vector<Interval> coefficients{inverse};
    while (coefficients.size() < terms) coefficients.push_back(-(coefficients.back() * inverse));
    Interval last = Interval(1) / whole;  // (-1)^j x^(-1-j) for j = terms
    for (std::size_t j = 0; j < terms; ++j) last *= Interval(1) / whole;
    return series(a, coefficients, size_of(last), Interval(1) / whole);
  }

  /// f(a) for the derivatives 0 to 3 of f at a's constant coefficient, of which further ones repeat with period 4;
  /// `bound` is of all derivatives anywhere in a's range.
  template <class Bound, class Range>
  static TaylorModel composed(const TaylorModel& a, const std::array<Interval, 4>& derivatives, const Bound& bound,
                              const Range& range) {
    if (a.constant_) return derivatives[0];
    std::vector<Interval> coefficients;
    Interval factorial(1);
    for (std::size_t j = 0; j < terms; ++j) {
      if (j > 0) factorial *= Interval(static_cast<int>(j));
      coefficients.push_back(derivatives[j % 4] / factorial);
    }
    factorial *= Interval(static_cast<int>(terms));
    return series(a, coefficients, size_of(Interval(bound()) / factorial), range());
  }

  /// sum of coefficients[j] (a - a_0)^j, within last |a - a_0|^(number of coefficients): Taylor's theorem with
  /// Lagrange's remainder. Where that is wider than all of the function's range, the range.
  static TaylorModel series(const TaylorModel& a, const std::vector<Interval>& coefficients, double last,
                            const Interval& range) {
    if (a.constant_) return coefficients.front();
    TaylorModel change = a;
    change.rows_[0][0][0] = Interval(0);  // the very number that coefficients are taken at, wherever it lies within
    TaylorModel sum{coefficients.back()};
    for (std::size_t j = coefficients.size() - 1; j-- > 0;) sum = sum * change + TaylorModel(coefficients[j]);
    const double radius = change.size_without_constant();
    double power = last;
    for (std::size_t j = 0; j < coefficients.size(); ++j) power = product_of_sizes(power, radius);
    sum.widen(upward(power));
    const double width = range.upper() - range.lower();
    if (!(2.0 * sum.size_without_constant() <= 2.0 * width + 0x1p-1000)) return TaylorModel::within(range);
    return sum;
  }

  std::array<std::vector<Row>, orders> rows_ = {std::vector<Row>{zero_row()}, {}, {}, {}};
  double remainder_ = 0.0;
  bool constant_ = true;  ///< but for constant() all is 0: fewer operations
};

/// Any number within an interval, another one at each time and deviation perhaps, as a scalar; to double its middle.
template <class T>
struct NumberWithin;
template <>
struct NumberWithin<double> {
  static double of(const Interval& a) { return 0.5 * a.lower() + 0.5 * a.upper(); }
};
template <std::size_t Degree>
struct NumberWithin<TaylorModel<Degree>> {
  static TaylorModel<Degree> of(const Interval& a) { return TaylorModel<Degree>::within(a); }
};
template <class T, std::size_t N>
struct NumberWithin<Dual<T, N>> {
  static Dual<T, N> of(const Interval& a) { return Dual<T, N>(NumberWithin<T>::of(a)); }
};

template <std::size_t Degree>
inline constexpr bool has_kinks<TaylorModel<Degree>> = true;

}  // namespace verisq::stance
