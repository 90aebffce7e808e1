/// Distance of two convex sets by following the central path of its barrier problem: one method for solids and
/// triangles, separated, touching and overlapping, whatever their exponents; in double to start and at 200 bits to end.
///
/// A superquadric is an affine image of a product of power cones (Chares 2009; docs/mathematics.md §1): with
/// p_i = 2/e_i,
///   |X| <= u^(1/p2) r^(1-1/p2),  |Y| <= v^(1/p2) r^(1-1/p2),  r = u + v,
///   r <= s^(1/p1),  |Z| <= t^(1/p1),  s + t <= 1,
/// where u/r, v/r, s and t are the terms of the two nested norms, each a variable because each may be tiny. Each cone
/// has a self-concordant barrier of parameter 3, hence Newton's method cannot stall, and on the central path of
/// parameter mu the vector between the two points proves a lower bound within (2 + 3 cones + half-lines) mu of their
/// distance. Where the sets overlap, the path leads to a point in the interior of both.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tests/oracle/real.hpp"

namespace verisq::oracle {

/// constant + coefficient (w_i + w_j) of the variables w; `count` says how many of the two there are.
struct Affine {
  int constant = 0;
  int coefficient = 1;  ///< 1 or -1
  std::array<std::size_t, 2> variables{};
  std::size_t count = 0;

  [[nodiscard]] std::span<const std::size_t> used() const { return std::span(variables).first(count); }

  template <class Number>
  [[nodiscard]] Number operator()(const std::vector<Number>& w) const {
    Number sum = 0;
    for (const std::size_t i : used()) sum += w[i];
    return coefficient > 0 ? Number(constant + sum) : Number(constant - sum);
  }
};

[[nodiscard]] constexpr Affine one() {
  return {1, 1, {}, 0};
}
[[nodiscard]] constexpr Affine variable(std::size_t i) {
  return {0, 1, {i, 0}, 1};
}
[[nodiscard]] constexpr Affine sum_of(std::size_t i, std::size_t j) {
  return {0, 1, {i, j}, 2};
}
[[nodiscard]] constexpr Affine one_less(std::size_t i, std::size_t j) {
  return {1, -1, {i, j}, 2};
}

/// Barrier of one constraint: its gradient and Hessian added to those of the sum.
template <class Number>
struct Barrier {
  std::vector<Number> gradient;
  std::vector<Number> hessian;  ///< dense, by rows

  explicit Barrier(std::size_t variables) : gradient(variables, Number(0)), hessian(variables * variables, Number(0)) {}

  void add(const Affine& slot, const Number& derivative) {
    for (const std::size_t i : slot.used()) gradient[i] += slot.coefficient > 0 ? derivative : Number(-derivative);
  }
  void add(const Affine& first, const Affine& second, const Number& derivative) {
    const Number value = first.coefficient == second.coefficient ? derivative : Number(-derivative);
    for (const std::size_t i : first.used()) {
      for (const std::size_t j : second.used()) hessian[i * gradient.size() + j] += value;
    }
  }
};

/// |x| <= u^exponent r^(1-exponent) with 0 < exponent <= 1 and u, r > 0.
template <class Number>
struct PowerCone {
  Affine x;
  Affine u;
  Affine r;
  Number exponent;

  /// -log(u^2e r^(2-2e) - x^2) - (1-e) log u - e log r; false outside the cone.
  [[nodiscard]] bool add_to(Barrier<Number>& sum, const std::vector<Number>& w) const {
    using std::exp;
    using std::log;
    const Number X = x(w);
    const Number U = u(w);
    const Number R = r(w);
    if (!(U > 0 && R > 0)) return false;
    const Number complement = 1 - exponent;
    const Number power = exp(2 * (exponent * log(U) + complement * log(R)));
    const Number slack = power - X * X;
    if (!(slack > 0)) return false;
    // f = slack: gradient and Hessian of f, then of -log f.
    const Number scale = power / slack;
    const std::array<const Affine*, 3> slots{&x, &u, &r};
    const Triple<Number> slope{-2 * X / slack, 2 * exponent * scale / U, 2 * complement * scale / R};
    const Number bend_uu = 2 * exponent * (2 * exponent - 1) * scale / (U * U);
    const Number bend_rr = 2 * complement * (1 - 2 * exponent) * scale / (R * R);
    const Number bend_ur = 4 * exponent * complement * scale / (U * R);
    const Number bend_xx = -2 / slack;
    const Triple<Triple<Number>> bend{Triple<Number>{bend_xx, Number(0), Number(0)},
                                      Triple<Number>{Number(0), bend_uu, bend_ur},
                                      Triple<Number>{Number(0), bend_ur, bend_rr}};
    for (std::size_t i = 0; i < 3; ++i) {
      sum.add(*slots[i], Number(-slope[i]));
      for (std::size_t j = 0; j < 3; ++j) sum.add(*slots[i], *slots[j], Number(slope[i] * slope[j] - bend[i][j]));
    }
    sum.add(u, Number(-complement / U));
    sum.add(u, u, Number(complement / (U * U)));
    sum.add(r, Number(-exponent / R));
    sum.add(r, r, Number(exponent / (R * R)));
    return true;
  }
};

/// x > 0, barrier -log x.
struct HalfLine {
  Affine x;

  template <class Number>
  [[nodiscard]] bool add_to(Barrier<Number>& sum, const std::vector<Number>& w) const {
    const Number X = x(w);
    if (!(X > 0)) return false;
    sum.add(x, Number(-1 / X));
    sum.add(x, x, Number(1 / (X * X)));
    return true;
  }
};

/// Minimise |d(w)| with d(w) = origin + sum of columns times variables, over the cones.
template <class Number>
struct DistanceProgram {
  struct Column {
    std::size_t variable;
    Triple<Number> vector;
  };
  Triple<Number> origin{Number(0), Number(0), Number(0)};
  std::vector<Column> columns;
  std::vector<PowerCone<Number>> cones;
  std::vector<HalfLine> half_lines;
  std::vector<Number> start;  ///< inside all cones

  static constexpr std::size_t variables_of_superquadric = 7;  ///< the first three are X, Y, Z

  /// Appends the superquadric in units of its semi-axes: the columns are what its X, Y and Z add to d.
  void add_superquadric(const std::array<double, 2>& exponents, const Triple<Triple<Number>>& axes) {
    using std::pow;
    const std::size_t X = start.size();
    const std::size_t u = X + 3;
    const std::size_t v = X + 4;
    const std::size_t s = X + 5;
    const std::size_t t = X + 6;
    const Number outer = Number(exponents[0]) / 2;
    const Number inner = Number(exponents[1]) / 2;
    cones.push_back({variable(X), variable(u), sum_of(u, v), inner});
    cones.push_back({variable(X + 1), variable(v), sum_of(u, v), inner});
    cones.push_back({sum_of(u, v), variable(s), one(), outer});
    cones.push_back({variable(X + 2), variable(t), one(), outer});
    half_lines.push_back({one_less(s, t)});
    for (std::size_t i = 0; i < 3; ++i) columns.push_back({X + i, axes[i]});
    const Number third = Number(1) / 3;
    const Number part = pow(third, outer) / 4;
    start.insert(start.end(), {Number(0), Number(0), Number(0), part, part, third, third});
  }

  /// Appends the triangle of the edges from its first corner.
  void add_triangle(const std::array<Triple<Number>, 2>& edges) {
    const std::size_t w = start.size();
    half_lines.insert(half_lines.end(), {{variable(w)}, {variable(w + 1)}, {one_less(w, w + 1)}});
    for (std::size_t i = 0; i < 2; ++i) columns.push_back({w + i, edges[i]});
    start.insert(start.end(), 2, Number(1) / 3);
  }

  [[nodiscard]] Triple<Number> difference_at(const std::vector<Number>& w) const {
    Triple<Number> d = origin;
    for (const Column& column : columns) {
      for (std::size_t k = 0; k < 3; ++k) d[k] += column.vector[k] * w[column.variable];
    }
    return d;
  }
};

/// A point of the central path, by Newton's method from any interior point, and steps along the path.
template <class Number>
class CentralPath {
 public:
  CentralPath(const DistanceProgram<Number>& program, std::vector<Number> w, const Number& mu)
      : program_(program), w_(std::move(w)), mu_(mu) {}

  [[nodiscard]] const std::vector<Number>& variables() const { return w_; }
  [[nodiscard]] const Number& mu() const { return mu_; }

  /// mu times the derivative of the variables by mu, as of the last `advance`: how far the end of the path is.
  [[nodiscard]] const std::vector<Number>& outstanding() const { return outstanding_; }

  /// Newton to the path at the present mu; false where rounding or the limit of steps ends it.
  [[nodiscard]] bool centre(int most_steps = 120) {
    std::optional<Local> here = local(w_, mu_);
    for (steps_ = 0; steps_ < most_steps && here; ++steps_) {
      if (!factorise(*here)) return false;
      const std::vector<Number> step = solve(*here, here->gradient);
      const Number squared = product(here->gradient, step) / mu_;
      if (!(squared >= 0)) return false;
      const double decrement = std::sqrt(to_double(squared));
      if (!std::isfinite(decrement)) return false;
      if (decrement < centred) return finish(*here, step);
      here = damped(step, decrement);
    }
    return false;
  }

  /// To a smaller mu along the tangent, farther as long as the path is straight; false at the end of the precision.
  [[nodiscard]] bool advance(const Number& goal) {
    constexpr double slowest = 0.9;
    constexpr double fastest = 1e-8;
    constexpr int most_steps = 8;
    const std::vector<Number> from = w_;
    const Number mu = mu_;
    const std::vector<Number> tangent = outstanding_;
    while (reduction_ < slowest) {
      mu_ = std::max<Number>(goal, mu * Number(reduction_));
      const Number factor = mu_ / mu - 1;
      for (std::size_t i = 0; i < from.size(); ++i) w_[i] = from[i] + factor * tangent[i];
      if (centre(most_steps)) {
        if (steps_ <= 3) reduction_ = std::max(reduction_ * reduction_, fastest);
        if (steps_ > 6) reduction_ = std::sqrt(reduction_);
        return true;
      }
      reduction_ = std::sqrt(reduction_);
    }
    w_ = from;
    mu_ = mu;
    return false;
  }

 private:
  static constexpr double centred = 0.02;  ///< Newton decrement: the next step would leave the square of it

  /// The scaled barrier function mu F at one point; of F = psi(d/mu) + B, where psi is the second-order cone's barrier
  /// with the bound on |d| minimised out, only derivatives are used.
  struct Local {
    std::vector<Number> gradient;
    std::vector<Number> hessian;  ///< after `factorise` its Cholesky factor, below the diagonal and on it
    std::vector<Number> by_mu;    ///< derivative of the gradient by mu
  };

  [[nodiscard]] static double to_double(const Number& a) { return static_cast<double>(a); }

  [[nodiscard]] static Number product(const std::vector<Number>& a, const std::vector<Number>& b) {
    Number sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }

  [[nodiscard]] std::optional<Local> local(const std::vector<Number>& w, const Number& mu) const {
    using std::sqrt;
    Barrier<Number> barrier(w.size());
    for (const HalfLine& line : program_.half_lines) {
      if (!line.add_to(barrier, w)) return std::nullopt;
    }
    for (const PowerCone<Number>& cone : program_.cones) {
      if (!cone.add_to(barrier, w)) return std::nullopt;
    }
    Local result{barrier.gradient, std::move(barrier.hessian), barrier.gradient};
    for (Number& entry : result.gradient) entry *= mu;
    for (Number& entry : result.hessian) entry *= mu;
    const Triple<Number> d = program_.difference_at(w);
    const Number root = sqrt(mu * mu + dot(d, d));
    const Number sum = mu + root;
    const Number drift = (1 + mu / root) / (sum * sum);
    const Number across = 1 / sum;
    const Number along = 1 / (root * sum * sum);
    for (const auto& a : program_.columns) {
      const Number part = dot(a.vector, d);
      result.gradient[a.variable] += part * across;
      result.by_mu[a.variable] -= part * drift;
      for (const auto& b : program_.columns) {
        result.hessian[a.variable * w.size() + b.variable] +=
            dot(a.vector, b.vector) * across - part * dot(b.vector, d) * along;
      }
    }
    return result;
  }

  [[nodiscard]] static bool factorise(Local& here) {
    using std::sqrt;
    const std::size_t n = here.gradient.size();
    std::vector<Number>& l = here.hessian;
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = j; i < n; ++i) {
        Number entry = l[i * n + j];
        for (std::size_t k = 0; k < j; ++k) entry -= l[i * n + k] * l[j * n + k];
        if (i == j) {
          if (!(entry > 0)) return false;
          l[j * n + j] = sqrt(entry);
        } else {
          l[i * n + j] = entry / l[j * n + j];
        }
      }
    }
    return true;
  }

  [[nodiscard]] static std::vector<Number> solve(const Local& here, std::vector<Number> x) {
    const std::size_t n = x.size();
    const std::vector<Number>& l = here.hessian;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= l[i * n + k] * x[k];
      x[i] /= l[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) x[i] -= l[k * n + i] * x[k];
      x[i] /= l[i * n + i];
    }
    return x;
  }

  /// The longest of the steps 1, 1/2, ... that is inside and does not pass the minimum along it; the step
  /// 1/(1 + decrement), which self-concordance allows, where there is none.
  [[nodiscard]] std::optional<Local> damped(const std::vector<Number>& step, double decrement) {
    const std::vector<Number> from = w_;
    const auto stepped = [&](double length) {
      for (std::size_t i = 0; i < from.size(); ++i) w_[i] = from[i] - Number(length) * step[i];
      return local(w_, mu_);
    };
    const double safe = 1 / (1 + decrement);
    for (double length = 1; length > safe; length /= 2) {
      std::optional<Local> there = stepped(length);
      if (there && (decrement < 0.25 || product(there->gradient, step) >= 0)) return there;
    }
    return stepped(safe);
  }

  /// The last Newton step, which stays inside because the decrement is below 1, and the tangent.
  [[nodiscard]] bool finish(const Local& here, const std::vector<Number>& step) {
    for (std::size_t i = 0; i < step.size(); ++i) w_[i] -= step[i];
    outstanding_ = solve(here, here.by_mu);
    for (Number& entry : outstanding_) entry *= -mu_;
    return true;
  }

  const DistanceProgram<Number>& program_;
  std::vector<Number> w_;
  Number mu_;
  std::vector<Number> outstanding_;
  double reduction_ = 0.2;
  int steps_ = 0;
};

}  // namespace verisq::oracle
