/// The bounce of a contact cylinder, by verified integration.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include "verify/stance/scalar.hpp"

namespace verisq::stance {

// Coefficients of Taylor series by recurrence: what automatic differentiation of an ordinary differential equation
// needs.

/// The first coefficients of a function's series, so many as are known yet.
template <class T>
using Series = std::vector<T>;

/// Coefficient k of the product of two series. Precondition: both are known up to k.
template <class T>
[[nodiscard]] T product_coefficient(const Series<T>& a, const Series<T>& b, std::size_t k) {
  T sum = a[0] * b[k];
  for (std::size_t i = 1; i <= k; ++i) sum += a[i] * b[k - i];
  return sum;
}

// Verified integration of autonomous ordinary differential equations y' = f(y): Lohner's method, that is, interval
// Taylor series in mean-value form over sets in a basis that turns with the flow, after a-priori enclosures by
// Picard's operator; and guaranteed crossings of coordinate planes.

template <class T, int N>
using StateVector = Eigen::Matrix<T, N, 1>;
template <int N>
using StateBox = StateVector<Interval, N>;
template <int N>
using FlowMatrix = Eigen::Matrix<Interval, N, N>;

/// A system gives the Taylor coefficients 0 ... order of the solution through a state, over intervals and duals:
///   static constexpr int size;
///   template <class T> std::vector<StateVector<T, size>> taylor_coefficients(const StateVector<T, size>& state,
///                                                                            std::size_t order) const;
/// f must be analytic wherever it is evaluated.
template <class System>
concept DifferentialEquation = requires(const System& system, const StateBox<System::size>& box) {
  { system.taylor_coefficients(box, std::size_t{1}) } -> std::same_as<std::vector<StateBox<System::size>>>;
};

namespace integration_details {

[[nodiscard]] inline double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

using stance::intersection;

template <int N>
[[nodiscard]] StateBox<N> intersection(const StateBox<N>& a, const StateBox<N>& b) {
  StateBox<N> result;
  for (int i = 0; i < N; ++i) result[i] = intersection(a[i], b[i]);
  return result;
}

[[nodiscard]] inline bool contains(const Interval& outer, const Interval& inner) {
  return outer.lower() <= inner.lower() && inner.upper() <= outer.upper();
}

template <int N>
[[nodiscard]] bool contains(const StateBox<N>& outer, const StateBox<N>& inner) {
  for (int i = 0; i < N; ++i) {
    if (!contains(outer[i], inner[i])) return false;
  }
  return true;
}

/// A little larger, for components of magnitude about 1: a guess, which Picard's operator has to confirm.
[[nodiscard]] inline Interval inflated(const Interval& a) {
  const double radius = 0.1 * (a.upper() - a.lower()) + 1e-12;
  return a + Interval(-radius, radius);
}

template <int N>
[[nodiscard]] StateBox<N> inflated(const StateBox<N>& box) {
  StateBox<N> result;
  for (int i = 0; i < N; ++i) result[i] = inflated(box[i]);
  return result;
}

/// sum of coefficients[i] t^i, by Horner's rule.
template <class Coefficient>
[[nodiscard]] Coefficient polynomial(const std::vector<Coefficient>& coefficients, const Interval& t) {
  Coefficient sum = coefficients.back();
  for (std::size_t i = coefficients.size() - 1; i-- > 0;) sum = sum * t + coefficients[i];
  return sum;
}

/// Encloses the inverse of a matrix that is orthogonal but for rounding: with C its transpose and R = I - C Q, the
/// inverse is (I - R)^-1 C, within |R| / (1 - |R|) |C| of C in the norm of the greatest row sum.
template <int N>
[[nodiscard]] FlowMatrix<N> inverse_of_nearly_orthogonal(const FlowMatrix<N>& q) {
  const FlowMatrix<N> transposed = q.transpose();
  const FlowMatrix<N> defect = FlowMatrix<N>::Identity() - transposed * q;
  const auto norm = [](const FlowMatrix<N>& m) {
    double greatest = 0.0;
    for (int i = 0; i < N; ++i) {
      Interval sum(0);
      for (int j = 0; j < N; ++j) sum += abs(m(i, j));
      greatest = std::max(greatest, sum.upper());
    }
    return greatest;
  };
  const double defect_norm = norm(defect);
  if (!(defect_norm < 0.5)) throw std::domain_error("verified integration: basis is not orthogonal");
  const double error =
      (Interval(defect_norm) * Interval(norm(transposed)) / (Interval(1) - Interval(defect_norm))).upper();
  FlowMatrix<N> inverse = transposed;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) inverse(i, j) += Interval(-error, error);
  }
  return inverse;
}

/// A nearly orthogonal matrix whose first columns follow the longest edges of the set matrix * deviation.
template <int N>
[[nodiscard]] FlowMatrix<N> aligned_basis(const FlowMatrix<N>& matrix, const StateBox<N>& deviation) {
  Eigen::Matrix<double, N, N> edges;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      edges(i, j) = middle(matrix(i, j)) * (deviation[j].upper() - deviation[j].lower());
    }
  }
  const Eigen::Matrix<double, N, N> q = Eigen::ColPivHouseholderQR<Eigen::Matrix<double, N, N>>(edges).householderQ();
  return q.template cast<Interval>();
}

}  // namespace integration_details

/// All states that are centre + basis * deviation and in `hull`, for some deviation of the box.
template <int N>
struct ReachableSet {
  StateBox<N> hull;
  StateVector<double, N> centre;
  FlowMatrix<N> basis;  ///< of single numbers
  StateBox<N> deviation;

  [[nodiscard]] static ReachableSet of(const StateBox<N>& box) {
    ReachableSet set;
    set.hull = box;
    set.basis = FlowMatrix<N>::Identity();
    for (int i = 0; i < N; ++i) {
      set.centre[i] = integration_details::middle(box[i]);
      set.deviation[i] = box[i] - Interval(set.centre[i]);
    }
    return set;
  }
};

/// One step of the integration: encloses the states at all times from 0 to its length.
template <DifferentialEquation System>
class TaylorStep {
 public:
  static constexpr int size = System::size;
  static constexpr std::size_t order = 14;

  /// Nothing where no a-priori enclosure is found or the remainder of the series exceeds `tolerance`: to be tried
  /// again with a shorter length.
  [[nodiscard]] static std::optional<TaylorStep> attempt(const System& system, const ReachableSet<size>& start,
                                                         double length, double tolerance) {
    const std::optional<StateBox<size>> enclosure = picard_enclosure(system, start.hull, length);
    if (!enclosure) return std::nullopt;
    const StateBox<size> last_coefficient = system.taylor_coefficients(*enclosure, order).back();
    const Interval power = pow(Interval(length), Interval(static_cast<int>(order)));
    for (int i = 0; i < size; ++i) {
      if (!(abs(last_coefficient[i] * power).upper() <= tolerance)) return std::nullopt;
    }
    return TaylorStep(system, start, length, *enclosure, last_coefficient);
  }

  [[nodiscard]] double length() const { return length_; }
  /// Contains the states at all times of the step.
  [[nodiscard]] const StateBox<size>& enclosure() const { return enclosure_; }
  /// Contains y' at all times of the step.
  [[nodiscard]] const StateBox<size>& rate() const { return rate_; }
  [[nodiscard]] const ReachableSet<size>& start() const { return start_; }

  /// Precondition: 0 <= time <= length().
  [[nodiscard]] ReachableSet<size> at(double time) const {
    using namespace integration_details;
    // y(t) = T(y0) + t^p c_p, T(y0) in T(centre) + T'(hull) (y0 - centre): the mean-value form.
    const StateBox<size> moved_centre = polynomial(centre_series_, Interval(time));
    const FlowMatrix<size> jacobian = polynomial(jacobian_series_, Interval(time));
    const FlowMatrix<size> turned = jacobian * start_.basis;

    ReachableSet<size> set;
    set.basis = aligned_basis<size>(turned, start_.deviation);
    for (int i = 0; i < size; ++i) set.centre[i] = middle(moved_centre[i]);
    const StateBox<size> centre = set.centre.template cast<Interval>();
    const FlowMatrix<size> inverse = inverse_of_nearly_orthogonal<size>(set.basis);
    const FlowMatrix<size> into_new_basis = inverse * turned;
    const StateBox<size> rounding = moved_centre - centre;
    set.deviation = into_new_basis * start_.deviation + inverse * rounding;

    const StateBox<size> from_start = start_.hull - start_.centre.template cast<Interval>();
    set.hull = intersection<size>(enclosure_, StateBox<size>(centre + set.basis * set.deviation));
    set.hull = intersection<size>(set.hull, StateBox<size>(moved_centre + turned * start_.deviation));
    set.hull = intersection<size>(set.hull, StateBox<size>(moved_centre + jacobian * from_start));
    return set;
  }

 private:
  using Derivative = Dual<Interval, static_cast<std::size_t>(size)>;

  TaylorStep(const System& system, const ReachableSet<size>& start, double length, const StateBox<size>& enclosure,
             const StateBox<size>& last_coefficient)
      : start_(start),
        length_(length),
        enclosure_(enclosure),
        rate_(system.taylor_coefficients(enclosure, 1)[1]),
        centre_series_(system.taylor_coefficients(StateBox<size>(start.centre.template cast<Interval>()), order - 1)) {
    centre_series_.push_back(last_coefficient);  // Lagrange's remainder, over the whole step
    StateVector<Derivative, size> variables;
    for (int i = 0; i < size; ++i) {
      // The mean-value form needs derivatives on the way from the centre too, which may lie outside the hull.
      variables[i] = Derivative::variable(hull(start.hull[i], Interval(start.centre[i])), static_cast<std::size_t>(i));
    }
    for (const StateVector<Derivative, size>& coefficient : system.taylor_coefficients(variables, order - 1)) {
      FlowMatrix<size> partial;
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) partial(i, j) = coefficient[i].partial[static_cast<std::size_t>(j)];
      }
      jacobian_series_.push_back(partial);
    }
  }

  /// A box B with start + [0, length] f(B) inside B: by Picard and Banach, all solutions stay in B for the whole step.
  [[nodiscard]] static std::optional<StateBox<size>> picard_enclosure(const System& system, const StateBox<size>& start,
                                                                      double length) {
    using namespace integration_details;
    const Interval times(0.0, length);
    const auto picard = [&](const StateBox<size>& box) {
      return StateBox<size>(start + system.taylor_coefficients(box, 1)[1] * times);
    };
    StateBox<size> box = inflated<size>(picard(start));
    for (int attempts = 0; attempts < 8; ++attempts) {
      const StateBox<size> image = picard(box);
      if (contains<size>(box, image)) return intersection<size>(image, picard(image));
      // Those that hold stay: a wider one would widen the images of the others as fast as they grow.
      for (int i = 0; i < size; ++i) {
        if (!contains(box[i], image[i])) box[i] = inflated(hull(box[i], image[i]));
      }
    }
    return std::nullopt;
  }

  ReachableSet<size> start_;
  double length_;
  StateBox<size> enclosure_;
  StateBox<size> rate_;
  std::vector<StateBox<size>> centre_series_;
  std::vector<FlowMatrix<size>> jacobian_series_;
};

/// Whether a component reaches 0 within a step.
enum class Crossing {
  none,     ///< for no state of the set at any time of the step but, perhaps, its beginning
  falling,  ///< from positive to negative for every state of the set, each at one time
  unclear,  ///< for some, perhaps, or at the ends of the step
};

/// Looks for a component that falls through 0.
template <DifferentialEquation System>
[[nodiscard]] Crossing crossing(const TaylorStep<System>& step, const ReachableSet<System::size>& end, int component) {
  const Interval before = step.start().hull[component];
  if (step.enclosure()[component].lower() > 0.0) return Crossing::none;
  if (before.lower() >= 0.0 && step.rate()[component].lower() > 0.0) return Crossing::none;
  const bool falls = step.rate()[component].upper() < 0.0;  // at every time: so there is one zero
  if (falls && before.lower() > 0.0 && end.hull[component].upper() < 0.0) return Crossing::falling;
  return Crossing::unclear;
}

/// Contains the states of all solutions of the set, each at the time of the step at which the component is 0.
/// Precondition: Crossing::falling.
template <DifferentialEquation System>
[[nodiscard]] StateBox<System::size> state_at_crossing(const System& system, const TaylorStep<System>& step,
                                                       int component) {
  using namespace integration_details;
  constexpr int size = System::size;
  Interval times(0.0, step.length());
  StateBox<size> state = step.enclosure();
  // Newton's method in time; by the mean value theorem, the state at the crossing is y(c) + (t - c) y'(somewhere).
  for (int iteration = 0; iteration < 6; ++iteration) {
    const double c = std::clamp(middle(times), 0.0, step.length());
    const StateBox<size> at_c = step.at(c).hull;
    const auto moved = [&](const StateBox<size>& rate) {
      return intersection<size>(step.enclosure(), StateBox<size>(at_c + rate * (times - Interval(c))));
    };
    const StateBox<size> nearby = moved(step.rate());
    const StateBox<size> rate = system.taylor_coefficients(nearby, 1)[1];
    times = intersection(times, Interval(c) - at_c[component] / rate[component]);
    state = moved(rate);
    state[component] = Interval(0);
  }
  return state;
}

// The motion of a body in contact, without units and in coordinates in which it is polynomial.

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

// From touch-down to lift-off or rest on the ground: the contact phase of a bounce, integrated with proofs.

enum class Outcome {
  lifts_off,
  stays,   ///< on the ground for good
  either,  ///< open which of the two: both modes are in the enclosures
  open,    ///< the integration gave up, or was interrupted
};

/// In BounceFlow's units. Every enclosure holds whatever the outcome is.
struct ContactPhase {
  Outcome outcome;
  Interval deepest;   ///< penetration
  Interval lift_off;  ///< time; the upper end is infinite unless it lifts off
  Interval rebound;   ///< speed; 0 for a body that stays
  std::size_t steps;
};

/// For all gravities gamma and damping factors d of the two; `tolerance` is the local error of a step.
/// Precondition: damping within [0, infinity), gravity positive.
[[nodiscard]] ContactPhase contact_phase(const BounceFlow& flow, const Interval& gravity, const Interval& damping,
                                         double tolerance, const std::function<bool()>& interrupted);

}  // namespace verisq::stance
