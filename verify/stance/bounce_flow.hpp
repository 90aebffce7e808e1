/// The motion of a body in contact, without units and in coordinates in which it is polynomial.
#pragma once

#include "verify/stance/taylor.hpp"
#include "verify/stance/verified_integration.hpp"

namespace verisq::stance {

/// Touch-down speed v, time T = (m / (k v^(n-1)))^(1/(n+1)) and length v T as units turn Hunt-Crossley contact with the
/// damping D and the impact velocity v_N into x' = w, w' = gamma - x^n max(0, 1 + d w), from x = 0, w = 1, with
/// gamma = g T / v and the damping factor d = D v / v_N: v_N acts through d alone, the mass through gamma alone. In
/// y = sqrt(x) and a time in which d(time) = 2 y d(new time):
///   y' = w,   w' = 2 y (gamma - y^(2n) (1 + d w)),   time' = 2 y,   gamma' = d' = 0,
/// polynomial for n = 1 and n = 3/2. At y = 0, at touch-down and lift-off, y alone moves: an error in the time of the
/// event leaves velocity and time nearly as they are. gamma and d are components of the state, so that a set of states
/// knows how its others depend on them.
///
/// The law's max(0, 1 + d w) is 1 + d w here, for any d >= 0: u = 1 + d w has u' = d gamma - d x^n u in contact, and is
/// 1 + d > 0 at touch-down. With the integral A of d x^n up to a time, u = e^-A (1 + d + the integral of d gamma e^A),
/// which stays positive for gamma >= 0. So the solution without the clamp is one with it, and there is only one.
class BounceFlow {
 public:
  static constexpr int size = 5;
  enum Component : int { root_of_penetration, velocity, time, damping, gravity };

  /// `exponent` is n, 1 or 1.5.
  explicit BounceFlow(double exponent) : exponent_(exponent) {}

  template <class T>
  [[nodiscard]] std::vector<StateVector<T, size>> taylor_coefficients(const StateVector<T, size>& state,
                                                                      std::size_t order) const {
    const T& d = state[damping];
    Series<T> y{state[root_of_penetration]};
    Series<T> w{state[velocity]};
    Series<T> penetration;   // y^2
    Series<T> elastic;       // y^(2n)
    Series<T> damped;        // 1 + d w
    Series<T> acceleration;  // gamma - y^(2n) (1 + d w)
    std::vector<StateVector<T, size>> result{state};
    for (std::size_t k = 0; k < order; ++k) {
      penetration.push_back(k == 0 ? T(square(y[0])) : product_coefficient(y, y, k));
      elastic.push_back(exponent_ == 1.0 ? penetration[k] : product_coefficient(penetration, y, k));
      damped.push_back(k == 0 ? T(T(1) + d * w[0]) : T(d * w[k]));
      acceleration.push_back((k == 0 ? state[gravity] : T(0)) - product_coefficient(elastic, damped, k));
      const T next(Interval(static_cast<int>(k) + 1));
      const T two(2);
      StateVector<T, size> coefficient;
      coefficient[root_of_penetration] = w[k] / next;
      coefficient[velocity] = two * product_coefficient(y, acceleration, k) / next;
      coefficient[time] = two * y[k] / next;
      coefficient[damping] = T(0);
      coefficient[gravity] = T(0);
      y.push_back(coefficient[root_of_penetration]);
      w.push_back(coefficient[velocity]);
      result.push_back(coefficient);
    }
    return result;
  }

  /// w^2/2 + x^(n+1)/(n+1) - gamma x, which the contact never raises: its derivative is -x^n d w^2. At x = 0 it is
  /// w^2/2, so that a body whose energy is negative stays in contact for good.
  [[nodiscard]] Interval energy(const StateBox<size>& state) const {
    const Interval y = max(state[root_of_penetration], Interval(0));  // in contact
    const Interval x = square(y);
    const Interval elastic = exponent_ == 1.0 ? x : x * y;
    return square(state[velocity]) / Interval(2) + x * (elastic / Interval(exponent_ + 1.0) - state[gravity]);
  }

 private:
  double exponent_;
};

}  // namespace verisq::stance
