/// Soundness for pairs of solids: no enclosure of their distance misses it, no box misses the closest points.
///
/// The random pairs of tests/oracle/random_pairs.hpp, of the solids of the paper's Table 5 and of random solids,
/// against MPFR at 200 bits. VERISQ_PAIR_CASES sets the number of pairs a combination. The full run is
///   VERISQ_PAIR_CASES=10000 build/release/tests/soundness_test --gtest_filter='*PairSoundness*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/containment.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/pair_reference.hpp"
#include "tests/oracle/published_solids.hpp"
#include "tests/oracle/random_pairs.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t usual_cases = 300;

[[nodiscard]] std::size_t requested_cases() {
  return requested_count("VERISQ_PAIR_CASES", usual_cases);
}

/// Two superquadrics, or none for random ones.
struct Combination {
  std::string_view name;
  std::optional<std::pair<Superquadric, Superquadric>> superquadrics;
};

/// One pair with what PairDistance says about it and the reference.
struct Case {
  RandomPair pair;
  PairReference reference;
  ModelDistance found;
  std::optional<ClosestPoints> closest;

  Case(std::uint64_t index, const Combination& combination) {
    RandomCases random(index);
    pair = combination.superquadrics
               ? random_pair(random, combination.superquadrics->first, combination.superquadrics->second)
               : random_pair(random);
    // Every other time B's pose comes with the query instead of the model.
    Primitive b = pair.b;
    Pose motion;
    if (index % 2 == 1) std::swap(b.pose, motion);
    const PairDistance distance(Model{"", {pair.a}}, Model{"", {b}});
    found = distance(motion);
    closest = distance.closest_points(found, motion);
    reference =
        reference_distance(PosedSolid(pair.a.superquadric, pair.a.pose), PosedSolid(pair.b.superquadric, pair.b.pose));
  }

  /// The largest semi-axis of both.
  [[nodiscard]] double size() const {
    const auto largest = [](const Primitive& p) {
      return *std::max_element(p.superquadric.semi_axes.begin(), p.superquadric.semi_axes.end());
    };
    return std::max(largest(pair.a), largest(pair.b));
  }
};

[[nodiscard]] bool misses(const std::array<Enclosure, 3>& box, const Vector& point, const Real& reach) {
  for (std::size_t k = 0; k < 3; ++k) {
    // A NaN end misses as well.
    if (!(Real(box[k].lo) <= point[k] + reach && Real(box[k].hi) >= point[k] - reach)) return true;
  }
  return false;
}

/// What is wrong with one case, in one line that reproduces it.
[[nodiscard]] std::optional<std::string> defect(const Case& c) {
  if (const auto line = escape(c.found.distance, c.pair.a, c.pair.b, c.reference)) return line;
  const auto evidence = [&](std::string_view what) {
    // An enclosure that escapes for certain makes the line that reproduces the case.
    const auto line = escape({1.0, 0.0}, c.pair.a, c.pair.b, c.reference);
    return fmt::format("{}; {}", what, *line);
  };
  if (c.found.proximity == Proximity::separated && c.reference.common) return evidence("overlap called separated");
  if (c.found.proximity == Proximity::overlapping && c.reference.lower > 0) return evidence("gap called overlap");
  if (!c.closest) return std::nullopt;
  if (c.found.proximity != Proximity::separated) return evidence("closest points of solids that are not separated");
  if (!c.reference.reach) return std::nullopt;
  if (misses(c.closest->on_a, c.reference.on_a, *c.reference.reach))
    return evidence("closest point of A not in its box");
  if (misses(c.closest->on_b, c.reference.on_b, *c.reference.reach))
    return evidence("closest point of B not in its box");
  return std::nullopt;
}

[[nodiscard]] double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// What is said about one family of pairs, or all.
struct FamilyTally {
  std::size_t cases = 0;
  std::size_t escapes = 0;
  std::size_t separated = 0;
  std::size_t overlapping = 0;
  std::size_t unique = 0;    ///< of the separated
  std::size_t compared = 0;  ///< boxes against closest points
  std::size_t loose_references = 0;
  std::vector<double> widths;           ///< in units of the size
  std::vector<double> relative_widths;  ///< of the separated, in units of the distance
  std::vector<double> box_sides;        ///< largest side of the boxes of the unique, in units of the size

  void add(const Case& c, bool escaped) {
    ++cases;
    escapes += escaped ? 1 : 0;
    loose_references += c.reference.upper - c.reference.lower > 1e-20 * c.size() ? 1 : 0;
    overlapping += c.found.proximity == Proximity::overlapping ? 1 : 0;
    widths.push_back(c.found.distance.width() / c.size());
    if (c.found.proximity == Proximity::separated) {
      ++separated;
      relative_widths.push_back(c.found.distance.width() / c.found.distance.lo);
    }
    compared += c.closest && c.reference.reach ? 1 : 0;
    if (c.closest && c.closest->unique) {
      ++unique;
      double side = 0.0;
      for (const auto& box : {c.closest->on_a, c.closest->on_b}) {
        for (const Enclosure& interval : box) side = std::max(side, interval.width());
      }
      box_sides.push_back(side / c.size());
    }
  }

  void print(std::string_view name) const {
    const double part = static_cast<double>(unique) / static_cast<double>(std::max<std::size_t>(1, separated));
    fmt::print("{:<18}{:>7}{:>9}{:>11}{:>9}{:>11.2g}{:>11.2g}{:>11.2g}{:>11.2g}{:>9.2f} %{:>9}{:>11.2g}{:>11.2g}\n",
               name, cases, escapes, separated, overlapping, quantile(relative_widths, 0.5),
               quantile(relative_widths, 0.999), quantile(widths, 0.5), quantile(widths, 0.999), 100 * part, compared,
               quantile(box_sides, 0.5), quantile(box_sides, 0.99));
  }
};

class Tally {
 public:
  void add(const Case& c) {
    const std::optional<std::string> line = defect(c);
    const std::lock_guard lock(mutex_);
    if (line && evidence_.size() < most_evidence) evidence_.push_back(*line);
    all_.add(c, line.has_value());
    families_[to_string(c.pair.family)].add(c, line.has_value());
  }

  void print(std::string_view combination) const {
    fmt::print("{:<18}{:>7}{:>9}{:>11}{:>9}{:>22}{:>22}{:>11}{:>9}{:>22}\n", combination, "", "", "", "",
               "width / distance", "width / size", "unique", "boxes", "box side / size");
    fmt::print("{:<18}{:>7}{:>9}{:>11}{:>9}{:>11}{:>11}{:>11}{:>11}{:>11}{:>9}{:>11}{:>11}\n", "", "cases", "escapes",
               "separated", "overlap", "median", "99.9 %", "median", "99.9 %", "", "compared", "median", "99 %");
    for (const auto& [name, family] : families_) family.print(fmt::format("  {}", name));
    all_.print("  all");
  }

  void expect_sound() const {
    EXPECT_GT(all_.separated, 0U);
    EXPECT_GT(all_.overlapping, 0U);
    EXPECT_LE(all_.loose_references, 1 + all_.cases / 10'000) << "the reference itself failed to converge";
    EXPECT_EQ(all_.escapes, 0U) << "of " << all_.cases << " cases";
    for (const std::string& line : evidence_) ADD_FAILURE() << line;
  }

 private:
  static constexpr std::size_t most_evidence = 20;

  std::mutex mutex_;
  std::map<std::string_view, FamilyTally> families_;
  FamilyTally all_;
  std::vector<std::string> evidence_;
};

class PairSoundnessTest : public testing::TestWithParam<Combination> {};

TEST_P(PairSoundnessTest, ContainsTheReference) {
  Tally tally;
  in_parallel(requested_cases(), [&](std::size_t i) { tally.add(Case(i, GetParam())); });
  tally.print(GetParam().name);
  tally.expect_sound();
}

[[nodiscard]] std::vector<Combination> combinations() {
  const auto& [capsule, gem, soap] = published_solids;
  return {{"capsule_gem", std::pair(capsule.superquadric, gem.superquadric)},
          {"gem_soap", std::pair(gem.superquadric, soap.superquadric)},
          {"capsule_soap", std::pair(capsule.superquadric, soap.superquadric)},
          {"random", std::nullopt}};
}

INSTANTIATE_TEST_SUITE_P(Combinations, PairSoundnessTest, testing::ValuesIn(combinations()),
                         [](const auto& pair) { return std::string(pair.param.name); });

}  // namespace
}  // namespace verisq::oracle
