/// Boxes of parameters, divided, and where equilibria lie in them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <iterator>
#include <optional>
#include <span>
#include <thread>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/proof/equilibrium_checker.hpp"
#include "verify/stance/linear_systems.hpp"
#include "verify/stance/standing.hpp"

namespace verisq::stance {

// Ranges over boxes of parameters: division, mean value form, samples.

// Boxes of parameters and their divisions: what analyses by bisection share.

/// An interval for each parameter of a model.
using Box = std::vector<verify::Interval>;

/// A number of the interval, near its middle.
[[nodiscard]] inline double middle_of(const verify::Interval& side) {
  return std::clamp(0.5 * side.lower() + 0.5 * side.upper(), side.lower(), side.upper());
}

/// A point of the box, near its middle.
[[nodiscard]] inline std::vector<double> middle_of(const Box& box) {
  std::vector<double> middle;
  middle.reserve(box.size());
  for (const verify::Interval& side : box) middle.push_back(middle_of(side));
  return middle;
}

/// Corners of the box's sides `variables`, where extremes of nearly monotone functions lie; the middle of all other
/// sides, and of the variables from the ninth on.
[[nodiscard]] inline std::vector<std::vector<double>> corners_of(const Box& box,
                                                                 std::span<const std::uint32_t> variables) {
  constexpr std::size_t most_variables = 8;
  const std::size_t count = std::min(variables.size(), most_variables);
  std::vector<std::vector<double>> corners(std::size_t{1} << count, middle_of(box));
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    for (std::size_t k = 0; k < count; ++k) {
      const verify::Interval& side = box[variables[k]];
      corners[corner][variables[k]] = ((corner >> k) & 1U) != 0 ? side.upper() : side.lower();
    }
  }
  return corners;
}

/// A part of a box that was bisected.
struct BoxPart {
  Box box;
  std::vector<std::uint32_t> halvings;  ///< of each variable

  static BoxPart whole(const Box& box, std::size_t variables) {
    return {box, std::vector<std::uint32_t>(variables, 0)};
  }

  /// Of the whole: a power of 2, exact.
  [[nodiscard]] double share() const {
    double share = 1.0;
    for (const std::uint32_t count : halvings) share = std::ldexp(share, -static_cast<int>(count));
    return share;
  }
};

/// The bisections of a box along some of its sides, each to a finest part.
class BoxDivision {
 public:
  /// Precondition: `finest` > 0, the number of parts of a side, rounded up to a power of 2.
  BoxDivision(std::span<const std::uint32_t> variables, std::uint32_t finest)
      : variables_(variables.begin(), variables.end()),
        most_halvings_(static_cast<std::uint32_t>(std::bit_width(finest - 1))) {}

  [[nodiscard]] bool is_divisible(const BoxPart& part, std::size_t variable) const {
    const verify::Interval& side = part.box[variables_[variable]];
    const double middle = middle_of(side);
    return part.halvings[variable] < most_halvings_ && side.lower() < middle && middle < side.upper();
  }

  /// The variable that has been halved least; none where all are as fine as they may be.
  [[nodiscard]] std::optional<std::size_t> least_halved(const BoxPart& part) const {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < part.halvings.size(); ++k) {
      if (is_divisible(part, k) && (!best || part.halvings[k] < part.halvings[*best])) best = k;
    }
    return best;
  }

  [[nodiscard]] std::array<BoxPart, 2> halves(const BoxPart& part, std::size_t variable) const {
    const std::uint32_t i = variables_[variable];
    const verify::Interval side = part.box[i];
    std::array<BoxPart, 2> halves{part, part};
    halves[0].box[i] = verify::Interval(side.lower(), middle_of(side));
    halves[1].box[i] = verify::Interval(middle_of(side), side.upper());
    for (BoxPart& half : halves) ++half.halvings[variable];
    return halves;
  }

 private:
  std::vector<std::uint32_t> variables_;
  std::uint32_t most_halvings_;
};

/// The sum of the shares of some parts, rounded, which must not hide that there are others.
[[nodiscard]] inline double share_beside_others(double share, bool others) {
  return others ? std::fmin(share, std::nextafter(1.0, 0.0)) : share;
}

/// Takes the first items: so many as keep all cores busy between two reports of progress.
template <class Item>
[[nodiscard]] std::vector<Item> take_batch(std::deque<Item>& items) {
  constexpr std::size_t most = 16;
  const auto end = items.begin() + static_cast<std::ptrdiff_t>(std::min(most, items.size()));
  std::vector<Item> batch(std::make_move_iterator(items.begin()), std::make_move_iterator(end));
  items.erase(items.begin(), end);
  return batch;
}

/// Calls examine(item) for each item, on all cores: each by itself, so that the result does not depend on their number.
template <class Item, class Examine>
void examine_on_all_cores(std::vector<Item>& items, const Examine& examine) {
  if (items.empty()) return;
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, items.size());
  std::vector<std::jthread> workers;
  for (std::size_t first = 0; first < threads; ++first) {
    workers.emplace_back([&items, &examine, first, threads] {
      for (std::size_t i = first; i < items.size(); i += threads) examine(items[i]);
    });
  }
}

// Ranges of differentiable functions over boxes, by mean-value forms and bisection: exact up to rounding where the
// derivatives have proven signs (docs/stance.md §5).

/// Enclosures of a function and its partial derivatives over boxes.
struct DifferentiableFunction {
  std::function<verify::Interval(std::span<const verify::Interval> box)> value;
  std::function<verify::Interval(std::span<const verify::Interval> box, std::uint32_t variable)> partial;
};

/// Contains all values over the box; `variables` are the box's coordinates that are not points.
[[nodiscard]] Enclosure range(const DifferentiableFunction& function, const Box& box,
                              std::span<const std::uint32_t> variables);

// The hull of samples, which only decides where to bisect: its rounding errors make no enclosure wrong.

class SampledHull {
 public:
  void add(const std::optional<Eigen::VectorXd>& sample) {
    if (!sample) return;
    lowest_ = is_empty() ? *sample : lowest_.cwiseMin(*sample);
    highest_ = is_empty() ? *sample : highest_.cwiseMax(*sample);
  }

  [[nodiscard]] bool is_empty() const { return highest_.size() == 0; }

  // Preconditions of the following: the hull is not empty.

  [[nodiscard]] double lowest(Eigen::Index component) const { return lowest_[component]; }
  [[nodiscard]] double highest(Eigen::Index component) const { return highest_[component]; }
  [[nodiscard]] double width(Eigen::Index component) const { return highest_[component] - lowest_[component]; }
  [[nodiscard]] double largest_magnitude() const {
    return std::fmax(lowest_.cwiseAbs().maxCoeff(), highest_.cwiseAbs().maxCoeff());
  }

  /// How far an enclosure of the component sticks out.
  [[nodiscard]] double excess(Eigen::Index component, const verify::Interval& enclosure) const {
    return std::fmax(enclosure.upper() - highest_[component], lowest_[component] - enclosure.lower());
  }

 private:
  Eigen::VectorXd lowest_, highest_;
};

// Where equilibria are.

// What an equilibrium consists of as functions of its posture and the parameters, and their derivatives, over any
// scalar (docs/stance.md §7).

/// The unknowns are the height of the reference point, then joints. An equilibrium's components are, one after the
/// other, what is missing for the balance (one an unknown, 0 in equilibrium) and penetrations (one a point); then
/// forces (one a cylinder), the centre of pressure's x and z, the root's translation along y, torques (one a joint).
enum class Extent : std::uint8_t { balance, all };

template <class T>
using Components = Eigen::Matrix<T, Eigen::Dynamic, 1>;

template <class T>
[[nodiscard]] StandingPosture<T> posture_of(const StandingProblem& problem, const std::vector<T>& unknowns) {
  StandingPosture<T> posture{unknowns.front(), {problem.positions.begin(), problem.positions.end()}};
  for (std::size_t i = 0; i < problem.joints.size(); ++i) posture.joints[problem.joints[i]] = unknowns[i + 1];
  return posture;
}

namespace components_details {

constexpr std::size_t turns_of_root = 2;

/// Forces upward, and moments about the reference point about z and -x.
template <class T>
struct Balance {
  T force = T(0);
  T moment_z = T(0);
  T moment_x = T(0);

  void add(const VerticalForce<T>& acting) {
    force += acting.upward;
    moment_z += acting.upward * acting.place[0];
    moment_x += acting.upward * acting.place[2];
  }
};

/// In the world, by the file's translations.
template <class T>
[[nodiscard]] Vector3<T> origin_of_root(const StandingProblem& problem, const std::vector<T>& parameters) {
  const Body& root = problem.model.bodies.front();
  Vector3<T> origin = values_of<T>(root.offset, parameters);
  for (std::size_t j = 0; j < root.joints.size(); ++j) {
    if (root.joints[j].kind == JointKind::translation) origin[root.joints[j].axis] += T(problem.positions[j]);
  }
  return origin;
}

template <class T>
[[nodiscard]] std::vector<Dual<T>> constants(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

template <class T>
[[nodiscard]] Components<T> partials(const Components<Dual<T>>& list) {
  return list.unaryExpr([](const Dual<T>& a) { return a.partial[0]; });
}

}  // namespace components_details

template <class T>
[[nodiscard]] Components<T> components(const StandingProblem& problem, const std::vector<T>& parameters,
                                       const std::vector<T>& unknowns, Extent extent) {
  using namespace components_details;
  const Model& model = problem.model;
  const StandingPosture<T> posture = posture_of(problem, unknowns);
  const bool with_torques = extent == Extent::all || problem.control == JointControl::proportional;
  const StandingTerms<T> terms = standing_terms<T>(model, parameters, posture, problem.reference, with_torques);
  Balance<T> carried;
  for (const VerticalForce<T>& weight : terms.weights) carried.add(weight);
  carried.add(terms.applied);
  Balance<T> all = carried;
  for (const PressedPoint<T>& point : terms.points) all.add(point.force);
  std::vector<T> list{all.force, all.moment_z, all.moment_x};
  for (std::size_t i = turns_of_root; i < problem.joints.size(); ++i) {
    const std::size_t joint = problem.joints[i];
    const T error = posture.joints[joint] - T(problem.positions[joint]);
    list.push_back(terms.torques[joint] + T(problem.stiffness[joint]) * error);
  }
  for (const PressedPoint<T>& point : terms.points) list.push_back(point.penetration);
  if (extent == Extent::all) {
    for (std::size_t c = 0; c < model.cylinders.size(); ++c) {
      T force(0);
      for (std::size_t i = 0; i < points_of_cylinder; ++i)
        force += terms.points[points_of_cylinder * c + i].force.upward;
      list.push_back(force);
    }
    // In equilibrium the ground's forces and moments are those that it carries, which stiffness has no part in.
    const Vector3<T> origin = origin_of_root(problem, parameters);
    list.push_back(origin[0] + terms.reference[0] + carried.moment_z / carried.force);
    list.push_back(origin[2] + terms.reference[2] + carried.moment_x / carried.force);
    list.push_back(terms.root_translation);
    list.insert(list.end(), terms.torques.begin(), terms.torques.end());
  }
  return Eigen::Map<const Components<T>>(list.data(), static_cast<Eigen::Index>(list.size()));
}

/// Of all components by one parameter.
[[nodiscard]] inline IntervalVector by_parameter(const StandingProblem& problem, const Box& parameters,
                                                 const std::vector<Interval>& unknowns, std::uint32_t parameter) {
  using namespace components_details;
  const std::vector<Dual<Interval>> variables = as_variables<1, Interval>(parameters, {parameter});
  return partials<Interval>(components<Dual<Interval>>(problem, variables, constants(unknowns), Extent::all));
}

/// Of all components by all unknowns.
template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> by_unknowns(const StandingProblem& problem,
                                                                           const std::vector<T>& parameters,
                                                                           const std::vector<T>& unknowns,
                                                                           Extent extent) {
  using namespace components_details;
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> result;
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    std::vector<Dual<T>> variables = constants(unknowns);
    variables[j].partial[0] = T(1);
    const Components<T> column = partials<T>(components<Dual<T>>(problem, constants(parameters), variables, extent));
    if (j == 0) result.resize(column.size(), static_cast<Eigen::Index>(unknowns.size()));
    result.col(static_cast<Eigen::Index>(j)) = column;
  }
  return result;
}

// Where an equilibrium is, for every parameter of a box, by Krawczyk's operator (docs/stance.md §7).

/// The components G, of which the first are F, what is missing for the balance, about parameters p_0 and a posture u:
/// row by row by the mean value theorem, first along the parameters P at u, then along the posture. With R near the
/// inverse of dF/du, every equilibrium u + e at a p of the box, e within E, has
///
///     e = -R F(u, p_0) - sum of (R dF/dp_k(u, P)) (p_k - p_0k) + (I - R dF/du(u + E, P)) e.
///
/// Derivatives meet R before the deviation does.
struct BalanceExpansion {
  std::vector<double> parameters, posture;     ///< p_0, which is all of a side without width, and u
  Eigen::MatrixXd inverse = {};                ///< R
  IntervalVector values = {};                  ///< G(u, p_0)
  std::vector<IntervalVector> variation = {};  ///< dG/dp_k(u, P)
  IntervalVector newton = {};                  ///< -R F(u, p_0)
  IntervalVector constant = {};                ///< what does not depend on e

  /// Nothing where dF/du is singular at the centres.
  [[nodiscard]] static std::optional<BalanceExpansion> about(const StandingProblem& problem, const Box& box,
                                                             std::vector<double> parameters,
                                                             std::vector<double> posture);

  /// I - R dF/du over `unknowns`.
  [[nodiscard]] IntervalMatrix rest(const StandingProblem& problem, const Box& box,
                                    const std::vector<verify::Interval>& unknowns) const;
};

/// For every parameter p of a box there is exactly one equilibrium u(p) in the box `alone`, and all lie in `unknowns`:
/// the expansion's right side maps a symmetric E into its interior, and contracts (Krawczyk 1969; Rump 1983).
struct Located {
  BalanceExpansion expansion;
  std::vector<verify::Interval> alone = {}, unknowns = {};
  IntervalMatrix rest = {};    ///< over `alone`
  IntervalMatrix slopes = {};  ///< dG/du over the unknowns
  IntervalVector errors = {};  ///< unknowns - u

  /// The components over the box: G(u, p_0) + sum of (dG/dp_k - dG/du R dF/dp_k) (p_k - p_0k) + dG/du (-R F + rest e).
  [[nodiscard]] IntervalVector ranges(const StandingProblem& problem, const Box& box) const;

  /// du/dp_k over the box; nothing where the contraction does not show.
  [[nodiscard]] std::optional<IntervalVector> posture_by(const StandingProblem& problem, const Box& box,
                                                         std::uint32_t parameter) const;
};

[[nodiscard]] std::optional<Located> locate(const StandingProblem& problem, const Box& box);

/// The equilibrium as a function of the parameters of a box.
struct EquilibriumFunction {
  std::vector<double> parameters;             ///< p_0
  std::vector<verify::Interval> at_centre;    ///< u(p_0)
  std::vector<verify::Interval> range;        ///< u over the box
  std::vector<IntervalVector> by_parameters;  ///< du/dp_k over the box
};

/// Nothing where it is not proven that there is one for each parameter, in which all cylinders press.
[[nodiscard]] std::optional<EquilibriumFunction> equilibrium_function(const StandingProblem& problem, const Box& box);

/// In plain floating point, by Newton's method from the file's posture.
[[nodiscard]] std::vector<double> approximate_equilibrium(const StandingProblem& problem,
                                                          const std::vector<double>& parameters);

[[nodiscard]] bool lies_within(const std::vector<verify::Interval>& inner, const std::vector<verify::Interval>& outer);

// Equilibria for boxes of parameters.

/// A part of an equilibrium's components, by name.
[[nodiscard]] verify::EquilibriumRanges<verify::Interval> named(const StandingProblem& problem,
                                                                const IntervalVector& components);

struct CellVerdict {
  StandingVerdict verdict = StandingVerdict::open;
  IntervalVector components = {};  ///< ranges of what an equilibrium consists of, where it stands
  /// Then, by uncertain parameter: how much of each range's width is there because the sign of its derivative is open.
  std::vector<Eigen::VectorXd> unclear = {};
};

/// `parameters` has an interval for each parameter of the model.
[[nodiscard]] CellVerdict examine(const StandingProblem& problem, const Box& parameters);

/// The components at one sample, in plain floating point; nothing where it does not stand on all cylinders.
[[nodiscard]] std::optional<Eigen::VectorXd> sampled_equilibrium(const StandingProblem& problem,
                                                                 const std::vector<double>& parameters);

}  // namespace verisq::stance
