/// Proves the smallest distance of two models of which one moves, and when they first meet, again: by MPFR alone,
/// without search.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>
#include <verisq/check_options.hpp>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/pair_certificate.hpp>

namespace verisq {

/// What is said of a path. Time k is that of pose k.
struct PathClaims {
  Enclosure smallest;  ///< contains the smallest distance of all times
  /// Contains the first time at which the models have a common point, infinity where they never have one; nothing is
  /// said without.
  std::optional<Enclosure> first_contact = {};

  [[nodiscard]] bool operator==(const PathClaims&) const = default;
};

/// Of a time, and of all the part about it: the certificate is of the distance at its middle, (begin + until) / 2 to
/// nearest; of its separations the vectors alone count, of all else divisions, balls and
/// covers, those about primitives of B of all places in the part (docs/mathematics.md §26).
struct PathPart {
  double until;  ///< the time when it ends; it begins where the part before ends, the first at 0; within two poses
  PairCertificate certificate;
};

/// What proves the claims, whatever it holds.
struct PathCertificate {
  double nearest = 0.0;        ///< a time, at which the distance is at most that of the claim
  PairCertificate at_nearest;  ///< of the distance at that time: its upper end, and the common point of a contact
  std::vector<PathPart> parts;
};

/// Of a claim each.
struct PathFindings {
  Finding smallest;
  std::optional<Finding> first_contact;  ///< where that is claimed
};

/// B moves by the poses, after its primitives' own, A rests in its frame, as distance_along says. Immutable after
/// construction: safe to call from many threads.
class PathChecker {
 public:
  /// Throws Error(input) for a path without poses, for poses that are not finite or have a zero quaternion, and for
  /// half a turn from one pose to the next, which has two ways.
  PathChecker(const Model& a, const Model& b, std::span<const Pose> path);
  ~PathChecker();
  PathChecker(PathChecker&&) noexcept;
  PathChecker& operator=(PathChecker&&) noexcept;

  /// What the certificate proves, whatever it holds; of the first contact [0, infinity] if nothing. Once interrupted
  /// less.
  [[nodiscard]] PathClaims prove(const PathCertificate& certificate, const CheckOptions& options) const;

  /// The distance is no less at any time from `begin` to the part's end; 0 where nothing is proven.
  [[nodiscard]] double lower(double begin, const PathPart& part) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What is proven says of each claim: never `proved` of one that is not true. Precondition: `claimed` holds no NaN;
/// `proven` by PathChecker::prove.
[[nodiscard]] PathFindings check(const PathClaims& claimed, const PathClaims& proven);

}  // namespace verisq
