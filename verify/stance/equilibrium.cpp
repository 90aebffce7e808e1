/// Equilibria over a box of parameters, by bisection into cells that are examined one by one.
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "verify/stance/box_division.hpp"
#include "verify/stance/equilibrium_cell.hpp"
#include "verify/stance/parameters.hpp"
#include "verify/stance/sampled_hull.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::stance {
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
