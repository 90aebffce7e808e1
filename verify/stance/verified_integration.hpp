/// Verified integration of autonomous ordinary differential equations y' = f(y): Lohner's method, that is, interval
/// Taylor series in mean-value form over sets in a basis that turns with the flow, after a-priori enclosures by
/// Picard's operator; and guaranteed crossings of coordinate planes.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <vector>

#include "verify/stance/dual.hpp"
#include "verify/stance/scalar.hpp"

namespace verisq::stance {

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

}  // namespace verisq::stance
