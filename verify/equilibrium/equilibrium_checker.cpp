/// Every part of the box by its postures, all of them together by their volumes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "verify/equilibrium/equilibrium_on_box.hpp"
#include "verify/equilibrium/standing_model.hpp"
#include "verify/placement/check_steps.hpp"
#include "verify/proof/judgement.hpp"
#include "verisq/equilibrium_certificate.hpp"

namespace verisq::stance {

using verify::Direction;
using verify::nothing_known;
using verify::PreciseInterval;
using verify::ProvenBox;
using verify::Real;
using verify::StandingBody;

namespace {

using Ranges = std::vector<Enclosure>;

/// A part of the box that is said to stand.
struct Leaf {
  Ranges ranges;  ///< of the uncertain parameters
  std::span<const Enclosure> postures;
};

/// The parts that are cut no further, and that something is said of: as far as the certificate is whole.
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
  /// Whether they are all of the box.
  [[nodiscard]] bool are_whole() const { return is_whole_; }

 private:
  /// Where a side is cut does not matter to what is proved, as long as both halves are boxes that share no volume. What
  /// has no such halves, a point say, has parts that nothing is said of: they would be counted twice.
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

/// Of the whole box, about: 1 of a side that is a point.
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

/// Of numbers that lie in `a` and in `b`, one each: the least is no more than `hi`, the greatest no less than `lo`.
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
