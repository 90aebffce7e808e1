/// The cells of a bisection as a tree, their postures a little wider than found.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "verify/proof/equilibrium_checker.hpp"
#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/standing.hpp"
#include "verify/stance/tree.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::stance {
namespace {

using Ranges = std::vector<Enclosure>;
using verify::PreciseInterval;
using verify::StandingBody;

bool lies_within(const Enclosure& inner, const Enclosure& outer) {
  return inner.lo >= outer.lo && inner.hi <= outer.hi;
}

/// By a share of each width, by a part of that of the largest, because errors of one unknown reach others, and by what
/// rounding may take.
Ranges widened(const Ranges& postures, double share) {
  constexpr double of_largest = 0.2;
  constexpr double of_size = 1e-12;
  double largest = 0.0;
  for (const Enclosure& side : postures) largest = std::fmax(largest, side.width());
  Ranges result;
  for (const Enclosure& side : postures) {
    const double size = 1.0 + std::fmax(std::fabs(side.lo), std::fabs(side.hi));
    const double more = share * (side.width() + of_largest * largest) + of_size * size;
    result.push_back({side.lo - more, side.hi + more});
  }
  return result;
}

/// What is proven of a part, beside what was found of all.
struct Comparison {
  double widest = 0.0;  ///< of what was found of this kind
  std::vector<std::pair<Enclosure, Enclosure>> numbers = {};

  void add(const PreciseInterval& proven, const Enclosure& found) {
    widest = std::fmax(widest, found.width());
    numbers.emplace_back(verify::outward(proven), found);
  }

  /// Whether the proof is much wider.
  [[nodiscard]] bool sticks_out() const {
    constexpr double worth = 0.03;
    constexpr double of_rounding = 1e-9;  // m, rad, N or N m
    const double more = worth * widest + of_rounding;
    return std::ranges::any_of(numbers, [more](const auto& number) {
      const auto& [proven, found] = number;
      return !lies_within(proven, {found.lo - more, found.hi + more});
    });
  }
};

bool sticks_out(const verify::EquilibriumRanges<PreciseInterval>& ranges, const StandingBody& body,
                const Standing& found) {
  Comparison angles;
  Comparison torques;
  Comparison forces;
  Comparison penetrations;
  Comparison pressure;
  for (std::size_t i = 0; i < body.joints.size(); ++i)
    angles.add(ranges.unknowns[i + 1], found.positions[body.joints[i]]);
  for (std::size_t i = 0; i < ranges.torques.size(); ++i) torques.add(ranges.torques[i], found.torques[i]);
  for (std::size_t c = 0; c < ranges.forces.size(); ++c) forces.add(ranges.forces[c], found.loads[c].force);
  for (std::size_t i = 0; i < ranges.penetrations.size(); ++i)
    penetrations.add(ranges.penetrations[i], found.loads[i / points_of_cylinder].penetration);
  pressure.add(ranges.pressure_x, found.centre_of_pressure_x);
  pressure.add(ranges.pressure_z, found.centre_of_pressure_z);
  const std::array all{&angles, &torques, &forces, &penetrations, &pressure};
  return std::ranges::any_of(all, [](const Comparison* kind) { return kind->sticks_out(); });
}

/// The parts of a cell that are proven to stand, as nearly as it was found.
class ProvenCell {
 public:
  ProvenCell(const StandingProblem& problem, const StandingBody& body, const Standing& found)
      : problem_(problem), body_(body), found_(found) {}

  /// In preorder.
  [[nodiscard]] std::vector<EquilibriumPart> parts_of(const EquilibriumCell& cell) const {
    return divided(cell.ranges, cell.postures, 0);
  }

 private:
  static constexpr std::size_t most_halvings = 9;            ///< for a proof at all
  static constexpr std::size_t most_halvings_for_width = 4;  ///< for a narrower one

  [[nodiscard]] std::vector<EquilibriumPart> divided(const Ranges& box, const Ranges& found_postures,
                                                     std::size_t halvings) const {
    bool is_wide = false;
    Ranges postures = proven_postures(box, found_postures, is_wide);
    const std::size_t most = postures.empty() ? most_halvings : is_wide ? most_halvings_for_width : 0;
    const std::optional<std::uint32_t> k = next_to_halve(box, halvings);
    if (halvings >= most || !k) return {{{}, std::move(postures)}};
    std::vector<EquilibriumPart> parts{{k, {}}};
    Ranges lower = box;
    Ranges upper = box;
    lower[*k].hi = upper[*k].lo = middle_of(box[*k]);
    for (const Ranges& half : {lower, upper}) {
      const std::vector<EquilibriumPart> of_half = divided(half, postures_of(half), halvings + 1);
      parts.insert(parts.end(), of_half.begin(), of_half.end());
    }
    return parts;
  }

  /// One parameter after the other, but for those whose ranges have no halves.
  [[nodiscard]] static std::optional<std::uint32_t> next_to_halve(const Ranges& box, std::size_t halvings) {
    for (std::size_t i = 0; i < box.size(); ++i) {
      const std::size_t k = (halvings + i) % box.size();
      const double middle = middle_of(box[k]);
      if (box[k].lo < middle && middle < box[k].hi) return static_cast<std::uint32_t>(k);
    }
    return std::nullopt;
  }

  /// Wide enough for the proof; empty where there is none.
  [[nodiscard]] Ranges proven_postures(const Ranges& box, const Ranges& found_postures, bool& is_wide) const {
    if (found_postures.empty()) return {};
    // The line of the proof leaves the equilibria, and is left by its errors, to second order.
    for (const double share : {0.1, 0.3, 1.0}) {
      Ranges postures = widened(found_postures, share);
      const auto proven = equilibrium_on(body_, box, postures);
      if (!proven) continue;
      is_wide = sticks_out(proven->ranges, body_, found_);
      return postures;
    }
    return {};
  }

  /// As they are found; empty where none are.
  [[nodiscard]] Ranges postures_of(const Ranges& part) const {
    Box box = parameter_box(problem_.model, problem_.parameters);
    for (std::size_t k = 0; k < part.size(); ++k) box[problem_.parameters[k]] = {part[k].lo, part[k].hi};
    const CellVerdict verdict = examine(problem_, box);
    Ranges postures;
    if (verdict.verdict != StandingVerdict::stands) return postures;
    for (const verify::Interval& side : named(problem_, verdict.components).unknowns)
      postures.push_back(verify::outward(side));
    return postures;
  }

  const StandingProblem& problem_;
  const StandingBody& body_;
  const Standing& found_;
};

/// A cell, and what is proven of it.
struct CertifiedCell {
  const Ranges* ranges;
  std::vector<EquilibriumPart> parts = {{}};
};

/// The parts that make these cells of a box: those that are missing are silent.
class PartTree {
 public:
  void grow(const Ranges& box, std::vector<const CertifiedCell*> cells) {
    if (cells.size() == 1 && *cells.front()->ranges == box) {
      parts.insert(parts.end(), cells.front()->parts.begin(), cells.front()->parts.end());
      return;
    }
    for (std::size_t k = 0; k < box.size() && !cells.empty(); ++k) {
      const Enclosure lower{box[k].lo, middle_of(box[k])};
      const Enclosure upper{lower.hi, box[k].hi};
      const auto is_lower = [&](const CertifiedCell* cell) { return lies_within((*cell->ranges)[k], lower); };
      const auto is_one_of_both = [&](const CertifiedCell* cell) {
        return is_lower(cell) != lies_within((*cell->ranges)[k], upper);
      };
      if (!std::ranges::all_of(cells, is_one_of_both)) continue;
      const auto rest = std::partition(cells.begin(), cells.end(), is_lower);
      parts.push_back({static_cast<std::uint32_t>(k), {}});
      Ranges half = box;
      half[k] = lower;
      grow(half, {cells.begin(), rest});
      half[k] = upper;
      grow(half, {rest, cells.end()});
      return;
    }
    parts.emplace_back();
  }

  std::vector<EquilibriumPart> parts;
};

bool is_silent(const EquilibriumPart& part) {
  return !part.halved && part.postures.empty();
}

}  // namespace

CertifiedEquilibrium certified_equilibrium(const Model& model, UncertainSet uncertain, JointControl control,
                                           const Equilibrium& found, const CheckOptions& options) {
  const StandingProblem problem = standing_problem(model, control, uncertain);
  const StandingBody body = verify::standing_body(model, control, uncertain, found.reference);
  std::vector<CertifiedCell> cells;
  cells.reserve(found.cells.size());
  for (const EquilibriumCell& cell : found.cells) cells.push_back({&cell.ranges});
  std::atomic<std::uint64_t> left_out{0};
  options.in_parallel(cells.size(), [&](std::size_t i) {
    const EquilibriumCell& cell = found.cells[i];
    if (cell.postures.empty() || options.interrupted()) return;
    cells[i].parts = ProvenCell(problem, body, *found.standing).parts_of(cell);
    if (std::ranges::any_of(cells[i].parts, is_silent)) ++left_out;
  });
  CertifiedEquilibrium result;
  result.left_out = left_out;
  EquilibriumClaims& claims = result.claims;
  claims = {control, {uncertain.begin(), uncertain.end()}, {}, 0.0, {}};
  for (const std::uint32_t k : uncertain) claims.ranges.push_back(model.parameters[k].range);
  std::vector<const CertifiedCell*> all;
  all.reserve(cells.size());
  for (const CertifiedCell& cell : cells) all.push_back(&cell);
  PartTree tree;
  tree.grow(claims.ranges, std::move(all));
  result.certificate = {found.reference, std::move(tree.parts)};
  const ProvenEquilibrium proven = prove(model, claims, result.certificate, options);
  claims.stands = proven.stands;
  claims.standing = proven.standing;
  result.interrupted = proven.interrupted;
  return result;
}

}  // namespace verisq::stance
