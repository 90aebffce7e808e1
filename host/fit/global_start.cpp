/// A low-discrepancy sequence of poses, refined around the best.
#include "host/fit/global_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace verisq::fit_search {

namespace {

constexpr std::size_t kDimensions = 6;
/// The root of x^7 = x + 1: the powers of its inverse make the additive recurrence of lowest known discrepancy in six
/// dimensions (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", after the golden ratio).
constexpr double kHarmonious = 1.1127756842787055;
/// Between two polls of the caller.
constexpr std::size_t kBatch = 64;
/// Cells that are sampled again, at most.
constexpr std::size_t kPromising = 16;
/// Rounds of sampling; the first gets half of the samples.
constexpr int kRounds = 3;

using Unit = std::array<double, kDimensions>;  ///< a point of the unit cube

class LowDiscrepancySequence {
 public:
  explicit LowDiscrepancySequence(std::uint64_t seed) {
    std::mt19937_64 random(seed);  // whose numbers the standard fixes, unlike those of its distributions
    for (double& x : at_) x = static_cast<double>(random() >> 11) * 0x1p-53;
  }

  Unit next() {
    double step = 1.0;
    for (double& x : at_) {
      step /= kHarmonious;
      x += step;
      x -= std::floor(x);
    }
    return at_;
  }

 private:
  Unit at_{};
};

/// A box of poses: `half` times the whole range to both sides of the centre, as far as the range goes.
struct Cell {
  Ranked centre;
  double bound;  ///< of the objective within the cell
};

class Sampler {
 public:
  Sampler(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
          const Landscape& landscape, std::uint64_t seed, SearchWatch& watch)
      : space_(space), evaluator_(evaluator), asked_(asked), landscape_(landscape), watch_(watch), sequence_(seed) {}

  /// Adds `count` samples of the box around the centre; each has a cell of its own size around it.
  void sample(const Parameters& centre, double half, double cell_half, std::size_t count, std::vector<Cell>& cells) {
    for (std::size_t done = 0; done < count && !watch_.interrupted(); done += kBatch) {
      std::vector<Parameters> poses(std::min(kBatch, count - done));
      for (Parameters& pose : poses) pose = placed(centre, half, sequence_.next());
      evaluate(poses, cell_half, cells);
    }
  }

 private:
  [[nodiscard]] Parameters placed(const Parameters& centre, double half, const Unit& unit) const {
    Parameters pose = centre;
    for (std::size_t i = 0; i < kDimensions; ++i) {
      const double reach = half * space_.upper()[i];
      const double low = std::max(centre[i] - reach, space_.lower()[i]);
      const double high = std::min(centre[i] + reach, space_.upper()[i]);
      pose[i] = low + unit[i] * (high - low);
    }
    return pose;
  }

  void evaluate(const std::vector<Parameters>& poses, double cell_half, std::vector<Cell>& cells) {
    std::vector<Candidate> candidates;
    candidates.reserve(poses.size());
    for (const Parameters& pose : poses) candidates.push_back(space_.candidate(pose));
    // Corners are the square root of 3 farther than faces. Rotation vectors that differ by δ make rotations that differ
    // by at most |δ|.
    const double corner = std::sqrt(3.0) * cell_half;
    const PoseCell cell{corner * space_.upper()[0], corner * space_.upper()[3]};
    evaluator_.evaluate(candidates, landscape_.fitness, cell, landscape_.stride, evaluations_);
    watch_.count(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double rank = landscape_.rank(evaluations_[i].objective, asked_.broken(poses[i], candidates[i]));
      cells.push_back({{poses[i], rank}, evaluations_[i].objective_bound});
    }
  }

  const CandidateSpace& space_;
  CandidateEvaluator& evaluator_;
  const Requirements& asked_;
  const Landscape& landscape_;
  SearchWatch& watch_;
  LowDiscrepancySequence sequence_;
  std::vector<Evaluation> evaluations_;
};

/// Half the side of the cells that `count` samples divide a box into.
double divided(double half, std::size_t count) {
  return half * std::pow(static_cast<double>(count), -1.0 / static_cast<double>(kDimensions));
}

void best_first(std::vector<Cell>& cells) {
  std::ranges::stable_sort(cells, [](const Cell& a, const Cell& b) { return a.centre.objective > b.centre.objective; });
}

/// Drops what cannot hold anything better than what is known, then all but the best.
std::vector<Cell> promising(std::vector<Cell> cells) {
  best_first(cells);
  const double known = cells.front().centre.objective;
  std::erase_if(cells, [known](const Cell& cell) { return cell.bound < known; });
  cells.resize(std::min(cells.size(), kPromising));
  return cells;
}

/// Whether one lies in the other's cell.
bool close(const CandidateSpace& space, const Parameters& a, const Parameters& b, double half) {
  for (std::size_t i = 0; i < kDimensions; ++i)
    if (std::fabs(a[i] - b[i]) > half * space.upper()[i]) return false;
  return true;
}

}  // namespace

std::vector<Ranked> global_start(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
                                 const Landscape& landscape, const Sampling& sampling, SearchWatch& watch) {
  Sampler sampler(space, evaluator, asked, landscape, sampling.seed, watch);
  std::vector<Cell> all;
  sampler.sample(space.start(), 0.0, 0.0, 1, all);  // the start itself
  const std::size_t first = std::max<std::size_t>(sampling.samples / 2, 1);
  double half = divided(1.0, first);
  sampler.sample(space.start(), 1.0, half, first, all);
  const double separation = half;
  std::vector<Cell> cells = all;
  for (int round = 1; round < kRounds && !cells.empty(); ++round) {
    cells = promising(std::move(cells));
    const std::size_t each = sampling.samples / 2 / (kRounds - 1) / std::max<std::size_t>(cells.size(), 1);
    if (each == 0) break;
    std::vector<Cell> finer;
    for (const Cell& cell : cells) sampler.sample(cell.centre.parameters, half, divided(half, each), each, finer);
    half = divided(half, each);
    all.insert(all.end(), finer.begin(), finer.end());
    cells = std::move(finer);
  }

  best_first(all);
  std::vector<Ranked> starts;
  for (const Cell& cell : all) {
    const auto taken = [&](const Ranked& start) {
      return close(space, start.parameters, cell.centre.parameters, separation);
    };
    if (std::ranges::none_of(starts, taken)) starts.push_back(cell.centre);
    if (starts.size() == sampling.keep) break;
  }
  return starts;
}

}  // namespace verisq::fit_search
