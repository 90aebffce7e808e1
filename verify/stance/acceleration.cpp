/// The wrench on a free body, and what acceleration.hpp declares.
#include "verify/stance/acceleration.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance.hpp>

#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

using FirstOrder = Dual<Interval>;
using SecondOrder = Dual<FirstOrder>;

template <class T>
T component_at(const Model& model, const std::vector<T>& parameters, std::size_t component) {
  return root_wrench<T>(model, parameters, stance_state<T>(model))[component];
}

/// The wrench with its partial derivatives by one parameter.
FirstOrder expansion(const Model& model, std::size_t component, std::span<const Interval> box, std::uint32_t i) {
  return component_at(model, as_variables<1, Interval>(box, {i}), component);
}

/// Derivatives by parameter i of the derivative by parameter j.
Interval second_derivative(const Model& model, std::size_t component, std::span<const Interval> box, std::uint32_t i,
                           std::uint32_t j) {
  const std::vector<FirstOrder> inner = as_variables<1, Interval>(box, {i});
  const std::vector<SecondOrder> outer = as_variables<1, FirstOrder>(inner, {j});
  return component_at(model, outer, component).partial[0].partial[0];
}

/// The model must outlive the function.
DifferentiableFunction wrench_component(const Model& model, std::size_t component) {
  return {[&model, component](std::span<const Interval> box) {
            return component_at(model, std::vector<Interval>(box.begin(), box.end()), component);
          },
          [&model, component](std::span<const Interval> box, std::uint32_t i) {
            return expansion(model, component, box, i).partial[0];
          }};
}

/// Its partial derivative by a parameter. The model must outlive the function.
DifferentiableFunction wrench_derivative(const Model& model, std::size_t component, std::uint32_t parameter) {
  return {[&model, component, parameter](std::span<const Interval> box) {
            return expansion(model, component, box, parameter).partial[0];
          },
          [&model, component, parameter](std::span<const Interval> box, std::uint32_t i) {
            return second_derivative(model, component, box, i, parameter);
          }};
}

/// Where the component is evaluated: in `tight` mode the box of the uncertain set. In `paper` mode the moment about z
/// (w6) sees the x of the root's centre of mass as px + (px - px), three times as wide as px: the printed cells are
/// those of g mp (0.05 + (px - px) - px) + c6 (docs/stance.md §1).
Box evaluation_box(const Model& model, UncertainSet uncertain, std::size_t component, Mode mode) {
  constexpr std::size_t moment_about_z = 5;
  Box box = parameter_box(model, uncertain);
  const std::optional<std::uint32_t> px = model.bodies.front().centre_of_mass[0].parameter;
  if (mode == Mode::paper && component == moment_about_z && px) box[*px] += box[*px] - box[*px];
  return box;
}

}  // namespace

WrenchEnclosure wrench(const Model& model, UncertainSet uncertain, Mode mode) {
  WrenchEnclosure result;
  for (std::size_t k = 0; k < wrench_size; ++k) {
    result[k] = range(wrench_component(model, k), evaluation_box(model, uncertain, k, mode), uncertain);
  }
  return result;
}

WrenchEnclosure sensitivity(const Model& model, UncertainSet uncertain, std::uint32_t parameter, Mode mode) {
  WrenchEnclosure result;
  for (std::size_t k = 0; k < wrench_size; ++k) {
    result[k] = range(wrench_derivative(model, k, parameter), evaluation_box(model, uncertain, k, mode), uncertain);
  }
  return result;
}

std::array<double, wrench_size> sampled_wrench(const Model& model, std::span<const double> parameters) {
  return root_wrench<double>(model, parameters, stance_state<double>(model));
}

namespace {

using verify::Interval;

using Variation = ParametricLinearSystem::Variation;

Interval slope_of(const Dual<Interval>& a) {
  return a.partial[0];
}

/// The equations of motion, whose unknowns are the accelerations alone.
struct WholeMotion {
  const Model& model;
  const Instant& at;

  [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(model.degrees_of_freedom()); }

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> matrix(const std::vector<T>& parameters) const {
    return mass_matrix_at(model, parameters, at);
  }

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> residual(const std::vector<T>& parameters,
                                                             const Eigen::VectorXd& x) const {
    return residual_force(model, parameters, at, x);
  }
};

/// By one parameter, over the box.
template <class Motion>
Variation variation(const Motion& motion, const Box& box, std::uint32_t variable, const Interval& deviation,
                    const Eigen::VectorXd& x) {
  const std::vector<Dual<Interval>> parameters = as_variables<1, Interval>(box, {variable});
  return {deviation, motion.matrix(parameters).unaryExpr(&slope_of),
          motion.residual(parameters, x).unaryExpr(&slope_of)};
}

bool is_zero(const Variation& variation) {
  const auto zero = [](const Interval& a) { return a.lower() == 0.0 && a.upper() == 0.0; };
  return std::all_of(variation.matrix.reshaped().begin(), variation.matrix.reshaped().end(), zero) &&
         std::all_of(variation.residual.begin(), variation.residual.end(), zero);
}

bool acts(const Model& model, const Instant& at, const Box& box, std::uint32_t variable) {
  try {
    const WholeMotion motion{model, at};
    return !is_zero(variation(motion, box, variable, 0, Eigen::VectorXd::Zero(motion.unknowns())));
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return true;
  }
}

std::optional<ReducedMotion> reduced_motion(const Model& model, const Instant& at, const Box& whole,
                                            std::span<const std::uint32_t> variables) {
  try {
    return ReducedMotion::of(model, at, variables, middle_of(whole));
  } catch (const std::domain_error&) {
    return std::nullopt;
  }
}

/// The accelerations are the first unknowns.
template <class Motion>
AccelerationCell examined(const Motion& motion, Eigen::Index count, const Box& box,
                          std::span<const std::uint32_t> variables) {
  const std::vector<double> middle = middle_of(box);
  const Box centre(middle.begin(), middle.end());
  ParametricLinearSystem system{{}, motion.matrix(centre), {}, {}};
  const auto number = [](const Interval& a) { return middle_of(a); };
  const IntervalVector right = motion.residual(centre, Eigen::VectorXd::Zero(motion.unknowns()));
  system.approximation = system.matrix.unaryExpr(number).partialPivLu().solve(right.unaryExpr(number));
  AccelerationCell cell{.accelerations = {}, .obstructions = {}, .sample = {}};
  cell.obstructions.assign(variables.size(), 0.0);
  if (!system.approximation.allFinite()) return cell;
  cell.sample = system.approximation.head(count);
  system.residual = motion.residual(centre, system.approximation);
  std::vector<std::size_t> moving;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const Interval& side = box[variables[k]];
    if (side.lower() == side.upper()) continue;
    moving.push_back(k);
    system.variations.push_back(
        variation(motion, box, variables[k], side - centre[variables[k]], system.approximation));
  }
  const std::optional<ParametricSolution> solved = solve(system);
  if (!solved) {
    const std::vector<double> found = obstructions(system);
    for (std::size_t n = 0; n < moving.size(); ++n) cell.obstructions[moving[n]] = found[n];
    return cell;
  }
  cell.accelerations = {solved->solution.head(count),
                        std::vector<IntervalVector>(variables.size(), IntervalVector::Zero(count))};
  for (std::size_t n = 0; n < moving.size(); ++n)
    cell.accelerations->derivatives[moving[n]] = solved->derivatives[n].head(count);
  return cell;
}

}  // namespace

AccelerationProblem::AccelerationProblem(const Model& model, const Instant& at, const Box& whole,
                                         UncertainSet uncertain)
    : model_(model), at_(at) {
  std::copy_if(uncertain.begin(), uncertain.end(), std::back_inserter(variables_),
               [&](std::uint32_t i) { return acts(model, at, whole, i); });
  reduced_ = reduced_motion(model, at, whole, variables_);
}

AccelerationCell AccelerationProblem::examine(const Box& box) const {
  const auto count = static_cast<Eigen::Index>(model_.degrees_of_freedom());
  try {
    if (reduced_) return examined(*reduced_, count, box, variables_);
    return examined(WholeMotion{model_, at_}, count, box, variables_);
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return {.accelerations = {}, .obstructions = std::vector<double>(variables_.size(), 0.0), .sample = {}};
  }
}

namespace {

using verify::Interval;

/// The cells that were examined, for all ends.
class ExaminedCells {
 public:
  explicit ExaminedCells(const AccelerationProblem& problem) : problem_(problem) {}

  [[nodiscard]] const AccelerationCell* find(const Box& box) const {
    const auto found = cells_.find(key_of(box));
    return found == cells_.end() ? nullptr : &found->second;
  }

  [[nodiscard]] std::size_t size() const { return cells_.size(); }

  /// Those that are not known yet; their samples go to the hull.
  void examine(const std::vector<Box>& boxes, SampledHull& hull) {
    std::map<Key, const Box*> wanted;
    for (const Box& box : boxes) {
      if (find(box) == nullptr) wanted.emplace(key_of(box), &box);
    }
    struct Task {
      const Key* key;
      const Box* box;
      AccelerationCell cell;
    };
    std::vector<Task> tasks;
    tasks.reserve(wanted.size());
    for (const auto& [key, box] : wanted) tasks.push_back({&key, box, {}});
    examine_on_all_cores(tasks, [&](Task& task) { task.cell = problem_.examine(*task.box); });
    for (Task& task : tasks) {
      hull.add(task.cell.sample);
      cells_.emplace(*task.key, std::move(task.cell));
    }
  }

 private:
  using Key = std::vector<double>;

  [[nodiscard]] Key key_of(const Box& box) const {
    Key key;
    for (const std::uint32_t i : problem_.variables()) {
      key.push_back(box[i].lower());
      key.push_back(box[i].upper());
    }
    return key;
  }

  const AccelerationProblem& problem_;
  std::map<Key, AccelerationCell> cells_ = {};
};

/// An upper bound of one component, or of its negative, that cells prove: the cell with the largest bound is halved, or
/// left for one of its faces where the sign of a derivative is proven, until a sample comes near the bound
/// (docs/stance.md §3).
class ComponentEnd {
 public:
  ComponentEnd(const AccelerationProblem& problem, const BoxDivision& division, const Box& whole,
               Eigen::Index component, bool largest)
      : problem_(&problem), division_(&division), component_(component), largest_(largest) {
    parts_.insert({infinity, {BoxPart::whole(whole, problem.variables().size())}});
  }

  /// Goes on as far as the cells that are known lead.
  void advance(const ExaminedCells& cells, const SampledHull& hull) {
    while (!settled_) {
      const auto worst = parts_.begin();
      if (worst->second.finest || worst->first - reached(hull) <= tolerance(hull)) {
        settled_ = true;
        break;
      }
      const AccelerationCell* cell = cells.find(worst->second.part.box);
      if (cell == nullptr) break;
      BoxPart part = std::move(worst->second.part);
      const double bound = worst->first;
      parts_.erase(worst);
      divide(std::move(part), bound, *cell);
    }
    bound_ = parts_.begin()->first;
  }

  [[nodiscard]] bool settled() const { return settled_; }

  /// The boxes with the largest bounds, at most so many.
  [[nodiscard]] std::vector<Box> next(std::size_t count) const {
    std::vector<Box> boxes;
    for (auto part = parts_.begin(); !settled_ && part != parts_.end() && boxes.size() < count; ++part)
      boxes.push_back(part->second.part.box);
    return boxes;
  }

  /// Proven: the component is at most this, or at least.
  [[nodiscard]] double end() const { return largest_ ? bound_ : -bound_; }

  /// How near to settled, from 0 to 1; never falls.
  [[nodiscard]] double fraction(const SampledHull& hull) const {
    return settled_ ? 1.0 : std::fmin(1.0, tolerance(hull) / (bound_ - reached(hull)));
  }

 private:
  struct Part {
    BoxPart part;
    bool finest = false;  ///< the bound is that of the part itself, which is not divided further
  };

  [[nodiscard]] double reached(const SampledHull& hull) const {
    return largest_ ? hull.highest(component_) : -hull.lowest(component_);
  }

  /// A hundredth of the samples' width. Where that is as thin as rounding errors, a component that no parameter moves
  /// is no reason to bisect.
  [[nodiscard]] double tolerance(const SampledHull& hull) const {
    constexpr double share = 0.01;
    constexpr double rounding = 1e-9;
    return share * (hull.width(component_) + rounding * hull.largest_magnitude());
  }

  [[nodiscard]] Interval directed(const Interval& a) const { return largest_ ? a : -a; }

  /// `bound` holds for what the part is a part of.
  void divide(BoxPart part, double bound, const AccelerationCell& cell) {
    if (!cell.accelerations) {
      halve(part, bound, most(part, cell.obstructions));
      return;
    }
    bound = std::fmin(bound, directed(cell.accelerations->solution[component_]).upper());
    if (leave_for_face(part.box, *cell.accelerations)) {
      parts_.insert({bound, {std::move(part)}});
      return;
    }
    std::vector<double> gains;
    for (std::size_t k = 0; k < problem_->variables().size(); ++k) {
      const Interval& side = part.box[problem_->variables()[k]];
      const Interval& slope = cell.accelerations->derivatives[k][component_];
      gains.push_back((side.upper() - side.lower()) * std::fmin(-slope.lower(), slope.upper()));
    }
    halve(part, bound, most(part, gains));
  }

  /// Where a derivative's sign is proven over the box, the largest values lie on a face.
  bool leave_for_face(Box& box, const ParametricSolution& accelerations) const {
    bool left = false;
    for (std::size_t k = 0; k < problem_->variables().size(); ++k) {
      Interval& side = box[problem_->variables()[k]];
      const Interval slope = directed(accelerations.derivatives[k][component_]);
      if (side.lower() == side.upper() || (slope.lower() < 0.0 && slope.upper() > 0.0)) continue;
      side = Interval(slope.lower() >= 0.0 ? side.upper() : side.lower());
      left = true;
    }
    return left;
  }

  /// The divisible variable with the largest number.
  [[nodiscard]] std::optional<std::size_t> most(const BoxPart& part, const std::vector<double>& numbers) const {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (division_->is_divisible(part, k) && (!best || numbers[k] > numbers[*best])) best = k;
    }
    return best;
  }

  void halve(const BoxPart& part, double bound, std::optional<std::size_t> variable) {
    if (!variable) {
      parts_.insert({bound, {part, true}});
      return;
    }
    for (BoxPart& half : division_->halves(part, *variable)) parts_.insert({bound, {std::move(half)}});
  }

  const AccelerationProblem* problem_;
  const BoxDivision* division_;
  Eigen::Index component_;
  bool largest_;
  std::multimap<double, Part, std::greater<>> parts_ = {};  ///< by bound, the largest first; never empty
  bool settled_ = false;
  double bound_ = infinity;
};

class Search {
 public:
  Search(const Model& model, UncertainSet uncertain, const Instant& at, const AccelerationOptions& options)
      : options_(options),
        whole_(parameter_box(model, uncertain)),
        problem_(model, at, whole_, uncertain),
        division_(problem_.variables(), std::max(options.cells, 1U)),
        cells_(problem_) {
    for (const std::vector<double>& corner : corners_of(whole_, problem_.variables()))
      hull_.add(approximate_accelerations(model, at, corner));
    const auto count = static_cast<Eigen::Index>(model.degrees_of_freedom());
    for (Eigen::Index i = 0; i < count; ++i) {
      for (const bool largest : {false, true}) ends_.emplace_back(problem_, division_, whole_, i, largest);
    }
  }

  [[nodiscard]] std::vector<Enclosure> run() {
    constexpr std::size_t most_cells = 20000;
    cells_.examine({whole_}, hull_);
    for (;;) {
      for (ComponentEnd& end : ends_) end.advance(cells_, hull_);
      report();
      if (open() == 0 || cells_.size() >= most_cells || (options_.interrupted && options_.interrupted())) break;
      cells_.examine(next(), hull_);
    }
    std::vector<Enclosure> result;
    for (std::size_t i = 0; i < ends_.size(); i += 2) result.push_back({ends_[i].end(), ends_[i + 1].end()});
    return result;
  }

 private:
  [[nodiscard]] std::size_t open() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(ends_, [](const ComponentEnd& end) { return !end.settled(); }));
  }

  /// Enough for all cores, but no more than that of ends that may be settled without.
  [[nodiscard]] std::vector<Box> next() const {
    constexpr std::size_t batch = 64;
    const std::size_t each = std::max<std::size_t>(1, batch / open());
    std::vector<Box> boxes;
    for (const ComponentEnd& end : ends_) {
      for (Box& box : end.next(each)) boxes.push_back(std::move(box));
    }
    return boxes;
  }

  void report() const {
    if (!options_.progress) return;
    double sum = 0.0;
    for (const ComponentEnd& end : ends_) sum += end.fraction(hull_);
    options_.progress(sum / static_cast<double>(ends_.size()));
  }

  const AccelerationOptions& options_;
  Box whole_;
  AccelerationProblem problem_;
  BoxDivision division_;
  SampledHull hull_ = {};
  ExaminedCells cells_;
  std::vector<ComponentEnd> ends_ = {};
};

}  // namespace

std::vector<Enclosure> accelerations(const Model& model, UncertainSet uncertain, const Instant& at,
                                     const AccelerationOptions& options) {
  return Search(model, uncertain, at, options).run();
}

std::vector<Enclosure> accelerations(const Model& model, UncertainSet uncertain, const AccelerationOptions& options) {
  return accelerations(model, uncertain, instant(model, AccelerationCase::fall), options);
}

std::vector<double> sampled_accelerations(const Model& model, const Instant& at, std::span<const double> parameters) {
  const Eigen::VectorXd sample = approximate_accelerations(model, at, {parameters.begin(), parameters.end()});
  return {sample.begin(), sample.end()};
}

std::vector<double> sampled_accelerations(const Model& model, std::span<const double> parameters) {
  return sampled_accelerations(model, instant(model, AccelerationCase::fall), parameters);
}

}  // namespace verisq::stance
