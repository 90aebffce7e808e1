/// The motion of a body in contact, without units and in coordinates in which it is polynomial.
#pragma once

#include "verify/stance/taylor.hpp"
#include "verify/stance/verified_integration.hpp"

namespace verisq::stance {

/// Touch-down speed v, time T = (m / (k v^(n-1)))^(1/(n+1)) and length v T as units turn Hunt-Crossley contact with
/// v_N = v into x' = w, w' = gamma - x^n (1 + D w), gamma = g T / v, from x = 0, w = 1. In y = sqrt(x) and a time in
/// which d(time) = 2 y d(new time):
///   y' = w,   w' = 2 y (gamma - y^(2n) (1 + D w)),   time' = 2 y,   D' = 0,
/// polynomial for n = 1 and n = 3/2. At y = 0, at touch-down and lift-off, y alone moves: an error in the time of the
/// event leaves velocity and time nearly as they are.
///
/// The law's max(0, 1 + D w) is 1 + D w here: where 1 + D w = 0, w' is gamma >= 0 times 2 y, so that w cannot fall
/// through -1/D (at gamma = 0, -1/D is itself a solution). It starts at 1 and so stays above: the clamp never acts.
class BounceFlow {
 public:
  static constexpr int size = 4;
  enum Component : int { root_of_penetration, velocity, time, damping };

  /// `exponent` is n, 1 or 1.5.
  BounceFlow(const Interval& gravity, double exponent) : gravity_(gravity), exponent_(exponent) {}

  template <class T>
  [[nodiscard]] std::vector<StateVector<T, size>> taylor_coefficients(const StateVector<T, size>& state,
                                                                      std::size_t order) const {
    const T& d = state[damping];
    Series<T> y{state[root_of_penetration]};
    Series<T> w{state[velocity]};
    Series<T> penetration;   // y^2
    Series<T> elastic;       // y^(2n)
    Series<T> damped;        // 1 + D w
    Series<T> acceleration;  // gamma - y^(2n) (1 + D w)
    std::vector<StateVector<T, size>> result{state};
    for (std::size_t k = 0; k < order; ++k) {
      penetration.push_back(k == 0 ? T(square(y[0])) : product_coefficient(y, y, k));
      elastic.push_back(exponent_ == 1.0 ? penetration[k] : product_coefficient(penetration, y, k));
      damped.push_back(k == 0 ? T(T(1) + d * w[0]) : T(d * w[k]));
      acceleration.push_back(T(k == 0 ? gravity_ : Interval(0)) - product_coefficient(elastic, damped, k));
      const T next(Interval(static_cast<int>(k) + 1));
      const T two(2);
      StateVector<T, size> coefficient;
      coefficient[root_of_penetration] = w[k] / next;
      coefficient[velocity] = two * product_coefficient(y, acceleration, k) / next;
      coefficient[time] = two * y[k] / next;
      coefficient[damping] = T(0);
      y.push_back(coefficient[root_of_penetration]);
      w.push_back(coefficient[velocity]);
      result.push_back(coefficient);
    }
    return result;
  }

  /// w^2/2 + x^(n+1)/(n+1) - gamma x, which the contact never raises: its derivative is -x^n D w^2. At x = 0 it is
  /// w^2/2, so that a body whose energy is negative stays in contact for good.
  [[nodiscard]] Interval energy(const StateBox<size>& state) const {
    const Interval y = max(state[root_of_penetration], Interval(0));  // in contact
    const Interval x = square(y);
    const Interval elastic = exponent_ == 1.0 ? x : x * y;
    return square(state[velocity]) / Interval(2) + x * (elastic / Interval(exponent_ + 1.0) - gravity_);
  }

 private:
  Interval gravity_;
  double exponent_;
};

}  // namespace verisq::stance
