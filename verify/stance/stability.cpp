/// Stability of equilibria.
#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "verify/proof/equilibrium_checker.hpp"
#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/linear_systems.hpp"
#include "verify/stance/reduced_motion.hpp"
#include "verify/stance/standing.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {
namespace {

struct StabilityOfCell {
  StabilityVerdict verdict = StabilityVerdict::open;
  Enclosure growth{-infinity, infinity};           ///< the greatest real part of an eigenvalue, 1/s
  std::vector<EigenvalueEnclosure> eigenvalues{};  ///< all of them, rightmost first; none where it is open
  /// Where it is open: how much each uncertain parameter adds to that, as far as is known.
  std::vector<double> shares{};
};

using verify::Interval;

/// E x' = A x for x = (joints' positions, their rates, integrals of controlled positions).
template <class T>
struct LinearMotion {
  DynamicMatrix<T> inertia;  ///< E
  DynamicMatrix<T> flow;     ///< A
};

template <class T>
LinearMotion<T> linear_motion(const StandingProblem& problem, const std::vector<T>& parameters,
                              const std::vector<T>& unknowns) {
  const SmallMotions<T> small =
      small_motions<T>(problem.model, parameters, posture_of(problem, unknowns), problem.reference);
  const std::vector<Controller>& controllers = problem.model.controllers;
  const Eigen::Index n = small.mass.rows();
  const bool integrates = problem.control == JointControl::held;
  const Eigen::Index size = 2 * n + (integrates ? static_cast<Eigen::Index>(controllers.size()) : 0);
  const auto zero = [](Eigen::Index rows) { return DynamicMatrix<T>::Constant(rows, rows, T(0)); };
  LinearMotion<T> motion{zero(size), zero(size)};
  for (Eigen::Index i = 0; i < size; ++i) motion.inertia(i, i) = T(1);
  motion.inertia.block(n, n, n, n) = small.mass;
  for (Eigen::Index i = 0; i < n; ++i) motion.flow(i, n + i) = T(1);
  motion.flow.block(n, 0, n, n) = -small.stiffness;
  motion.flow.block(n, n, n, n) = -small.damping;
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    const Controller& controller = controllers[c];
    const auto joint = static_cast<Eigen::Index>(joint_index(problem.model, controller.body, controller.joint));
    motion.flow(n + joint, joint) -= T(controller.proportional);
    motion.flow(n + joint, n + joint) -= T(controller.derivative);
    if (!integrates) continue;
    const Eigen::Index integral = 2 * n + static_cast<Eigen::Index>(c);
    motion.flow(n + joint, integral) = -T(controller.integral);
    motion.flow(integral, joint) = T(1);
  }
  return motion;
}

/// Coordinates in which E^-1 A is nearly diagonal, in floating point: any are sound.
struct Modes {
  ApproximateModes approximate;  ///< T
  Eigen::MatrixXd inverse;       ///< near (E T)^-1
};

std::optional<Modes> modes_of(const LinearMotion<double>& motion) {
  Modes modes{approximate_modes(motion.inertia.partialPivLu().solve(motion.flow)), {}};
  modes.inverse = Eigen::MatrixXd(motion.inertia * modes.approximate.matrix).partialPivLu().inverse();
  if (!modes.inverse.allFinite()) return std::nullopt;
  return modes;
}

/// inverse m T.
IntervalMatrix in_modes(const Modes& modes, const IntervalMatrix& m) {
  return (MidpointRadius(modes.inverse) * MidpointRadius(m) * MidpointRadius(modes.approximate.matrix)).intervals();
}

/// Encloses the X with m X = right, for all matrices of the intervals; nothing where `m` is not near enough to I.
///
/// X = right + C X with C = I - m. Let |C| <= N and weights w > 0 with N w <= q w, q < 1. In the norm
/// max |x_i|/w_i a column x of X is at most |r|/(1 - q), and differs from its column r by q/(1 - q) |r| at most.
class NearIdentity {
 public:
  [[nodiscard]] static std::optional<NearIdentity> of(const IntervalMatrix& m) {
    NearIdentity result{IntervalMatrix::Identity(m.rows(), m.cols()) - m};
    const Eigen::MatrixXd magnitudes = result.rest_.unaryExpr([](const Interval& a) { return magnitude(a); });
    const auto contraction = weighted_contraction(magnitudes, Eigen::VectorXd::Ones(m.rows()));
    if (!contraction) return std::nullopt;
    result.contraction_ = *contraction;
    return result;
  }

  [[nodiscard]] IntervalMatrix solution(const IntervalMatrix& right) const {
    constexpr int refinements = 4;
    const Interval share = Interval(contraction_.factor) / (Interval(1) - Interval(contraction_.factor));
    IntervalMatrix result = right;
    for (Eigen::Index j = 0; j < right.cols(); ++j) {
      Interval norm(0);
      for (Eigen::Index i = 0; i < right.rows(); ++i)
        norm = max(norm, Interval(magnitude(right(i, j))) / Interval(contraction_.weights[i]));
      for (Eigen::Index i = 0; i < right.rows(); ++i)
        result(i, j) += share * norm * Interval(contraction_.weights[i]) * Interval(-1.0, 1.0);
    }
    const MidpointRadius rest(rest_);
    for (int k = 0; k < refinements; ++k) result = right + (rest * MidpointRadius(result)).intervals();
    return result;
  }

 private:
  explicit NearIdentity(IntervalMatrix rest) : rest_(std::move(rest)) {}

  IntervalMatrix rest_;              ///< C
  WeightedContraction contraction_;  ///< w and q
};

LinearMotion<Interval> partial(const LinearMotion<Dual<Interval>>& motion) {
  const auto of = [](const Dual<Interval>& a) { return a.partial[0]; };
  return {motion.inertia.unaryExpr(of), motion.flow.unaryExpr(of)};
}

/// Contains T^-1 E^-1 A T for every parameter of the box: with E^ = L E T near I and A^ = L A T, that is B = E^^-1 A^,
/// by the mean value theorem B(p) = B(p_0) + sum of E^^-1 (dA^/dp_k - dE^/dp_k B) (p_k - p_0k), total derivatives along
/// the equilibria.
struct FlowInModes {
  IntervalMatrix whole;
  std::vector<IntervalMatrix> by_parameters;  ///< the terms of the sum
};

std::optional<FlowInModes> flow_in_modes(const StandingProblem& problem, const Box& box,
                                         const EquilibriumFunction& equilibrium, const Modes& modes) {
  const Box centre(equilibrium.parameters.begin(), equilibrium.parameters.end());
  const LinearMotion<Interval> at_centre = linear_motion<Interval>(problem, centre, equilibrium.at_centre);
  const IntervalMatrix inertia_at_centre = in_modes(modes, at_centre.inertia);
  const IntervalMatrix flow_at_centre = in_modes(modes, at_centre.flow);
  IntervalMatrix inertia = inertia_at_centre;
  IntervalMatrix flow = flow_at_centre;
  std::vector<LinearMotion<Interval>> slopes;
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    const std::uint32_t k = problem.parameters[i];
    std::vector<Dual<Interval>> parameters(box.begin(), box.end());
    parameters[k].partial[0] = Interval(1);
    std::vector<Dual<Interval>> unknowns(equilibrium.range.begin(), equilibrium.range.end());
    for (std::size_t j = 0; j < unknowns.size(); ++j)
      unknowns[j].partial[0] = equilibrium.by_parameters[i][static_cast<Eigen::Index>(j)];
    const LinearMotion<Interval> slope = partial(linear_motion<Dual<Interval>>(problem, parameters, unknowns));
    slopes.push_back({in_modes(modes, slope.inertia), in_modes(modes, slope.flow)});
    const Interval deviation = box[k] - centre[k];
    inertia += slopes.back().inertia * deviation;
    flow += slopes.back().flow * deviation;
  }
  const std::optional<NearIdentity> near_at_centre = NearIdentity::of(inertia_at_centre);
  const std::optional<NearIdentity> near = NearIdentity::of(inertia);
  if (!near_at_centre || !near) return std::nullopt;
  FlowInModes result{near_at_centre->solution(flow_at_centre), {}};
  const IntervalMatrix crude = near->solution(flow);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const std::uint32_t k = problem.parameters[i];
    const IntervalMatrix slope =
        near->solution(slopes[i].flow - (MidpointRadius(slopes[i].inertia) * MidpointRadius(crude)).intervals());
    result.by_parameters.emplace_back(slope * (box[k] - centre[k]));
    result.whole += result.by_parameters.back();
  }
  return result;
}

/// A mode over a box: its block of B is the enclosed eigenvalue's, [re, im; -im, re], and what it differs by from that.
struct EnclosedMode {
  Eigen::Index size;
  Interval real, imaginary;
};

Interval halved(const Interval& a) {
  return a * Interval(0.5);
}

EnclosedMode enclosed(const ModalBasis::Block& mode, const IntervalMatrix& b) {
  const Eigen::Index i = mode.first;
  if (mode.size == 1) return {1, b(i, i), Interval(0)};
  return {2, halved(b(i, i) + b(i + 1, i + 1)), halved(b(i, i + 1) - b(i + 1, i))};
}

/// A matrix B as the block diagonal D of its modes, which is normal, and what it differs by, in norms of blocks, from
/// above.
class NearlyDiagonal {
 public:
  NearlyDiagonal(const IntervalMatrix& b, const std::vector<ModalBasis::Block>& modes) {
    const auto size = static_cast<Eigen::Index>(modes.size());
    for (const ModalBasis::Block& mode : modes) modes_.push_back(enclosed(mode, b));
    off_.resize(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < size; ++j)
        off_(i, j) = difference(b, modes[static_cast<std::size_t>(i)], modes[static_cast<std::size_t>(j)]);
    }
  }

  [[nodiscard]] const std::vector<EnclosedMode>& modes() const { return modes_; }
  [[nodiscard]] const Eigen::MatrixXd& off() const { return off_; }

  /// Positive, and nearly those with which the comparison below would hold first, were the differences to shrink.
  [[nodiscard]] Eigen::VectorXd approximate_weights() const {
    constexpr int steps = 30;
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(off_.rows());
    for (int step = 0; step < steps; ++step) {
      weights = relative(off_ * weights) + 0x1p-30 * weights;
      weights /= weights.maxCoeff();
    }
    return weights;
  }

  /// By the distances of the modes from the imaginary axis, about.
  [[nodiscard]] Eigen::VectorXd relative(Eigen::VectorXd rows) const {
    for (Eigen::Index i = 0; i < rows.size(); ++i)
      rows[i] /= std::fmax(magnitude(modes_[static_cast<std::size_t>(i)].real), 0x1p-100);
    return rows;
  }

  /// How many eigenvalues lie to the right of `real`, where it is proven that none has that real part: for an
  /// eigenvalue z of D + t (B - D), t in [0, 1], and its vector y,
  ///
  ///     |re_i - Re z| |y_i| <= |(D_i - z) y_i| <= sum of |B - D|_ij |y_j|,
  ///
  /// which weights d > 0 with |re_i - real| d_i > sum of |B - D|_ij d_j exclude for Re z = real (look at the i with the
  /// greatest |y_i|/d_i): no eigenvalue crosses the line as t grows from 0, where they are those of the modes.
  [[nodiscard]] std::optional<std::size_t> count_right_of(double real) const {
    Eigen::VectorXd distances(off_.rows());
    std::size_t count = 0;
    for (Eigen::Index i = 0; i < off_.rows(); ++i) {
      const EnclosedMode& mode = modes_[static_cast<std::size_t>(i)];
      const Interval right = mode.real - Interval(real);
      distances[i] = std::fmax(right.lower(), -right.upper());
      if (!(distances[i] > 0.0)) return std::nullopt;
      if (right.lower() > 0.0) count += static_cast<std::size_t>(mode.size);
    }
    if (!weighted_contraction(off_, distances)) return std::nullopt;
    return count;
  }

  /// Gershgorin's discs of blocks, those that overlap as one: in each union as many eigenvalues as modes.
  [[nodiscard]] std::vector<EigenvalueEnclosure> discs() const;

 private:
  /// The norm of a block of B - D.
  [[nodiscard]] static double difference(const IntervalMatrix& b, const ModalBasis::Block& row,
                                         const ModalBasis::Block& column) {
    const Eigen::Index i = row.first;
    const Eigen::Index j = column.first;
    if (i == j) {
      if (row.size == 1) return 0.0;
      const Interval stretch = halved(b(i, i) - b(i + 1, i + 1));
      const Interval shear = halved(b(i, i + 1) + b(i + 1, i));
      return sqrt(square(stretch) + square(shear)).upper();  // symmetric without trace: both eigenvalues have this size
    }
    return spectral_norm(b.block(i, j, row.size, column.size));
  }

  std::vector<EnclosedMode> modes_;
  Eigen::MatrixXd off_;
};

Enclosure hull_of(const Enclosure& a, const Enclosure& b) {
  return {std::fmin(a.lo, b.lo), std::fmax(a.hi, b.hi)};
}

bool overlap(const Enclosure& a, const Enclosure& b) {
  return a.lo <= b.hi && b.lo <= a.hi;
}

std::vector<EigenvalueEnclosure> NearlyDiagonal::discs() const {
  std::vector<EigenvalueEnclosure> boxes;
  const auto widened = [](const Interval& centre, const Interval& radius) {
    return Enclosure{(centre - radius).lower(), (centre + radius).upper()};
  };
  for (Eigen::Index i = 0; i < off_.rows(); ++i) {
    Interval radius(0);
    for (Eigen::Index j = 0; j < off_.cols(); ++j) radius += Interval(off_(i, j));
    const EnclosedMode& mode = modes_[static_cast<std::size_t>(i)];
    boxes.push_back({widened(mode.real, radius), widened(mode.imaginary, radius), 1});
    if (mode.size == 2) boxes.push_back({boxes.back().real, widened(-mode.imaginary, radius), 1});
  }
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size();) {
        if (!overlap(boxes[i].real, boxes[j].real) || !overlap(boxes[i].imaginary, boxes[j].imaginary)) {
          ++j;
          continue;
        }
        boxes[i] = {hull_of(boxes[i].real, boxes[j].real), hull_of(boxes[i].imaginary, boxes[j].imaginary),
                    boxes[i].count + boxes[j].count};
        boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
        merged = true;
      }
    }
  }
  for (EigenvalueEnclosure& alone : boxes) {  // and without its conjugate: real
    if (alone.count == 1 && alone.imaginary.lo <= 0.0 && alone.imaginary.hi >= 0.0) alone.imaginary = {0.0, 0.0};
  }
  std::ranges::sort(boxes, [](const EigenvalueEnclosure& a, const EigenvalueEnclosure& b) {
    return std::pair(a.real.hi, a.imaginary.hi) > std::pair(b.real.hi, b.imaginary.hi);
  });
  return boxes;
}

/// The greatest real part of an eigenvalue.
Enclosure greatest_real_part(const NearlyDiagonal& matrix) {
  // Where it is, about; the search goes out from there on both sides.
  double greatest = -infinity;
  for (const EnclosedMode& mode : matrix.modes()) greatest = std::fmax(greatest, mode.real.upper());
  const auto all_left_of = [&](double real) { return matrix.count_right_of(real) == std::size_t{0}; };
  const auto some_right_of = [&](double real) { return matrix.count_right_of(real).value_or(0) > 0; };
  // From the mode on in doubled steps until it is proven, then back by halving.
  const auto end = [&](double sign, const auto& proven) {
    constexpr int most_doublings = 60;
    constexpr int halvings = 8;
    double step = 0x1p-40 * std::fmax(std::abs(greatest), 0x1p-20);
    int doublings = 0;
    while (!proven(greatest + sign * step)) {
      if (++doublings > most_doublings) return sign * infinity;
      step *= 2.0;
    }
    double within = doublings > 0 ? 0.5 * step : 0.0;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * within + 0.5 * step;
      (proven(greatest + sign * middle) ? step : within) = middle;
    }
    return greatest + sign * step;
  };
  return {end(-1.0, some_right_of), end(1.0, all_left_of)};
}

/// How much each parameter adds to what stands against a proof.
std::vector<double> shares(const NearlyDiagonal& whole, const FlowInModes& flow,
                           const std::vector<ModalBasis::Block>& modes) {
  const Eigen::VectorXd weights = whole.approximate_weights();
  std::vector<double> result;
  for (const IntervalMatrix& part : flow.by_parameters) {
    const Eigen::VectorXd moved = whole.relative(NearlyDiagonal(part, modes).off() * weights);
    result.push_back(moved.cwiseQuotient(weights).maxCoeff());
  }
  return result;
}

StabilityOfCell stability_of(const StandingProblem& problem, const Box& box) {
  const std::optional<EquilibriumFunction> equilibrium = equilibrium_function(problem, box);
  if (!equilibrium) return {};
  std::vector<double> unknowns;
  for (const Interval& unknown : equilibrium->at_centre)
    unknowns.push_back(0.5 * unknown.lower() + 0.5 * unknown.upper());
  const std::optional<Modes> modes = modes_of(linear_motion<double>(problem, equilibrium->parameters, unknowns));
  if (!modes) return {};
  const std::optional<FlowInModes> flow = flow_in_modes(problem, box, *equilibrium, *modes);
  if (!flow) return {};
  const NearlyDiagonal matrix(flow->whole, modes->approximate.blocks);
  const std::optional<std::size_t> right = matrix.count_right_of(0.0);
  if (!right) return {.shares = shares(matrix, *flow, modes->approximate.blocks)};
  return {*right == 0 ? StabilityVerdict::stable : StabilityVerdict::unstable,
          greatest_real_part(matrix),
          matrix.discs(),
          {}};
}

/// `parameters` has an interval for each parameter of the model.
StabilityOfCell stability_over(const StandingProblem& problem, const Box& parameters) {
  try {
    return stability_of(problem, parameters);
  } catch (const std::domain_error&) {  // numbers beyond binary64, or a cylinder that stands upright
    return {};
  }
}

using verify::Interval;

[[noreturn]] void refuse_stability(const std::string& reason) {
  throw Error(ErrorKind::input, "stability: " + reason);
}

/// The root's rotations are taken about the reference point instead of its origin: the same motions only where it may
/// move every way.
void check_root(const Body& root) {
  std::array<int, 3> translations{};
  for (const Joint& joint : root.joints) {
    if (joint.kind == JointKind::translation) ++translations[joint.axis];
  }
  if (translations != std::array{1, 1, 1}) refuse_stability("the root needs one translation along each of x, y and z");
}

/// What varies with time leaves nothing at rest.
void check_applied_force(const AppliedForce& applied) {
  const auto is_zero = [](const Quantity& quantity) { return quantity.range == Enclosure{0.0, 0.0}; };
  if (!is_zero(applied.frequency) && !std::ranges::all_of(applied.force, is_zero))
    refuse_stability("the applied force has a frequency, and nothing is at rest under it: it must be 0");
}

void check_cylinders(const Model& model, std::span<const Interval> parameters) {
  for (const ContactCylinder& cylinder : model.cylinders) {
    if (!(value_of<Interval>(cylinder.static_friction, parameters).lower() > 0.0))
      refuse_stability(fmt::format("cylinder {} may have no static friction, and slides then", cylinder.name));
    if (!(cylinder.bristle_stiffness > 0.0)) {
      refuse_stability(
          fmt::format("cylinder {} has no bristle_stiffness and bristle_damping, and nothing keeps it from sliding",
                      cylinder.name));
    }
  }
}

void check_integral_parts(const Model& model) {
  std::vector<bool> holds(model.degrees_of_freedom(), false);
  for (const Controller& controller : model.controllers)
    holds[joint_index(model, controller.body, controller.joint)] = controller.integral > 0.0;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    for (std::size_t j = 0; j < model.bodies[i].joints.size(); ++j) {
      if (holds[joint_index(model, i, j)]) continue;
      refuse_stability(
          fmt::format("no controller with an integral part holds joint {} of {} where the file has it; its "
                      "equilibrium is that of proportional joints",
                      model.bodies[i].joints[j].name, model.bodies[i].name));
    }
  }
}

void check_stability(const Model& model, JointControl control, UncertainSet uncertain) {
  check_root(model.bodies.front());
  check_applied_force(model.applied);
  check_cylinders(model, parameter_box(model, uncertain));
  if (control == JointControl::held) check_integral_parts(model);
}

struct Part : BoxPart {
  StabilityOfCell found = {};
};

class StabilityByParts {
 public:
  StabilityByParts(const Model& model, UncertainSet uncertain, const StabilityOptions& options)
      : options_(options),
        problem_(standing_problem(model, options.control, uncertain)),
        division_(problem_.parameters, std::max(options.cells, 1U)) {
    open_.push_back({BoxPart::whole(parameter_box(model, uncertain), uncertain.size())});
  }

  [[nodiscard]] Stability run() {
    while (!open_.empty() && !result_.interrupted) {
      std::vector<Part> batch = take_batch(open_);
      examine_on_all_cores(batch, [&](Part& part) {
        if (!options_.interrupted || !options_.interrupted()) part.found = stability_over(problem_, part.box);
      });
      for (const Part& part : batch) settle(part);
      if (options_.progress) options_.progress(result_.stable + result_.unstable + result_.open);
      result_.interrupted = options_.interrupted && options_.interrupted();
    }
    for (const Part& part : open_) take(part);
    const bool open = result_.open > 0.0;
    result_.stable = share_beside_others(result_.stable, open || result_.unstable > 0.0);
    result_.unstable = share_beside_others(result_.unstable, open || result_.stable > 0.0);
    return std::move(result_);
  }

 private:
  void settle(const Part& part) {
    const bool is_open = part.found.verdict == StabilityVerdict::open;
    const std::optional<std::size_t> k = is_open ? next_to_halve(part) : std::nullopt;
    if (!k) {
      take(part);
      return;
    }
    for (BoxPart& half : division_.halves(part, *k)) open_.push_back({std::move(half)});
  }

  /// The parameter that keeps most open, where that is known, else that which has been halved least.
  [[nodiscard]] std::optional<std::size_t> next_to_halve(const Part& part) const {
    const std::vector<double>& shares = part.found.shares;
    if (shares.empty()) return division_.least_halved(part);
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < shares.size(); ++k) {
      if (division_.is_divisible(part, k) && (!best || shares[k] > shares[*best])) best = k;
    }
    return best;
  }

  void take(const Part& part) {
    StabilityCell cell{{}, part.found.verdict};
    for (const std::uint32_t k : problem_.parameters) cell.ranges.push_back({part.box[k].lower(), part.box[k].upper()});
    result_.cells.push_back(std::move(cell));
    switch (part.found.verdict) {
      case StabilityVerdict::stable: result_.stable += part.share(); break;
      case StabilityVerdict::unstable: result_.unstable += part.share(); break;
      case StabilityVerdict::open: result_.open += part.share(); return;
    }
    if (part.share() == 1.0) result_.eigenvalues = part.found.eigenvalues;
    result_.growth = {std::fmin(result_.growth.lo, part.found.growth.lo),
                      std::fmax(result_.growth.hi, part.found.growth.hi)};
  }

  const StabilityOptions& options_;
  StandingProblem problem_;
  BoxDivision division_;
  std::deque<Part> open_;
  Stability result_;
};

}  // namespace

Stability stability(const Model& model, UncertainSet uncertain, const StabilityOptions& options) {
  check_stability(model, options.control, uncertain);
  return StabilityByParts(model, uncertain, options).run();
}

}  // namespace verisq::stance
