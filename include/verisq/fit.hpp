/// Fits: the pose that serves a cavity best within a range of poses, and how good a fit can be at best.
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
#include <verisq/hidden.hpp>
#include <verisq/model.hpp>

namespace verisq {

// The poses that a fit may choose.

/// From the start, the implant's centre (of the bounding box of its own frame) moves by at most `translation` along
/// each axis, and the implant turns about that centre by a rotation vector of at most `rotation_degrees` along each
/// axis.
struct PoseRange {
  Pose start{};
  double translation;       ///< model units, >= 0
  double rotation_degrees;  ///< in [0, 180]
};

// Searches for the pose and the sizes of an implant that serve a cavity best: the paper's Eq. (4). A search in
// floating point: nothing here is proven; `clearance.hpp` proves what was found.

/// A condition on the pose of an implant: a number within a range.
struct FitConstraint {
  std::string name;
  Enclosure range;  ///< ends may be infinite
  double unit;      ///< a change of the value that matters, > 0
  /// Encloses the number of this implant of the series in this pose; smooth.
  std::function<Enclosure(std::size_t implant, const Pose& pose)> value;
};

/// The number that a fit makes as large as it can.
enum class FitObjective : std::uint8_t {
  fitness,  ///< F of Eq. (4)
  size,     ///< the implant: of sizes to choose from, and of a series; what is left free then serves F
};

/// The volumes of all primitives, added up, to nearest: which of several sizes of an implant is the larger. What
/// several of them hold counts as often. Bends change no volume; what set operations cut away counts, too.
[[nodiscard]] double implant_size(const Model& implant);

/// A condition on contact: the share of these points, by weight, from which the implant is no farther lies within a
/// range.
struct FitContact {
  std::string name;
  std::vector<Point> points;    ///< about evenly over an area; at least one
  std::vector<double> weights;  ///< one a point, >= 0, their sum above 0
  double distance;              ///< no farther is contact; model units
  Enclosure share;              ///< in [0, 1]
};

struct FitProgress {
  double objective;     ///< of the best pose so far that respects the limits; -infinity where there is none
  double done;          ///< share of the work, in [0, 1]
  std::size_t implant;  ///< that is being fitted, index in the series
};

struct FitOptions {
  Fitness fitness;
  double penetration_limit;        ///< no point of the cavity's surface deeper inside the implant, in model units; >= 0
  double surface_tolerance = 0.0;  ///< how close to the limit triangles are still decided; > 0 where there are any
  PoseRange range;
  /// The required side of the cavity's triangles, one a primitive for each implant. The search keeps to it where it
  /// can; prove_sides tells whether it did. Empty: each may be anywhere.
  std::vector<std::vector<SurfaceSide>> sides = {};
  /// Which the search keeps to where it can: whether the values do at its pose is the caller's to see.
  std::vector<FitConstraint> constraints = {};
  std::vector<FitContact> contacts = {};  ///< likewise
  FitObjective objective = FitObjective::fitness;
  std::vector<Pose> tried = {};                              ///< refined besides what the search samples
  std::uint64_t seed = 1;                                    ///< the same seed on the same device gives the same pose
  std::size_t samples = 4096;                                ///< poses of the global start
  std::string device = "auto";                               ///< as MapOptions::device; "host": no OpenCL at all
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true: the best so far is returned
  std::function<bool()> out_of_time = {};                    ///< a time limit, likewise; empty: none
  std::function<void(const FitProgress&)> progress = [](const FitProgress&) {};
};

/// From where the range starts, to nearest.
struct FitMovement {
  Point centre;                        ///< of the implant: moved by this vector
  Point rotation_degrees;              ///< a rotation vector, about that centre
  std::vector<std::string> at_limits;  ///< which ranges end here: "translation along x", "semi-axis 2 of body", ...
};

/// A pose that the search found and did not choose. Nothing about it is proven.
struct FitFinalist {
  std::size_t implant;  ///< index in the series
  Pose pose;
  Model model;                 ///< of its sizes, posed
  double objective;            ///< F, about
  double deepest_penetration;  ///< about, where the search looked
  bool within_limit;           ///< likewise
  bool kept;                   ///< sides and constraints, likewise
};

struct Fit {
  std::size_t implant;         ///< index in the series
  Pose pose;                   ///< of the chosen implant, after its primitives' own poses
  Model model;                 ///< the implant with its chosen sizes, posed: what is to be proven
  double objective;            ///< F of Eq. (4), to about 1e-9; with bends and set operations to about 1e-5
  double deepest_penetration;  ///< of a point of the cavity, to about 1e-9 (with bends and set operations 1e-6 of the
                               ///< size), 0 where none is inside; where there are triangles of their surface, to a
                               ///< hundred times the tolerance
  bool within_limit;  ///< no point deeper than the limit by the search's own reckoning, no triangle proven to be
  FitMovement movement;
  /// The best of every other implant, and the other poses of the chosen one that were refined: the best first.
  std::vector<FitFinalist> finalists;
  bool interrupted;
  bool out_of_time;     ///< the limit ended the search
  std::uint64_t poses;  ///< candidates evaluated
  std::string device;   ///< used, or "host"; with bends and set operations for what is mapped, not for the search
  std::string notice;   ///< why a device was passed over; empty when nothing to say
};

/// Fits every implant of the series and returns the best: within the limit before beyond it; there the shallowest; then
/// the largest objective, or size; of equals the earlier. Semi-axes that are intervals are sizes to choose from (I_l <=
/// I <= I_r), unless an implant has a bend or set operations; all other numbers must be exact. Of such implants the
/// search climbs by distances that are right near their faces and too small beyond their edges. The functions of the
/// options are called by one thread at a time. Throws Error(input) for an empty series or cavity, for options and
/// points out of their ranges, for other uncertain numbers, for sides that are not those of the implants or of a
/// surface that has none, and for devices as Mapper.
[[nodiscard]] Fit fit(std::span<const UncertainModel> series, const Cavity& cavity, const FitOptions& options);

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
