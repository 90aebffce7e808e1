/// The smallest distance of two models while one of them moves, and its certificate.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/hidden.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Proves the smallest distance of two models of which one moves, and when they first meet, again: by MPFR alone,
// without search.

/// The claims about a path. Time k is that of pose k.
struct PathClaims {
  Enclosure smallest;  ///< contains the smallest distance of all times
  /// Contains the first time at which the models have a common point, infinity where they never have one; nothing is
  /// said without.
  std::optional<Enclosure> first_contact = {};

  [[nodiscard]] bool operator==(const PathClaims&) const = default;
};

/// A part of a path. Its certificate is about the distance at its middle, (begin + until) / 2 to nearest. For the whole
/// part, only the vectors of its separations count, and the divisions, balls and covers; those about primitives of B
/// hold for all places in the part (docs/mathematics.md §26).
struct PathPart {
  double until;  ///< the time when it ends; it begins where the part before ends, the first at 0; within two poses
  PairCertificate certificate;
};

/// The certificate of the claims.
struct PathCertificate {
  double nearest = 0.0;        ///< a time, at which the distance is at most that of the claim
  PairCertificate at_nearest;  ///< of the distance at that time: its upper end, and the common point of a contact
  std::vector<PathPart> parts;
};

/// One finding a claim.
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

  /// Returns what the certificate proves, whatever it holds: [0, infinity] for the first contact if it proves nothing.
  /// Once interrupted, it proves less.
  [[nodiscard]] PathClaims prove(const PathCertificate& certificate, const CheckOptions& options) const;

  /// The distance is no less at any time from `begin` to the part's end; 0 where nothing is proven.
  [[nodiscard]] double lower(double begin, const PathPart& part) const;

 private:
  struct State;
  Hidden<State> state_;
};

/// Judges each claim: never `proved` for one that is not true. Precondition: `claimed` holds no NaN;
/// `proven` by PathChecker::prove.
[[nodiscard]] PathFindings check(const PathClaims& claimed, const PathClaims& proven);

// The distance of two models of which one moves along a path of poses, at all times and not at the poses alone.

enum class PathProximity : std::uint8_t {
  apart,      ///< proven: no common point at any time
  meeting,    ///< proven: a common point at some time
  undecided,  ///< neither: they touch, or nearly
};

struct PathDistanceOptions {
  /// Largest width of the smallest distance, in model units, >= 0; at least 2^-43 of the largest length at hand.
  double tolerance;
  double time_tolerance = 1e-6;  ///< of the first contact, in times from one pose to the next, > 0
  std::function<bool()> interrupted = {};
  /// Called now and then with what is proven so far of the smallest distance, and how many moments were looked at.
  std::function<void(const Enclosure& smallest, std::uint64_t moments)> progress = {};
};

/// Time k is that of pose k.
struct PathDistance {
  Enclosure smallest;  ///< contains the smallest distance of all times: [0, 0] if they are proven to meet
  double smallest_at;  ///< a time at which the distance is at most `smallest.hi`
  PathProximity proximity;
  double apart_before;            ///< proven: no common point at any time before; the end of the path if `apart`
  std::optional<double> meet_at;  ///< a common point is proven at this time: the first contact is not later
  /// `smallest` is at most the tolerance wide, and of a meeting the first contact is known to the time tolerance.
  bool reached;
  bool interrupted;
  std::uint64_t moments;  ///< at which distances were enclosed
};

/// B moves by the poses, after its primitives' own, A rests in its frame. Between two poses the translation is linear
/// in time and the rotation turns about a fixed axis at constant speed, by the smaller angle; a single pose is a body
/// at rest. Proven between the poses by how far directions still separate the primitives, where both models are unions
/// of convex ones, else, which takes more moments, by how fast points move (docs/mathematics.md §26). Throws
/// Error(input) for a path without poses, for poses that are not finite or have a zero quaternion, for half a turn from
/// one pose to the next, which has two ways, for tolerances that are negative or no numbers, and for a model that is
/// proven to have no point at all.
[[nodiscard]] PathDistance distance_along(std::span<const Pose> path, const Model& a, const Model& b,
                                          const PathDistanceOptions& options);

// The smallest distance of two models of which one moves, with what proves it again.

struct CertifiedPath {
  PathClaims claims;  ///< what the certificate proves
  PathCertificate certificate;
  bool interrupted;
};

/// Certifies what `distance_along` found with the same arguments: about as tight, and wider where the certificates of
/// pairs are (verisq/model_search.hpp) or too many parts would be needed. Interrupted, it holds what is proven by then.
[[nodiscard]] CertifiedPath certified_path(std::span<const Pose> path, const Model& a, const Model& b,
                                           const PathDistance& found, const PathDistanceOptions& options);

}  // namespace verisq
