/// The path is cut into parts, each as long as one pair's certificate speaks for all of it.
#include "verisq/certified_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "verify/pairs/posed_body.hpp"
#include "verify/sets/cover_search.hpp"
#include "verify/sets/solid_pair_certificate.hpp"
#include "verify/sweep/posed_path.hpp"
#include "verisq/certified_distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

/// Beyond those that there are poses: where more would be needed, less is proven.
constexpr std::size_t most_further_parts = 16384;
/// Of the tolerance is left for what a part loses by its length.
constexpr double share_of_parts = 0.0625;
constexpr double share_of_moments = 0.25;

class PathProver {
 public:
  PathProver(std::span<const Pose> path, const Model& a, const Model& b, const PathDistanceOptions& options)
      : options_(options),
        path_(path),
        distances_(a, b, share_of_moments * options.tolerance),
        checker_(a, b, path),
        most_parts_(path.size() + most_further_parts) {
    if (!is_union_of_convex(a) || !is_union_of_convex(b)) places_ = {verify::ExactChecker(a), verify::ExactChecker(b)};
  }

  [[nodiscard]] CertifiedPath operator()(const PathDistance& found) {
    const double lower = found.smallest.lo;
    const bool apart = found.proximity == PathProximity::apart;
    // Of a contact anything above 0 tells that it is not yet there.
    goal_ = apart ? std::max(lower - share_of_parts * options_.tolerance, 0.5 * lower)
                  : std::numeric_limits<double>::denorm_min();
    prove_parts(apart ? path_.last_time() : found.apart_before);
    const double nearest = found.meet_at.value_or(found.smallest_at);
    certificate_.nearest = nearest;
    certificate_.at_nearest = distance_at(nearest).certificate;
    PathClaims claims = checker_.prove(certificate_, {});
    if (claims.smallest.lo > 0.0) claims.first_contact.reset();  // that there is none says nothing more
    return {claims, std::move(certificate_), interrupted_};
  }

 private:
  [[nodiscard]] bool stopped() {
    interrupted_ = interrupted_ || (options_.interrupted && options_.interrupted());
    return interrupted_;
  }

  [[nodiscard]] CertifiedDistance distance_at(double time) {
    return distances_(path_.rounded_pose(time), [this] { return stopped(); });
  }

  /// From the beginning on, as far as they reach the goal. A path of one pose is one part.
  void prove_parts(double end) {
    double begin = 0.0;
    do {
      const double until = std::min(end, begin + 1.0);
      if (!prove(begin, until, {})) return;
      begin = until;
    } while (begin < end);
  }

  /// Appends parts from `begin` to `end`, halved until each reaches the goal, or what may be hoped for there. `hint`
  /// was enough nearby. False where one proves nothing.
  [[nodiscard]] bool prove(double begin, double end, const PairCertificate& hint) {  // NOLINT(misc-no-recursion)
    if (stopped()) return false;
    for (const PairCertificate& known : {PairCertificate{}, hint}) {
      if (add_if(goal_, begin, {end, known})) return true;
    }
    const double middle = 0.5 * (begin + end);
    auto [distance, certificate] = distance_at(middle);
    const double hoped =
        distance.lo >= goal_ ? goal_ : std::max(distance.lo - share_of_moments * options_.tolerance, 0.5 * distance.lo);
    if (!(hoped > 0.0)) return false;
    for (SurroundedPrimitive& cover : certificate.covers_b) widen(cover, begin, end, hoped);
    const PathPart part{end, without_points(std::move(certificate))};
    if (add_if(hoped, begin, part)) return true;
    const bool spent = certificate_.parts.size() >= most_parts_ || !(begin < middle && middle < end);
    if (spent) return add_if(std::numeric_limits<double>::denorm_min(), begin, part);
    return prove(begin, middle, part.certificate) && prove(middle, end, part.certificate);
  }

  [[nodiscard]] bool add_if(double at_least, double begin, const PathPart& part) {
    if (!(checker_.lower(begin, part) >= at_least)) return false;
    certificate_.parts.push_back(part);
    if (options_.progress) options_.progress({goal_, infinity}, certificate_.parts.size());
    return true;
  }

  /// From the moment to all places in the part, to the distance that is hoped for; where that takes too many cells it
  /// proves nothing.
  void widen(SurroundedPrimitive& cover, double begin, double end, double hoped) {
    const auto& [a, b] = *places_;
    const auto& convex = std::get<verify::PosedSuperquadric>(b.primitives()[cover.primitive]);
    const verify::PosedBody body(convex, path_.motion_between(begin, end));
    const verify::EmptyNeighbourhood around(a.set(), a.primitives(), body, body.centre(), hoped);
    const auto cells = verify::cover_of(around, verify::most_cells_about_a_primitive, [this] { return stopped(); });
    if (cells) cover = {cover.primitive, hoped, *cells};
  }

  /// Points prove nothing from below.
  [[nodiscard]] static PairCertificate without_points(PairCertificate certificate) {
    for (Separation& separation : certificate.separations) separation.on_a = separation.on_b = {};
    certificate.near_points.reset();
    certificate.common.reset();
    return certificate;
  }

  const PathDistanceOptions& options_;
  verify::PosedPath path_;
  CertifiedDistances distances_;
  std::optional<std::array<verify::ExactChecker, 2>> places_;  ///< of models that have covers
  PathChecker checker_;
  std::size_t most_parts_;
  double goal_ = 0.0;
  PathCertificate certificate_;
  bool interrupted_ = false;
};

}  // namespace

CertifiedPath certified_path(std::span<const Pose> path, const Model& a, const Model& b, const PathDistance& found,
                             const PathDistanceOptions& options) {
  return PathProver(path, a, b, options)(found);
}

}  // namespace verisq
