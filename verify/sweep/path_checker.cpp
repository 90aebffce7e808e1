/// The lower end is that of all parts of the path, the upper end that of one time.
#include <algorithm>
#include <cmath>

#include "verify/pairs/model_pair.hpp"
#include "verify/placement/check_steps.hpp"
#include "verify/placement/path_check.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/judgement.hpp"
#include "verify/sweep/posed_path.hpp"
#include "verisq/path_certificate.hpp"

namespace verisq {

struct PathChecker::State {
  /// Of a distance: at least 0; 0 of what is no part of the path between two poses.
  [[nodiscard]] double lower(double begin, const PathPart& part) const {
    const double until = part.until;
    const bool all_at_rest = path.last_time() == 0.0 && begin == 0.0 && until == 0.0;
    if (!(begin >= 0.0 && until <= path.last_time()) || !(begin < until || all_at_rest)) return 0.0;
    if (until > std::floor(begin) + 1.0) return 0.0;
    return models.lower(path.motion_between(begin, until), part.certificate);
  }

  /// At `nearest`; infinity of a time that is none of the path.
  [[nodiscard]] double upper(const PathCertificate& certificate) const {
    const double time = certificate.nearest;
    if (!(time >= 0.0 && time <= path.last_time())) return infinity;
    return models.distance(path.enclosed_pose(time), certificate.at_nearest).hi;
  }

  verify::ModelPair models;
  verify::PosedPath path;
};

PathChecker::PathChecker(const Model& a, const Model& b, std::span<const Pose> path) {
  check_path(path);
  check_turns(path);
  state_ = std::make_unique<State>(State{verify::ModelPair(a, b), verify::PosedPath(path)});
}
PathChecker::~PathChecker() = default;
PathChecker::PathChecker(PathChecker&&) noexcept = default;
PathChecker& PathChecker::operator=(PathChecker&&) noexcept = default;

double PathChecker::lower(double begin, const PathPart& part) const {
  return state_->lower(begin, part);
}

// A part begins where the one before ends: what is proven is proven up to `begin`.
PathClaims PathChecker::prove(const PathCertificate& certificate, const CheckOptions& options) const {
  const std::vector<PathPart>& parts = certificate.parts;
  std::vector<double> lower(parts.size(), 0.0);
  verify::CheckSteps(parts.size(), options).each(parts.size(), [&](std::size_t k) {
    lower[k] = state_->lower(k == 0 ? 0.0 : parts[k - 1].until, parts[k]);
  });
  const double end = state_->path.last_time();
  double least = infinity;
  double begin = 0.0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (lower[k] == 0.0) break;  // neither a distance nor a contact is known from here on
    least = std::min(least, lower[k]);
    begin = parts[k].until;
  }
  const bool whole = begin == end && least < infinity;
  const double upper = state_->upper(certificate);
  const double meet_at = upper == 0.0 ? certificate.nearest : infinity;
  return {
      verify::between(whole ? least : 0.0, upper, [] { return "the smallest distance of the models on their way"; }),
      verify::between(whole ? infinity : begin, meet_at, [] { return "the first contact of the models"; })};
}

PathFindings check(const PathClaims& claimed, const PathClaims& proven) {
  PathFindings findings{verify::judged(claimed.smallest, proven.smallest, proven.smallest), std::nullopt};
  const Enclosure& contact = *proven.first_contact;
  if (claimed.first_contact) findings.first_contact = verify::judged(*claimed.first_contact, contact, contact);
  return findings;
}

}  // namespace verisq
