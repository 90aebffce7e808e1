/// Accelerations over a box, by adaptive bisection into cells that are proven one by one.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <optional>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance_analysis.hpp>

#include "verify/stance/acceleration_cell.hpp"
#include "verify/stance/acceleration_equations.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

/// The hull of samples, which only decides where to bisect: its rounding errors make no enclosure wrong.
class SampledHull {
 public:
  explicit SampledHull(const Eigen::VectorXd& first) : lowest_(first), highest_(first) {}

  void add(const Eigen::VectorXd& sample) {
    lowest_ = lowest_.cwiseMin(sample);
    highest_ = highest_.cwiseMax(sample);
  }

  /// How far an enclosure of component i sticks out, in widths of the hull. Where the hull is as thin as rounding
  /// errors, in those: a component that no parameter moves is no reason to bisect.
  [[nodiscard]] double excess(Eigen::Index i, const Interval& enclosure) const {
    constexpr double rounding = 1e-9;
    const double largest = std::fmax(lowest_.cwiseAbs().maxCoeff(), highest_.cwiseAbs().maxCoeff());
    const double width = highest_[i] - lowest_[i] + rounding * largest;
    return std::fmax(enclosure.upper() - highest_[i], lowest_[i] - enclosure.lower()) / width;
  }

 private:
  Eigen::VectorXd lowest_, highest_;
};

/// A cell of the bisected box.
struct Cell {
  Box box;
  std::vector<std::uint32_t> halvings;                   ///< of each variable
  std::optional<ParametricSolution> accelerations = {};  ///< of the cell, or of the cell that it is half of
  Eigen::VectorXd sample = {};                           ///< at the middle

  [[nodiscard]] double volume() const {
    double volume = 1.0;
    for (const std::uint32_t count : halvings) volume = std::ldexp(volume, -static_cast<int>(count));
    return volume;
  }
};

/// Bisects the box until no cell's enclosure sticks out of the sampled hull by much.
class Subdivision {
 public:
  Subdivision(const Model& model, UncertainSet uncertain, const AccelerationOptions& options)
      : model_(model),
        options_(options),
        most_halvings_(std::bit_width(std::max(options.cells, 1u) - 1)),
        whole_(parameter_box(model, uncertain)),
        variables_(acting_parameters(model, whole_, uncertain)),
        hull_(approximate_accelerations(model, middle_of(whole_))) {
    sample_corners();
  }

  [[nodiscard]] std::vector<Enclosure> run() {
    constexpr std::size_t batch_size = 64;
    std::vector<Cell> batch{{whole_, std::vector<std::uint32_t>(variables_.size(), 0)}};
    while (!batch.empty()) {
      enclose(batch);
      for (const Cell& cell : batch) hull_.add(cell.sample);
      for (Cell& cell : batch) open_.push_back(std::move(cell));
      batch.clear();
      if (options_.interrupted && options_.interrupted()) break;
      while (!open_.empty() && batch.size() < batch_size) {
        const Cell cell = std::move(open_.front());
        open_.pop_front();
        if (const auto variable = best_halving(cell)) {
          for (Cell& half : halves(cell, *variable)) batch.push_back(std::move(half));
        } else {
          include(cell);
        }
      }
      if (options_.progress) options_.progress(std::fmin(done_, 1.0));
    }
    for (const Cell& cell : open_) include(cell);
    return result();
  }

 private:
  /// Extremes of nearly monotone functions lie there.
  void sample_corners() {
    constexpr std::size_t most_variables = 8;
    const std::size_t count = std::min(variables_.size(), most_variables);
    for (std::uint32_t corner = 0; corner < (1u << count); ++corner) {
      std::vector<double> parameters = middle_of(whole_);
      for (std::size_t k = 0; k < count; ++k) {
        const Interval& side = whole_[variables_[k]];
        parameters[variables_[k]] = ((corner >> k) & 1u) != 0 ? side.upper() : side.lower();
      }
      hull_.add(approximate_accelerations(model_, parameters));
    }
  }

  /// Each cell by itself, so that the result does not depend on the number of threads.
  void enclose(std::vector<Cell>& cells) const {
    const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, cells.size());
    std::vector<std::jthread> workers;
    for (std::size_t first = 0; first < threads; ++first) {
      workers.emplace_back([&, first] {
        for (std::size_t i = first; i < cells.size(); i += threads) enclose(cells[i]);
      });
    }
  }

  void enclose(Cell& cell) const {
    cell.sample = approximate_accelerations(model_, middle_of(cell.box));
    auto accelerations = accelerations_over(model_, cell.box, variables_);
    // What holds for the whole holds for its half.
    if (accelerations) cell.accelerations = std::move(accelerations);
  }

  /// The variable whose halving promises to narrow the worst component most; none where nothing needs to be narrower,
  /// or may be.
  [[nodiscard]] std::optional<std::size_t> best_halving(const Cell& cell) const {
    constexpr double tolerance = 0.01;
    const auto worst = worst_component(cell);
    if (worst.excess <= tolerance) return std::nullopt;
    std::optional<std::size_t> best;
    double most = 0.0;
    for (std::size_t k = 0; k < variables_.size(); ++k) {
      if (cell.halvings[k] >= most_halvings_) continue;
      // Nothing proven: the widest part of the range, for want of a better measure.
      double gain = std::ldexp(1.0, -static_cast<int>(cell.halvings[k]));
      if (cell.accelerations) gain = cell.accelerations->overestimation[k][worst.component];
      if (gain > most) {
        most = gain;
        best = k;
      }
    }
    return best;
  }

  struct Worst {
    Eigen::Index component;
    double excess;
  };

  [[nodiscard]] Worst worst_component(const Cell& cell) const {
    Worst worst{0, infinity};
    if (!cell.accelerations) return worst;
    worst.excess = 0.0;
    for (Eigen::Index i = 0; i < cell.accelerations->solution.size(); ++i) {
      const double excess = hull_.excess(i, cell.accelerations->solution[i]);
      if (excess > worst.excess) worst = {i, excess};
    }
    return worst;
  }

  [[nodiscard]] std::array<Cell, 2> halves(const Cell& cell, std::size_t k) const {
    const Interval side = cell.box[variables_[k]];
    const double middle = std::clamp(0.5 * side.lower() + 0.5 * side.upper(), side.lower(), side.upper());
    std::array<Cell, 2> parts{cell, cell};
    parts[0].box[variables_[k]] = Interval(side.lower(), middle);
    parts[1].box[variables_[k]] = Interval(middle, side.upper());
    for (Cell& part : parts) ++part.halvings[k];
    return parts;
  }

  void include(const Cell& cell) {
    done_ += cell.volume();
    if (!cell.accelerations) {
      proven_ = false;
      return;
    }
    const IntervalVector& value = cell.accelerations->solution;
    if (enclosure_.size() == 0) enclosure_ = value;
    for (Eigen::Index i = 0; i < value.size(); ++i) enclosure_[i] = hull(enclosure_[i], value[i]);
  }

  [[nodiscard]] std::vector<Enclosure> result() const {
    std::vector<Enclosure> result(model_.degrees_of_freedom(), {-infinity, infinity});
    if (!proven_) return result;
    std::transform(enclosure_.begin(), enclosure_.end(), result.begin(), [](const Interval& component) {
      return Enclosure{component.lower(), component.upper()};
    });
    return result;
  }

  const Model& model_;
  const AccelerationOptions& options_;
  std::uint32_t most_halvings_;
  Box whole_;
  std::vector<std::uint32_t> variables_;
  SampledHull hull_;
  std::deque<Cell> open_ = {};
  IntervalVector enclosure_ = {};
  bool proven_ = true;
  double done_ = 0.0;
};

}  // namespace

std::vector<Enclosure> accelerations(const Model& model, UncertainSet uncertain, const AccelerationOptions& options) {
  return Subdivision(model, uncertain, options).run();
}

std::vector<double> sampled_accelerations(const Model& model, std::span<const double> parameters) {
  const Eigen::VectorXd sample = approximate_accelerations(model, {parameters.begin(), parameters.end()});
  return {sample.begin(), sample.end()};
}

}  // namespace verisq::stance
