/// This file implements standing.hpp.
#include "verify/stance/standing.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include "verify/numbers/functions.hpp"
#include "verify/proof/equilibrium_checker.hpp"

namespace verisq::stance {

namespace {

/// As e tends to 1, f near its root shrinks as D^3: next to the root by a rounding error of D, to 2^-212 for
/// e = 1 - 2^-53, while its terms are about 2^-53.
using Digits = verify::MpfrNumber<319>;
using DampingInterval = verify::BasicInterval<Digits>;

enum class Side { below_root, above_root, unknown };

/// Precondition: damping > 0, 0 < restitution < 1.
Side side_of_root(double damping, double restitution) {
  const DampingInterval d{Digits(damping)};
  const DampingInterval e{Digits(restitution)};
  const DampingInterval one(1);
  const DampingInterval product = d * e;  // exact: 106 of 319 bits
  if (product.lower() >= one.lower()) return Side::above_root;
  if ((e + product).upper() <= one.upper()) return Side::below_root;
  const DampingInterval f = log1p(d) - log1p(-product) - d * (one + e);
  if (f.lower() > Digits(0)) return Side::above_root;
  if (f.upper() < Digits(0)) return Side::below_root;
  return Side::unknown;
}

/// Adjacent numbers between which `holds` changes from true to false. The search trusts its two ends.
template <class Predicate>
double last_that_holds(double last, double first_that_fails, const Predicate& holds) {
  for (;;) {
    const double middle = last + 0.5 * (first_that_fails - last);
    if (middle == last || middle == first_that_fails) return last;
    (holds(middle) ? last : first_that_fails) = middle;
  }
}

/// For one number e. An unknown side stops neither end, as it would a common bisection.
Interval root(double restitution) {
  if (restitution == 1.0) return 0;
  const Interval pole = Interval(1) / Interval(restitution);
  const double below = std::max(0.0, (pole - Interval(1)).lower());
  const double above = pole.upper();
  if (above > std::numeric_limits<double>::max()) return {below, above};
  const auto on = [&](Side side) { return [=](double damping) { return side_of_root(damping, restitution) == side; }; };
  return {last_that_holds(below, above, on(Side::below_root)), last_that_holds(above, below, on(Side::above_root))};
}

}  // namespace

Interval damping_factor(const Interval& restitution) {
  if (!(restitution.lower() > 0.0 && restitution.upper() <= 1.0)) {
    throw std::domain_error("contact damping: restitution outside (0, 1]");
  }
  return {root(restitution.upper()).lower(), root(restitution.lower()).upper()};
}

double damping_factor(double restitution) {
  return damping_factor(Interval(restitution)).lower();
}

Interval damping_slopes(const Interval& restitution) {
  constexpr int parts = 16;
  const double width = restitution.upper() - restitution.lower();
  if (!(width > 0.0)) return damping_slope(restitution, damping_factor(restitution));
  // Roundings are monotone: so are the parts' ends, and the parts leave no gap.
  const auto end = [&](int i) {
    return i == parts ? restitution.upper()
                      : std::min(restitution.upper(), restitution.lower() + width * (static_cast<double>(i) / parts));
  };
  Interval left = damping_factor(Interval(restitution.lower()));
  std::optional<Interval> slopes;
  for (int i = 0; i < parts; ++i) {
    const Interval right = damping_factor(Interval(end(i + 1)));
    const Interval slope = damping_slope(Interval(end(i), end(i + 1)), Interval(right.lower(), left.upper()));
    slopes = slopes ? hull(*slopes, slope) : slope;
    left = right;
  }
  return *slopes;
}

namespace {

/// In the root's frame.
std::array<double, 3> mean_point_of_contact(const Model& model, const std::vector<double>& joints) {
  const StandingTerms<double> terms =
      standing_terms<double>(model, nominal_parameters<double>(model), {0.0, joints}, {}, false);
  Vector3<double> sum = zero_vector<double>();
  for (const PressedPoint<double>& point : terms.points) sum += point.force.place;
  const Vector3<double> in_root = standing_details::orientation_of_root(model, joints).transpose() * sum;
  const auto count = static_cast<double>(terms.points.size());
  return {in_root[0] / count, in_root[1] / count, in_root[2] / count};
}

}  // namespace

StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain) {
  require_standing_model(model);
  StandingProblem problem{.model = model,
                          .control = control,
                          .parameters = {uncertain.begin(), uncertain.end()},
                          .positions = stance_state<double>(model).position,
                          .stiffness = stiffness_of_joints(model)};
  const double height = model.bodies.front().joints[height_of_root(model)].position;
  problem.joints = sought_joints(model, control);
  problem.reference = mean_point_of_contact(model, problem.positions);
  const StandingTerms<double> terms = standing_terms<double>(model, nominal_parameters<double>(model),
                                                             {0.0, problem.positions}, problem.reference, false);
  problem.start.push_back(height - terms.root_translation);
  for (const std::size_t joint : problem.joints) problem.start.push_back(problem.positions[joint]);
  return problem;
}

}  // namespace verisq::stance
