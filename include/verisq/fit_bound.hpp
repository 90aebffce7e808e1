/// How good a fit can be at best, and its certificate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/clearance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/fit.hpp>
#include <verisq/hidden.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Proves again that no pose of a range fits better than a bound says, without device or search.

/// No implant of the series, in any pose of the range whose points all keep the limit, has a larger objective than
/// `upper`.
struct BestFitClaim {
  ClearanceTerms terms;        ///< which distances serve, how deep points may lie, weights
  PoseRange range;             ///< the same for all implants, each about its own centre
  std::vector<Point> centres;  ///< one an implant, in its own frame
  double upper;                ///< -infinity: no pose of the range keeps the limit
};

/// A box of poses is bounded as it is, or halved along one of the three translations or of the three coordinates of
/// the rotation vector.
enum class PoseDivision : std::uint8_t { along_x, along_y, along_z, about_x, about_y, about_z, none };

/// The certificate of the claim: for each implant the range with all of its parts in preorder, the half of the smaller
/// parameters first.
struct BestFitCertificate {
  std::vector<std::vector<PoseDivision>> ranges;
};

struct ProvenBestFit {
  double upper;              ///< proven: the objective of no pose that keeps the limit is larger; -infinity: none does
  std::uint64_t boxes = 0;   ///< that are not halved
  std::uint64_t open = 0;    ///< of these: more than the claim is possible by what is proven of them
  bool interrupted = false;  ///< then only the weights say something
};

/// A certificate, and what it proves.
struct RefinedBestFit {
  BestFitCertificate certificate;
  double upper;
};

/// By interval arithmetic alone. Immutable after construction: safe to call from many threads.
class BestFitChecker {
 public:
  /// Points are those of the bone, one a member of `terms.area_of`. Throws Error(input) for a series that is empty or
  /// holds other than unions of convex primitives, for no points, for other numbers of points or centres than the claim
  /// has, and for what is not finite or out of its range.
  BestFitChecker(std::span<const Model> series, std::span<const Point> points, const BestFitClaim& claim);

  /// Returns the bound that the certificate proves, whatever it holds: the sum of the weights for an implant whose
  /// divisions make no sense. If few boxes are bounded by more than the claim, these are halved further.
  [[nodiscard]] ProvenBestFit operator()(const BestFitCertificate& certificate, const CheckOptions& options) const;

  /// The same where boxes whose bound is above `enough` are halved further, by no more than `further` levels. Once
  /// interrupted it says no more than the weights do.
  [[nodiscard]] RefinedBestFit refined(const BestFitCertificate& certificate, double enough, std::size_t further,
                                       const CheckOptions& options) const;

 private:
  struct State;
  Hidden<State> state_;
};

/// Judges a bound: never `proved` for a claim that is not true.
[[nodiscard]] Verdict check(const BestFitClaim& claim, const ProvenBestFit& proven);

// How good a fit can be at best: a proven upper bound of the objective over all poses of a range (docs/mathematics.md
// §24).

struct FitBoundProgress {
  double upper;         ///< proven so far
  std::uint64_t boxes;  ///< of poses, looked at so far
  std::uint64_t open;   ///< that may still hold something better
};

struct FitBoundOptions {
  Fitness fitness;
  double penetration_limit;  ///< at the cavity's points; >= 0, model units
  PoseRange range;
  double known;                 ///< objective of a known pose, finite
  double gap;                   ///< what is to be proven, in (0, 1): known >= (1 - gap) upper
  std::string device = "auto";  ///< as MapOptions::device: proves depths in the implants
  std::function<bool()> interrupted = [] { return false; };  ///< polled a few times a second; true: ends with what is
                                                             ///< proven by then
  std::function<bool()> out_of_time = [] { return false; };  ///< likewise
  std::function<void(const FitBoundProgress&)> progress = [](const FitBoundProgress&) {};
};

/// A pose that the bound came across. Nothing of it is proven.
struct PromisingPose {
  std::size_t implant;  ///< index in the series
  Pose pose;
  double objective;  ///< about
};

struct FitBound {
  double upper;  ///< proven: no implant of the series in any pose of the range whose points are all within the limit
                 ///< has a larger objective; -infinity: there is no such pose
  bool reached;  ///< the gap
  bool interrupted;
  bool out_of_time;
  std::uint64_t boxes;                     ///< of poses, looked at
  std::optional<PromisingPose> promising;  ///< the best that was met and seems better than what is known
  std::string device;                      ///< that proved depths, or "host"
  /// How each implant's range was halved, in preorder, as `BestFitCertificate` has it; of one that was not begun, not
  /// at all.
  std::vector<std::vector<PoseDivision>> divisions;
};

/// Branch and bound over the poses of every implant. The limit holds at the points alone: sides, triangles and
/// constraints of a fit leave fewer poses, so that the bound is one of theirs, too. Throws Error(input) for sizes that
/// are intervals, for implants that are not unions of convex primitives, for an empty series or cavity, for options out
/// of their ranges and as `fit`.
[[nodiscard]] FitBound bound_fit(std::span<const UncertainModel> series, const Cavity& cavity,
                                 const FitBoundOptions& options);

// How good a fit can be at best, with what proves it again.

struct CertifiedBestFit {
  BestFitClaim claim;  ///< `upper`: what the certificate proves, about that of the bound
  BestFitCertificate certificate;
};

/// The terms of a bound.
struct BestFitTerms {
  Fitness fitness;
  double penetration_limit;
  PoseRange range;
};

/// Certifies a bound that `bound_fit` found for the same series, cavity and terms: by its boxes, halved further where
/// their bound in intervals is larger. Returns nothing where `interrupted` ended it. Throws Error(input) as
/// `bound_fit`.
[[nodiscard]] std::optional<CertifiedBestFit> certified_best_fit(std::span<const UncertainModel> series,
                                                                 const Cavity& cavity, const BestFitTerms& terms,
                                                                 const FitBound& bound, const CheckOptions& check);

}  // namespace verisq
