/// This file implements equilibrium_checker.hpp.
#include "verify/proof/equilibrium_checker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <verisq/error.hpp>

#include "verify/proof/check_steps.hpp"
#include "verify/proof/located_equilibria.hpp"
#include "verify/proof/verdict.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::stance {
namespace {

constexpr std::uint8_t vertical = 1;

void require_stand(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, "equilibrium: " + message);
}

}  // namespace

void require_standing_model(const Model& model) {
  require_stand(!model.cylinders.empty(), "the model has no cylinder to stand on");
  const std::vector<Joint>& joints = model.bodies.front().joints;
  std::array<int, 3> turns{};
  int heights = 0;
  bool turned = false;
  for (const Joint& joint : joints) {
    if (joint.kind == JointKind::rotation) ++turns[joint.axis];
    if (joint.kind == JointKind::translation && joint.axis == vertical) ++heights;
    require_stand(joint.kind == JointKind::rotation || !turned,
                  "the root's joint " + joint.name + " is a translation after a rotation");
    turned = turned || joint.kind == JointKind::rotation;
  }
  require_stand(heights == 1 && turns[0] == 1 && turns[2] == 1,
                "the root needs one translation along y and one rotation about each of x and z");
  for (const std::size_t k : {0U, 2U}) {
    const Quantity& force = model.applied.force[k];
    require_stand(force.nominal == 0.0 && force.range == Enclosure{0.0, 0.0},
                  std::string("the applied force has a part along ") + (k == 0 ? "x" : "z") +
                      ", which friction alone could hold: it must be 0");
  }
  for (const Controller& controller : model.controllers)
    require_stand(controller.body != 0, "the root has a controller, and nothing to push against");
}

std::vector<std::size_t> sought_joints(const Model& model, JointControl control) {
  std::vector<std::size_t> sought;
  const std::vector<Joint>& root = model.bodies.front().joints;
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (root[i].kind == JointKind::rotation && root[i].axis != vertical) sought.push_back(i);
  }
  if (control == JointControl::held) return sought;
  for (std::size_t i = root.size(); i < model.degrees_of_freedom(); ++i) sought.push_back(i);
  return sought;
}

std::size_t height_of_root(const Model& model) {
  const auto up = [](const Joint& joint) { return joint.kind == JointKind::translation && joint.axis == vertical; };
  const std::vector<Joint>& joints = model.bodies.front().joints;
  return static_cast<std::size_t>(std::ranges::find_if(joints, up) - joints.begin());
}

std::vector<double> stiffness_of_joints(const Model& model) {
  std::vector<double> result(model.degrees_of_freedom(), 0.0);
  for (const Controller& controller : model.controllers)
    result[joint_index(model, controller.body, controller.joint)] = controller.proportional;
  return result;
}

std::size_t joint_index(const Model& model, std::size_t body, std::size_t joint) {
  for (std::size_t i = 0; i < body; ++i) joint += model.bodies[i].joints.size();
  return joint;
}

}  // namespace verisq::stance

namespace verisq::verify {

stance::Standing uniform(const stance::Model& model, std::span<const std::size_t> sought, const Enclosure& number) {
  std::vector<Enclosure> positions;
  for (const stance::Body& body : model.bodies) {
    for (const stance::Joint& joint : body.joints) positions.push_back({joint.position, joint.position});
  }
  for (const std::size_t joint : sought) positions[joint] = number;
  positions[height_of_root(model)] = number;
  return {std::move(positions),
          std::vector<Enclosure>(model.degrees_of_freedom(), number),
          std::vector<stance::CylinderLoad>(model.cylinders.size(), {number, number}),
          number,
          number,
          number};
}

namespace {

/// Ranges over a part of a box, for `postures` with exactly one equilibrium for each parameter. Nothing if the
/// equilibrium is not located again.
std::optional<PreciseBox> ranges_of_part(const StandingBody& body, const PreciseBox& part, const PreciseBox& postures,
                                         PreciseBox about) {
  constexpr int passes = 2;  // each squares the errors
  std::optional<PreciseBox> result;
  for (int i = 0; i < passes; ++i) {
    const auto located = LocatedEquilibria::in(body, part, common(about, postures));
    if (!located) break;
    result = located->ranges();
    about = located->about(part);
  }
  return result;
}

/// Evaluates each component's ends at the ends of the box, for the variables whose derivatives have a sign.
class RangesOfBox {
 public:
  RangesOfBox(const StandingBody& body, const PreciseBox& box, const PreciseBox& postures,
              const LocatedEquilibria& located)
      : body_(body), box_(box), postures_(postures), located_(located), whole_(located.ranges()) {
    for (std::size_t k = 0; k < located.variables().size(); ++k) derivatives_.push_back(located.derivatives_by(k));
  }

  [[nodiscard]] PreciseBox operator()() {
    PreciseBox result;
    for (std::size_t c = 0; c < whole_.size(); ++c) {
      const Real lower = std::max(at_end(c, false).lower(), whole_[c].lower());
      const Real upper = std::min(at_end(c, true).upper(), whole_[c].upper());
      result.emplace_back(lower, upper);
    }
    return result;
  }

 private:
  /// For each variable: its lower end (-1), its upper end (1), or its range.
  using Ends = std::vector<int>;

  PreciseInterval at_end(std::size_t component, bool largest) {
    Ends ends;
    for (const std::optional<PreciseBox>& derivative : derivatives_) {
      int sign = 0;
      if (derivative && (*derivative)[component].lower() >= Real(0)) sign = 1;
      if (derivative && (*derivative)[component].upper() <= Real(0)) sign = -1;
      ends.push_back(largest ? sign : -sign);
    }
    return ranges_at(ends)[component];
  }

  const PreciseBox& ranges_at(const Ends& ends) {
    if (std::ranges::count(ends, 0) == std::ssize(ends)) return whole_;
    const auto known = known_.find(ends);
    if (known != known_.end()) return known->second;
    PreciseBox part = box_;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      PreciseInterval& side = part[located_.variables()[k]];
      if (ends[k] < 0) side = side.lower();
      if (ends[k] > 0) side = side.upper();
    }
    const auto ranges = ranges_of_part(body_, part, postures_, located_.about(part));
    return known_.emplace(ends, ranges ? *ranges : whole_).first->second;
  }

  const StandingBody& body_;
  const PreciseBox& box_;
  const PreciseBox& postures_;
  const LocatedEquilibria& located_;
  PreciseBox whole_;
  std::vector<std::optional<PreciseBox>> derivatives_;
  std::map<Ends, PreciseBox> known_;
};

EquilibriumRanges<PreciseInterval> named(const StandingBody& body, const PreciseBox& list) {
  return named<PreciseInterval>(list, body.unknowns(), body.model);
}

/// The derivatives near the line are enough, once exactly one equilibrium is known for each parameter.
LocatedEquilibria narrowed(const StandingBody& body, const PreciseBox& box, const PreciseBox& postures,
                           LocatedEquilibria located) {
  constexpr int passes = 3;
  for (int i = 0; i < passes; ++i) {
    auto again = LocatedEquilibria::in(body, box, common(located.about(box), postures));
    if (!again) break;
    located = *std::move(again);
  }
  return located;
}

std::optional<ProvenBox> proven_on(const StandingBody& body, const PreciseBox& box, const PreciseBox& postures) {
  auto found = LocatedEquilibria::in(body, box, postures);
  if (!found) return std::nullopt;
  const LocatedEquilibria located = narrowed(body, box, postures, *std::move(found));
  const EquilibriumRanges<PreciseInterval> ranges = named(body, RangesOfBox(body, box, postures, located)());
  const auto presses = [](const PreciseInterval& penetration) { return penetration.lower() > Real(0); };
  if (!std::ranges::all_of(ranges.penetrations, presses)) return std::nullopt;
  PreciseBox middle;
  for (const PreciseInterval& side : box) middle.push_back(side.lower() < side.upper() ? exact(middle_of(side)) : side);
  const auto some = ranges_of_part(body, middle, postures, located.about(middle));
  return ProvenBox{ranges, some ? named(body, *some) : ranges};
}

}  // namespace

StandingBody standing_body(const stance::Model& model, stance::JointControl control, stance::UncertainSet uncertain,
                           const Point& reference) {
  stance::require_standing_model(model);
  return {model,
          control,
          {uncertain.begin(), uncertain.end()},
          reference,
          stance::sought_joints(model, control),
          stance::stiffness_of_joints(model)};
}

std::optional<ProvenBox> equilibrium_on(const StandingBody& body, std::span<const Enclosure> parameters,
                                        std::span<const Enclosure> postures) {
  try {
    const auto side = [](const Enclosure& range) { return PreciseInterval(Real(range.lo), Real(range.hi)); };
    PreciseBox box;
    for (const stance::Parameter& parameter : body.model.parameters) box.push_back(exact(parameter.nominal));
    for (std::size_t k = 0; k < parameters.size(); ++k) box[body.uncertain[k]] = side(parameters[k]);
    PreciseBox sides;
    std::ranges::transform(postures, std::back_inserter(sides), side);
    return proven_on(body, box, sides);
  } catch (const std::domain_error&) {  // a cylinder that stands upright, an empty range
    return std::nullopt;
  }
}

}  // namespace verisq::verify

namespace verisq::stance {

using verify::Direction;
using verify::nothing_known;
using verify::PreciseInterval;
using verify::ProvenBox;
using verify::Real;
using verify::StandingBody;

namespace {

using Ranges = std::vector<Enclosure>;

/// A part of the box on which the certificate claims a standing equilibrium.
struct Leaf {
  Ranges ranges;  ///< of the uncertain parameters
  std::span<const Enclosure> postures;
};

/// The parts that are cut no further and have postures in the certificate, as far as the certificate is whole.
class Leaves {
 public:
  Leaves(const std::vector<EquilibriumPart>& parts, const Ranges& whole) {
    std::vector<std::optional<Ranges>> open{whole};
    for (const EquilibriumPart& part : parts) {
      if (open.empty()) break;
      std::optional<Ranges> box = std::move(open.back());
      open.pop_back();
      if (part.halved) {
        halve(open, std::move(box), *part.halved);
      } else if (box && !part.postures.empty()) {
        leaves_.push_back({*std::move(box), part.postures});
      } else {
        is_whole_ = false;
      }
    }
    is_whole_ = is_whole_ && open.empty();
  }

  [[nodiscard]] const std::vector<Leaf>& all() const { return leaves_; }
  /// Returns whether the parts cover all of the box.
  [[nodiscard]] bool are_whole() const { return is_whole_; }

 private:
  /// The place of a cut does not matter to the proof, if both halves are boxes that share no volume. A box without such
  /// halves, such as a point, gets parts without postures: else they would be counted twice.
  static void halve(std::vector<std::optional<Ranges>>& open, std::optional<Ranges> box, std::size_t k) {
    const double middle = box && k < box->size() ? middle_of((*box)[k]) : 0.0;
    if (!box || k >= box->size() || !((*box)[k].lo < middle && middle < (*box)[k].hi)) {
      open.resize(open.size() + 2);
      return;
    }
    Ranges upper = *box;
    upper[k].lo = middle;
    (*box)[k].hi = middle;
    open.emplace_back(std::move(upper));
    open.push_back(std::move(box));
  }

  std::vector<Leaf> leaves_;
  bool is_whole_ = true;
};

/// The approximate share of the whole box; a side that is a point counts as 1.
PreciseInterval share_of(const Ranges& part, const Ranges& whole) {
  PreciseInterval share = 1;
  for (std::size_t k = 0; k < part.size(); ++k) {
    if (!(whole[k].lo < whole[k].hi)) continue;
    const auto width = [](const Enclosure& side) {
      return PreciseInterval(Real(side.hi)) - PreciseInterval(Real(side.lo));
    };
    share = share * (width(part[k]) / width(whole[k]));
  }
  return share;
}

/// For numbers of which one lies in `a` and one in `b`: the least is no more than `hi`, the greatest no less than `lo`.
Enclosure reached(const Enclosure& a, const Enclosure& b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}

}  // namespace

ProvenEquilibrium prove(const Model& model, const EquilibriumClaims& claims, const EquilibriumCertificate& certificate,
                        const CheckOptions& options) {
  const StandingBody body = verify::standing_body(model, claims.control, claims.uncertain, certificate.reference);
  const Leaves leaves(certificate.parts, claims.ranges);
  const std::vector<Leaf>& all = leaves.all();
  std::vector<std::optional<ProvenBox>> proven(all.size());
  verify::CheckSteps(all.size(), options).each(all.size(), [&](std::size_t i) {
    const Leaf& leaf = all[i];
    if (leaf.postures.size() == body.unknowns()) proven[i] = equilibrium_on(body, leaf.ranges, leaf.postures);
  });

  ProvenEquilibrium result;
  result.parts = all.size();
  result.interrupted = options.interrupted();
  if (result.interrupted) return result;
  PreciseInterval share = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!proven[i]) {
      ++result.unproved_parts;
      continue;
    }
    share += share_of(all[i].ranges, claims.ranges);
    if (!result.standing) result.standing = verify::uniform(model, body.joints, verify::nothing_yet);
    if (!result.of_some) result.of_some = verify::uniform(model, body.joints, nothing_known);
    verify::add(*result.standing, model, body.joints, proven[i]->ranges, hull);
    verify::add(*result.of_some, model, body.joints, proven[i]->some, reached);
  }
  const bool all_stands = leaves.are_whole() && result.unproved_parts == 0;
  result.stands = all_stands ? 1.0 : std::min(share.lower().to_double(Direction::down), std::nextafter(1.0, 0.0));
  if (result.unproved_parts > 0) result.standing = verify::uniform(model, body.joints, nothing_known);
  return result;
}

std::vector<Enclosure> numbers_of(const Standing& standing) {
  std::vector<Enclosure> numbers = standing.positions;
  numbers.insert(numbers.end(), standing.torques.begin(), standing.torques.end());
  for (const CylinderLoad& load : standing.loads) {
    numbers.push_back(load.force);
    numbers.push_back(load.penetration);
  }
  numbers.push_back(standing.centre_of_pressure_x);
  numbers.push_back(standing.centre_of_pressure_z);
  numbers.push_back(standing.least_penetration);
  return numbers;
}

std::vector<Finding> check(const EquilibriumClaims& claims, const ProvenEquilibrium& proven) {
  std::vector<Finding> findings{verify::judged({claims.stands, 1.0}, {proven.stands, 1.0}, nothing_known)};
  if (!claims.standing) return findings;
  const std::vector<Enclosure> claimed = numbers_of(*claims.standing);
  const std::vector<Enclosure> unknown(claimed.size(), nothing_known);
  const std::vector<Enclosure> ranges = proven.standing ? numbers_of(*proven.standing) : unknown;
  const std::vector<Enclosure> some = proven.of_some ? numbers_of(*proven.of_some) : unknown;
  for (std::size_t i = 0; i < claimed.size(); ++i) findings.push_back(verify::judged(claimed[i], ranges[i], some[i]));
  return findings;
}

}  // namespace verisq::stance
