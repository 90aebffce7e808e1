/// Stability over a box of parameters, by bisection into cells that are examined one by one.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/stance_stability.hpp>

#include "verify/equilibrium/standing_model.hpp"
#include "verify/stance/box_division.hpp"
#include "verify/stance/parameters.hpp"
#include "verify/stance/stability_cell.hpp"

namespace verisq::stance {
namespace {

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
