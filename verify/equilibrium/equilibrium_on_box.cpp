/// Ranges at the ends of the box where a total derivative has a sign.
#include "verify/equilibrium/equilibrium_on_box.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "verify/equilibrium/located_equilibria.hpp"
#include "verify/equilibrium/standing_model.hpp"

namespace verisq::verify {
namespace {

/// Over a part of a box in whose `postures` there is but one equilibrium for each parameter. Nothing where that is not
/// located again.
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

/// Each component's ends at those of the box, where its derivatives have signs.
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

/// Where one equilibrium for each parameter is known, the derivatives next to it are enough.
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
