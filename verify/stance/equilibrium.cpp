/// This file implements equilibrium.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/scalar.hpp"
#include "verify/stance/tree.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

/// The ranges over a cell: at its ends where the derivative of a component by a parameter has a proven sign.
class RangesOfCell {
 public:
  RangesOfCell(const StandingProblem& problem, const Box& box, const Located& at)
      : problem_(problem), box_(box), alone_(at.alone), whole_(with_unknowns(at, at.ranges(problem, box))) {
    for (const std::uint32_t k : problem.parameters) derivatives_.push_back(by(k, at));
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

  /// Of all components by one parameter: unproven where that of the posture is.
  [[nodiscard]] IntervalVector by(std::uint32_t parameter, const Located& at) const {
    const std::optional<IntervalVector> moved = at.posture_by(problem_, box_, parameter);
    if (!moved) return IntervalVector::Constant(whole_.size(), Interval(-infinity, infinity));
    IntervalVector all = by_parameter(problem_, box_, at.unknowns, parameter) + product(at.slopes, *moved);
    all.head(moved->size()) = *moved;
    return all;
  }

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
    return known_.emplace(ends, same ? with_unknowns(*at, at->ranges(problem_, part)) : whole_).first->second;
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
  static std::array<double, 3> reach() {
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
    const verify::EquilibriumRanges<Interval> ranges =
        named(problem_, components<Interval>(problem_, box_, part, Extent::all));
    for (const Interval& penetration : ranges.penetrations) {
      if (penetration.upper() < 0.0) return std::nullopt;
    }
    const std::optional<BalanceExpansion> at = BalanceExpansion::about(problem_, box_, parameters_, middle_of(part));
    if (!at) return part;
    IntervalVector errors(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto n = static_cast<std::size_t>(i);
      errors[i] = part[n] - Interval(at->posture[n]);
    }
    const IntervalVector image = at->constant + product(at->rest(problem_, box_, part), errors);
    std::vector<Interval> left;
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const Interval moved = image[i] + Interval(at->posture[n]);
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

}  // namespace

verify::EquilibriumRanges<Interval> named(const StandingProblem& problem, const IntervalVector& components) {
  const std::span list(components.data(), static_cast<std::size_t>(components.size()));
  return verify::named<Interval>(list, problem.start.size(), problem.model);
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

namespace {

using verify::Interval;

struct Cell : BoxPart {
  CellVerdict found = {};
};

/// The component that sticks out of the samples most, if one does by more than is worth a bisection. What no parameter
/// moves, by symmetry say, is no reason for one.
std::optional<Eigen::Index> sticking_out(const SampledHull& samples, const IntervalVector& ranges) {
  constexpr double worth = 0.03;    // of the hull
  constexpr double unmoved = 1e-6;  // the hull, of the enclosure
  std::optional<Eigen::Index> worst;
  double most = worth;
  for (Eigen::Index i = 0; i < ranges.size() && !samples.is_empty(); ++i) {
    const double width = samples.width(i);
    if (width <= unmoved * (ranges[i].upper() - ranges[i].lower())) continue;
    const double excess = samples.excess(i, ranges[i]) / width;
    if (excess <= most) continue;
    most = excess;
    worst = i;
  }
  return worst;
}

class Subdivision {
 public:
  Subdivision(const Model& model, UncertainSet uncertain, const EquilibriumOptions& options)
      : model_(model),
        options_(options),
        problem_(standing_problem(model, options.control, uncertain)),
        division_(problem_.parameters, std::max(options.cells, 1U)) {
    result_.reference = problem_.reference;
    const Box whole = parameter_box(model, uncertain);
    open_.push_back({BoxPart::whole(whole, uncertain.size())});
    for (const std::vector<double>& corner : corners_of(whole, problem_.parameters))
      samples_.add(sampled_equilibrium(problem_, corner));
  }

  [[nodiscard]] Equilibrium run() {
    while (!open_.empty() && !result_.interrupted) {
      std::vector<Cell> batch = take_batch(open_);
      examine_on_all_cores(batch, [&](Cell& cell) { cell.found = examine(problem_, cell.box); });
      for (const Cell& cell : batch) samples_.add(sampled_equilibrium(problem_, middle_of(cell.box)));
      for (Cell& cell : batch) settle(cell);
      if (options_.progress) options_.progress(result_.stands + result_.not_on_all + result_.open);
      result_.interrupted = options_.interrupted && options_.interrupted();
    }
    for (const Cell& cell : open_) take(cell);
    result_.stands = share_beside_others(result_.stands, result_.open > 0.0 || result_.not_on_all > 0.0);
    return std::move(result_);
  }

 private:
  void settle(Cell& cell) {
    if (const std::optional<std::size_t> k = next_to_halve(cell)) {
      for (BoxPart& half : division_.halves(cell, *k)) open_.push_back({std::move(half), cell.found});
      return;
    }
    take(cell);
  }

  [[nodiscard]] std::optional<std::size_t> next_to_halve(const Cell& cell) const {
    switch (cell.found.verdict) {
      case StandingVerdict::open: return division_.least_halved(cell);
      case StandingVerdict::stands:
        if (const std::optional<Eigen::Index> i = sticking_out(samples_, cell.found.components))
          return least_clear(cell, *i);
        break;
      case StandingVerdict::not_on_all: break;
    }
    return std::nullopt;
  }

  /// The parameter that keeps most of a component's range open.
  [[nodiscard]] std::optional<std::size_t> least_clear(const Cell& cell, Eigen::Index component) const {
    std::optional<std::size_t> best;
    double most = 0.0;
    for (std::size_t k = 0; k < cell.halvings.size(); ++k) {
      const double unclear = cell.found.unclear[k][component];
      if (!(unclear > most) || !division_.is_divisible(cell, k)) continue;
      most = unclear;
      best = k;
    }
    return best;
  }

  void take(const Cell& cell) {
    EquilibriumCell taken{{}, cell.found.verdict};
    for (const std::uint32_t k : problem_.parameters) taken.ranges.push_back(verify::outward(cell.box[k]));
    switch (cell.found.verdict) {
      case StandingVerdict::stands: {
        const verify::EquilibriumRanges<Interval> ranges = named(problem_, cell.found.components);
        for (const Interval& unknown : ranges.unknowns) taken.postures.push_back(verify::outward(unknown));
        result_.stands += cell.share();
        if (!result_.standing) result_.standing = verify::uniform(model_, problem_.joints, verify::nothing_yet);
        verify::add(*result_.standing, model_, problem_.joints, ranges, hull);
        break;
      }
      case StandingVerdict::not_on_all: result_.not_on_all += cell.share(); break;
      case StandingVerdict::open: result_.open += cell.share(); break;
    }
    result_.cells.push_back(std::move(taken));
  }

  const Model& model_;
  const EquilibriumOptions& options_;
  StandingProblem problem_;
  BoxDivision division_;
  SampledHull samples_;
  std::deque<Cell> open_;
  Equilibrium result_;
};

}  // namespace

Equilibrium equilibrium(const Model& model, UncertainSet uncertain, const EquilibriumOptions& options) {
  return Subdivision(model, uncertain, options).run();
}

}  // namespace verisq::stance
