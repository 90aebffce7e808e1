/// One equilibrium for each parameter of a cell, its ranges by the signs of its derivatives; and where there is none.
#include "verify/stance/equilibrium_cell.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>
#include <verisq/error.hpp>

#include "verify/stance/acceleration_cell.hpp"
#include "verify/stance/contraction.hpp"
#include "verify/stance/standing_equations.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

constexpr std::uint8_t vertical = 1;
constexpr std::size_t turns_of_root = 2;

/// The unknowns are the height of the reference point, then joints. An equilibrium's components are, one after the
/// other, what is missing for the balance (one an unknown, 0 in equilibrium) and penetrations (one a point); then
/// forces (one a cylinder), the centre of pressure's x and z, the root's translation along y, torques (one a joint).
enum class Extent : std::uint8_t { balance, all };

template <class T>
using Components = Eigen::Matrix<T, Eigen::Dynamic, 1>;

template <class T>
StandingPosture<T> posture_of(const StandingProblem& problem, const std::vector<T>& unknowns) {
  StandingPosture<T> posture{unknowns.front(), stance_state<T>(problem.model).position};
  for (std::size_t i = 0; i < problem.joints.size(); ++i) posture.joints[problem.joints[i]] = unknowns[i + 1];
  return posture;
}

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

/// Of each joint, as the proportional gains of the controllers turn it; 0 where none acts.
std::vector<double> stiffness_of_joints(const StandingProblem& problem) {
  if (problem.control == JointControl::held) return {};
  std::vector<std::size_t> first{0};
  for (const Body& body : problem.model.bodies) first.push_back(first.back() + body.joints.size());
  std::vector<double> result(first.back(), 0.0);
  for (const Controller& controller : problem.model.controllers)
    result[first[controller.body] + controller.joint] = controller.proportional;
  return result;
}

template <class T>
Components<T> components(const StandingProblem& problem, const std::vector<T>& parameters,
                         const std::vector<T>& unknowns, Extent extent) {
  const Model& model = problem.model;
  const StandingPosture<T> posture = posture_of(problem, unknowns);
  const bool with_torques = extent == Extent::all || problem.control == JointControl::proportional;
  const StandingTerms<T> terms = standing_terms<T>(model, parameters, posture, problem.reference, with_torques);
  Balance<T> ground;
  for (const PressedPoint<T>& point : terms.points) ground.add(point.force);
  Balance<T> all = ground;
  for (const VerticalForce<T>& weight : terms.weights) all.add(weight);
  all.add(terms.applied);
  std::vector<T> list{all.force, all.moment_z, all.moment_x};
  const std::vector<double> stiffness = stiffness_of_joints(problem);
  const std::vector<T> wanted = stance_state<T>(model).position;
  for (std::size_t i = turns_of_root; i < problem.joints.size(); ++i) {
    const std::size_t joint = problem.joints[i];
    const T error = posture.joints[joint] - wanted[joint];
    list.push_back(terms.torques[joint] + T(stiffness[joint]) * error);
  }
  for (const PressedPoint<T>& point : terms.points) list.push_back(point.penetration);
  if (extent == Extent::all) {
    for (std::size_t c = 0; c < model.cylinders.size(); ++c) {
      T force(0);
      for (std::size_t i = 0; i < points_of_cylinder; ++i)
        force += terms.points[points_of_cylinder * c + i].force.upward;
      list.push_back(force);
    }
    const Vector3<T> offset = values_of<T>(model.bodies.front().offset, parameters);
    list.push_back(offset[0] + T(problem.origin[0]) + terms.reference[0] + ground.moment_z / ground.force);
    list.push_back(offset[2] + T(problem.origin[2]) + terms.reference[2] + ground.moment_x / ground.force);
    list.push_back(terms.root_translation);
    list.insert(list.end(), terms.torques.begin(), terms.torques.end());
  }
  return Eigen::Map<const Components<T>>(list.data(), static_cast<Eigen::Index>(list.size()));
}

template <class T>
std::vector<Dual<T>> constants(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

template <class T>
Components<T> partials(const Components<Dual<T>>& list) {
  return list.unaryExpr([](const Dual<T>& a) { return a.partial[0]; });
}

/// Of all components by one parameter.
IntervalVector by_parameter(const StandingProblem& problem, const Box& parameters,
                            const std::vector<Interval>& unknowns, std::uint32_t parameter) {
  const std::vector<Dual<Interval>> variables = as_variables<1, Interval>(parameters, {parameter});
  return partials<Interval>(components<Dual<Interval>>(problem, variables, constants(unknowns), Extent::all));
}

/// Of all components by all unknowns.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> by_unknowns(const StandingProblem& problem,
                                                             const std::vector<T>& parameters,
                                                             const std::vector<T>& unknowns, Extent extent) {
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

/// In floating point: any point is sound.
std::vector<double> approximate_equilibrium(const StandingProblem& problem, const std::vector<double>& parameters) {
  constexpr int most_steps = 30;
  constexpr double converged = 1e-15;
  std::vector<double> unknowns = problem.start;
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::VectorXd missing = components<double>(problem, parameters, unknowns, Extent::balance).head(size);
    const Eigen::MatrixXd jacobian = by_unknowns<double>(problem, parameters, unknowns, Extent::balance).topRows(size);
    const Eigen::VectorXd change = jacobian.partialPivLu().solve(missing);
    if (!change.allFinite()) break;
    for (Eigen::Index i = 0; i < size; ++i) unknowns[static_cast<std::size_t>(i)] -= change[i];
    if (change.cwiseAbs().maxCoeff() <= converged) break;
  }
  return unknowns;
}

std::vector<Interval> exactly(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

std::vector<Interval> sum(const std::vector<double>& centre, const IntervalVector& errors) {
  std::vector<Interval> result = exactly(centre);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += errors[static_cast<Eigen::Index>(i)];
  return result;
}

/// For every parameter p of a box there is exactly one equilibrium u(p) in the box `alone`, and all lie in `unknowns`.
///
/// With R near the inverse of the Jacobian at the centres, and slopes by the mean value theorem, row by row, first
/// along the parameters at the unknowns' centre u, then along the unknowns,
///
///     e = -R F(u, p_0) - sum of (R dF/dp_k(u, P)) (p_k - p_0k) + (I - R dF/du(u + E, P)) e
///
/// is F(u + e, p) = 0. Derivatives meet R before the deviation does. If the right side maps a symmetric E into its
/// interior, it contracts: one e for each p, in E and its image (Krawczyk 1969; Rump 1983).
struct Located {
  std::vector<double> parameters, centre;  ///< p_0, which is all of a side without width, and u
  Eigen::MatrixXd inverse;                 ///< R
  std::vector<Interval> alone, unknowns;
  IntervalVector values;                  ///< of the components at the centres
  std::vector<IntervalVector> variation;  ///< dG/dp_k(u, P) of the components G
  IntervalVector newton;                  ///< -R F(u, p_0)
  IntervalMatrix rest;                    ///< I - R dF/du
  IntervalMatrix slopes;                  ///< dG/du over the unknowns
  IntervalVector errors;                  ///< unknowns - u
};

std::optional<Located> locate(const StandingProblem& problem, const Box& box) {
  constexpr int most_inflations = 12;
  constexpr int refinements = 3;
  Located at;
  at.parameters = middle_of(box);
  at.centre = approximate_equilibrium(problem, at.parameters);
  const auto size = static_cast<Eigen::Index>(at.centre.size());
  at.inverse =
      by_unknowns<double>(problem, at.parameters, at.centre, Extent::balance).topRows(size).partialPivLu().inverse();
  if (!at.inverse.allFinite()) return std::nullopt;
  const std::vector<Interval> centre = exactly(at.centre);
  at.values = components<Interval>(problem, exactly(at.parameters), centre, Extent::all);
  at.newton = -product(at.inverse, IntervalVector(at.values.head(size)));
  IntervalVector z = at.newton;
  for (const std::uint32_t k : problem.parameters) {
    const bool exact = box[k].lower() == box[k].upper();  // no deviation, which its derivative would meet
    at.variation.push_back(exact ? IntervalVector::Zero(at.values.size()) : by_parameter(problem, box, centre, k));
    if (exact) continue;
    z -= product(at.inverse, IntervalVector(at.variation.back().head(size))) * (box[k] - Interval(at.parameters[k]));
  }
  at.errors = z;
  for (int i = 0; i < most_inflations; ++i) {
    const IntervalVector wide = inflated(at.errors);
    at.alone = sum(at.centre, wide);
    const IntervalMatrix slopes = by_unknowns<Interval>(problem, box, at.alone, Extent::balance).topRows(size);
    at.rest = IntervalMatrix::Identity(size, size) - product(at.inverse, slopes);
    at.errors = z + product(at.rest, wide);
    if (!in_interior(at.errors, wide)) continue;
    for (int k = 0; k < refinements; ++k) at.errors = z + product(at.rest, at.errors);
    at.unknowns = sum(at.centre, at.errors);
    at.slopes = by_unknowns<Interval>(problem, box, at.unknowns, Extent::all);
    return at;
  }
  return std::nullopt;
}

/// All components over the box: G(u, p_0) + sum of (dG/dp_k - dG/du R dF/dp_k) (p_k - p_0k) + dG/du (-R F + rest e).
IntervalVector ranges_by_slopes(const StandingProblem& problem, const Box& box, const Located& at) {
  const auto size = static_cast<Eigen::Index>(at.centre.size());
  IntervalVector result = at.values + product(at.slopes, IntervalVector(at.newton + product(at.rest, at.errors)));
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    const std::uint32_t k = problem.parameters[i];
    const IntervalVector moved = product(at.inverse, IntervalVector(at.variation[i].head(size)));
    result += (at.variation[i] - product(at.slopes, moved)) * (box[k] - Interval(at.parameters[k]));
  }
  return result;
}

Interval intersection(const Interval& a, const Interval& b) {
  return {std::fmax(a.lower(), b.lower()), std::fmin(a.upper(), b.upper())};
}

bool lies_within(const std::vector<Interval>& inner, const std::vector<Interval>& outer) {
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (!(inner[i].lower() >= outer[i].lower() && inner[i].upper() <= outer[i].upper())) return false;
  }
  return true;
}

/// The ranges over a cell: at its ends where the derivative of a component by a parameter has a proven sign.
class RangesOfCell {
 public:
  RangesOfCell(const StandingProblem& problem, const Box& box, const Located& at)
      : problem_(problem), box_(box), alone_(at.alone), whole_(with_unknowns(at, ranges_by_slopes(problem, box, at))) {
    const auto size = static_cast<Eigen::Index>(at.centre.size());
    for (const std::uint32_t k : problem.parameters) {
      const IntervalVector direct = by_parameter(problem, box, at.unknowns, k);
      const std::optional<IntervalVector> moved =
          fixed_points(-product(at.inverse, IntervalVector(direct.head(size))), at.rest);
      const IntervalVector unproven = IntervalVector::Constant(whole_.size(), Interval(-infinity, infinity));
      if (!moved) {
        derivatives_.push_back(unproven);
        continue;
      }
      IntervalVector all(whole_.size());
      all << *moved, IntervalVector(direct + product(at.slopes, *moved)).tail(whole_.size() - size);
      derivatives_.push_back(all);
    }
  }

  /// Unknowns in place of what is missing.
  [[nodiscard]] IntervalVector operator()() {
    IntervalVector result = whole_;
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      result[i] = intersection(result[i], Interval(at_end(i, false).lower(), at_end(i, true).upper()));
    }
    return result;
  }

  /// By parameter: of each component.
  [[nodiscard]] std::vector<Eigen::VectorXd> unclear() const {
    std::vector<Eigen::VectorXd> result;
    for (std::size_t k = 0; k < derivatives_.size(); ++k) {
      const Interval& side = box_[problem_.parameters[k]];
      const double width = side.upper() - side.lower();
      result.emplace_back(derivatives_[k].unaryExpr([&](const Interval& derivative) {
        return width * std::fmax(0.0, std::fmin(-derivative.lower(), derivative.upper()));
      }));
    }
    return result;
  }

 private:
  /// For each parameter: its lower end (-1), its upper end (1), or its range.
  using Ends = std::vector<int>;

  static IntervalVector with_unknowns(const Located& at, IntervalVector ranges) {
    for (std::size_t i = 0; i < at.unknowns.size(); ++i) ranges[static_cast<Eigen::Index>(i)] = at.unknowns[i];
    return ranges;
  }

  /// Component i where it is largest or smallest.
  Interval at_end(Eigen::Index i, bool largest) {
    Ends ends;
    for (const IntervalVector& derivative : derivatives_) {
      const int sign = derivative[i].lower() >= 0.0 ? 1 : (derivative[i].upper() <= 0.0 ? -1 : 0);
      ends.push_back(largest ? sign : -sign);
    }
    return ranges_at(ends)[i];
  }

  const IntervalVector& ranges_at(const Ends& ends) {
    if (std::ranges::count(ends, 0) == std::ssize(ends)) return whole_;
    const auto known = known_.find(ends);
    if (known != known_.end()) return known->second;
    Box part = box_;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      Interval& side = part[problem_.parameters[i]];
      if (ends[i] < 0) side = Interval(side.lower());
      if (ends[i] > 0) side = Interval(side.upper());
    }
    // What is located there must be the equilibrium that is located here: where it lies in a box that has but one.
    // Otherwise the whole cell's ranges hold.
    const std::optional<Located> at = locate(problem_, part);
    const bool same = at && lies_within(at->unknowns, alone_);
    return known_.emplace(ends, same ? with_unknowns(*at, ranges_by_slopes(problem_, part, *at)) : whole_)
        .first->second;
  }

  const StandingProblem& problem_;
  const Box& box_;
  std::vector<Interval> alone_;
  IntervalVector whole_;
  std::vector<IntervalVector> derivatives_;
  std::map<Ends, IntervalVector> known_;
};

/// Branch and prune over postures near the file's: whether none but those in `known`, which do not count, is an
/// equilibrium that presses with all points, for any parameter of the box.
class OtherEquilibria {
 public:
  OtherEquilibria(const StandingProblem& problem, const Box& box, std::vector<Interval> known)
      : problem_(problem), box_(box), parameters_(middle_of(box)), known_(std::move(known)) {}

  [[nodiscard]] bool none() const {
    constexpr std::size_t most_boxes = 4000;
    std::vector<std::vector<Interval>> open{whole()};
    for (std::size_t looked = 0; !open.empty(); ++looked) {
      if (looked == most_boxes) return false;
      std::vector<Interval> part = std::move(open.back());
      open.pop_back();
      const auto left = pruned(part);
      if (!left || lies_within(*left, known_)) continue;
      if (share(*left) < 0.5 * share(part)) {
        open.push_back(*left);
        continue;
      }
      for (std::vector<Interval>& half : halves(*left)) open.push_back(std::move(half));
    }
    return true;
  }

 private:
  static std::array<double, 1 + turns_of_root> reach() {
    return {equilibrium_reach_of_height, equilibrium_reach_of_tilt, equilibrium_reach_of_tilt};
  }

  [[nodiscard]] std::vector<Interval> whole() const {
    std::vector<Interval> result;
    for (std::size_t i = 0; i < problem_.start.size(); ++i)
      result.push_back(Interval(problem_.start[i]) + Interval(-reach()[i], reach()[i]));
    return result;
  }

  /// Of the whole, about.
  [[nodiscard]] double share(const std::vector<Interval>& part) const {
    double product = 1.0;
    for (const Interval& side : part) product *= side.upper() - side.lower();
    return product;
  }

  [[nodiscard]] std::array<std::vector<Interval>, 2> halves(const std::vector<Interval>& part) const {
    const auto sides = reach();
    std::size_t widest = 0;
    double most = 0.0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const double width = (part[i].upper() - part[i].lower()) / sides[i];
      if (width > most) {
        most = width;
        widest = i;
      }
    }
    const Interval& side = part[widest];
    const double middle = 0.5 * side.lower() + 0.5 * side.upper();
    std::array<std::vector<Interval>, 2> result{part, part};
    result[0][widest] = Interval(side.lower(), middle);
    result[1][widest] = Interval(middle, side.upper());
    return result;
  }

  /// Nothing where no posture of the part is such an equilibrium, else a part of it that holds all that are.
  [[nodiscard]] std::optional<std::vector<Interval>> pruned(const std::vector<Interval>& part) const {
    const auto size = static_cast<Eigen::Index>(part.size());
    const StandingRanges ranges = named(problem_, components<Interval>(problem_, box_, part, Extent::all));
    for (const Interval& penetration : ranges.penetrations) {
      if (penetration.upper() < 0.0) return std::nullopt;
    }
    std::vector<double> centre = middle_of(part);
    const Eigen::MatrixXd inverse =
        by_unknowns<double>(problem_, parameters_, centre, Extent::balance).topRows(size).partialPivLu().inverse();
    if (!inverse.allFinite()) return part;
    // As in Located, but for parts that need not hold an equilibrium.
    IntervalVector image = -product(
        inverse,
        IntervalVector(
            components<Interval>(problem_, exactly(parameters_), exactly(centre), Extent::balance).head(size)));
    for (const std::uint32_t k : problem_.parameters) {
      const IntervalVector variation = by_parameter(problem_, box_, exactly(centre), k).head(size);
      image -= product(inverse, variation) * (box_[k] - Interval(parameters_[k]));
    }
    IntervalVector errors(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto n = static_cast<std::size_t>(i);
      errors[i] = part[n] - Interval(centre[n]);
    }
    const IntervalMatrix slopes = by_unknowns<Interval>(problem_, box_, part, Extent::balance).topRows(size);
    image += product(IntervalMatrix(IntervalMatrix::Identity(size, size) - product(inverse, slopes)), errors);
    std::vector<Interval> left;
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const Interval moved = image[i] + Interval(centre[n]);
      if (moved.upper() < part[n].lower() || moved.lower() > part[n].upper()) return std::nullopt;
      left.push_back(intersection(moved, part[n]));
    }
    return left;
  }

  const StandingProblem& problem_;
  const Box& box_;
  std::vector<double> parameters_;
  std::vector<Interval> known_;
};

CellVerdict verdict_of(const StandingProblem& problem, const Box& box) {
  const std::optional<Located> at = locate(problem, box);
  if (!at) return {};
  RangesOfCell ranges(problem, box, *at);
  const IntervalVector components = ranges();
  const std::vector<Interval> penetrations = named(problem, components).penetrations;
  const auto pressed = [](const Interval& penetration) { return penetration.lower() > 0.0; };
  const auto lifted = [](const Interval& penetration) { return penetration.upper() < 0.0; };
  if (std::ranges::all_of(penetrations, pressed)) return {StandingVerdict::stands, components, ranges.unclear()};
  if (problem.control == JointControl::held && std::ranges::any_of(penetrations, lifted) &&
      OtherEquilibria(problem, box, at->alone).none()) {
    return {.verdict = StandingVerdict::not_on_all};
  }
  return {};
}

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

void require_stand(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

void check_model(const Model& model) {
  require_stand(!model.cylinders.empty(), "equilibrium: the model has no cylinder to stand on");
  const std::vector<Joint>& joints = model.bodies.front().joints;
  std::array<int, 3> turns{};
  int heights = 0;
  bool turned = false;
  for (const Joint& joint : joints) {
    if (joint.kind == JointKind::rotation) ++turns[joint.axis];
    if (joint.kind == JointKind::translation && joint.axis == vertical) ++heights;
    require_stand(joint.kind == JointKind::rotation || !turned,
                  fmt::format("equilibrium: the root's joint {} is a translation after a rotation", joint.name));
    turned = turned || joint.kind == JointKind::rotation;
  }
  require_stand(heights == 1 && turns[0] == 1 && turns[2] == 1,
                "equilibrium: the root needs one translation along y and one rotation about each of x and z");
  for (const int k : {0, 2}) {
    const Quantity& force = model.applied.force[static_cast<std::size_t>(k)];
    require_stand(force.nominal == 0.0 && force.range == Enclosure{0.0, 0.0},
                  fmt::format("equilibrium: the applied force has a part along {}, which friction alone could hold: "
                              "it must be 0",
                              k == 0 ? "x" : "z"));
  }
  for (const Controller& controller : model.controllers)
    require_stand(controller.body != 0, "equilibrium: the root has a controller, and nothing to push against");
}

}  // namespace

StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain) {
  check_model(model);
  StandingProblem problem{.model = model, .control = control, .parameters = {uncertain.begin(), uncertain.end()}};
  const std::vector<Joint>& root = model.bodies.front().joints;
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (root[i].kind == JointKind::rotation && root[i].axis != vertical) problem.joints.push_back(i);
    if (root[i].kind == JointKind::translation) problem.origin[root[i].axis] += root[i].position;
  }
  if (control == JointControl::proportional) {
    for (std::size_t i = root.size(); i < model.degrees_of_freedom(); ++i) problem.joints.push_back(i);
  }
  const std::vector<double> file = stance_state<double>(model).position;
  problem.reference = mean_point_of_contact(model, file);
  const StandingTerms<double> terms =
      standing_terms<double>(model, nominal_parameters<double>(model), {0.0, file}, problem.reference, false);
  problem.start.push_back(problem.origin[vertical] - terms.root_translation);
  for (const std::size_t joint : problem.joints) problem.start.push_back(file[joint]);
  return problem;
}

StandingRanges named(const StandingProblem& problem, const IntervalVector& components) {
  StandingRanges result;
  Eigen::Index next = 0;
  const auto take = [&](std::vector<Interval>& part, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) part.push_back(components[next++]);
  };
  take(result.unknowns, problem.start.size());
  take(result.penetrations, points_of_cylinder * problem.model.cylinders.size());
  take(result.forces, problem.model.cylinders.size());
  result.pressure_x = components[next++];
  result.pressure_z = components[next++];
  result.root_translation = components[next++];
  take(result.torques, problem.model.degrees_of_freedom());
  return result;
}

std::optional<Eigen::VectorXd> sampled_equilibrium(const StandingProblem& problem,
                                                   const std::vector<double>& parameters) {
  const std::vector<double> unknowns = approximate_equilibrium(problem, parameters);
  Eigen::VectorXd sample = components<double>(problem, parameters, unknowns, Extent::all);
  const auto first = static_cast<Eigen::Index>(unknowns.size());
  const auto points = static_cast<Eigen::Index>(points_of_cylinder * problem.model.cylinders.size());
  if (!sample.allFinite() || sample.segment(first, points).minCoeff() <= 0.0) return std::nullopt;
  for (std::size_t i = 0; i < unknowns.size(); ++i) sample[static_cast<Eigen::Index>(i)] = unknowns[i];
  return sample;
}

CellVerdict examine(const StandingProblem& problem, const Box& parameters) {
  try {
    return verdict_of(problem, parameters);
  } catch (const std::domain_error&) {  // numbers beyond binary64, or a cylinder that stands upright
    return {};
  }
}

}  // namespace verisq::stance
