/// Enclosed distances of points, triangles and models to a model, their closest points and certificates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/features.hpp>
#include <verisq/hidden.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// More of a point than its signed distance: the closest point of the model's surface, the normal there, and with it
// the derivatives of the distance by position and by pose.

/// An interval for each coordinate of a point or a vector: x, y, z.
using EnclosedPoint = std::array<Enclosure, 3>;

/// The points p of the model's surface that are closest to a point x, enclosed, all in the model's frame
/// (docs/mathematics.md §25). sd is the signed distance of x.
struct ClosestPoint {
  Enclosure distance;    ///< contains sd
  EnclosedPoint point;   ///< contains every closest point p, whether there is one or many
  EnclosedPoint normal;  ///< contains (x - p)/sd for every p, and where `unique`, the gradient of sd at x
  /// Index in Model::primitives of the one whose surface has every p; nothing where that is not proven.
  std::optional<std::uint32_t> primitive;
  /// Proven: there is one closest point, and sd is differentiable at x. Its gradient is the outward unit normal of the
  /// surface at p. False says only that this is not proven: of points inside where primitives overlap it never is, nor
  /// on edges, nor of points that several closest points have.
  bool unique;
};

/// The ball that the signed distance alone gives: no closest point is farther. Not unique.
[[nodiscard]] ClosestPoint closest_point_within(const Enclosure& distance, const Point& x);

/// The derivatives of sd when x is moved by a small rigid motion: a translation, then a rotation about `centre` by the
/// vector w, x -> x + w × (x - centre). They are n and (x - centre) × n for the normal n, per model unit and per
/// radian. Where the model is moved instead, they are the negatives of these. Precondition: `closest` is what is proven
/// of `x`. Of use where `closest.unique`; elsewhere intervals of no great interest.
[[nodiscard]] std::array<Enclosure, 6> gradient_by_motion(const ClosestPoint& closest, const Point& x,
                                                          const Point& centre);

// Certificates prove an enclosure of the distance of two models again, without device, solver or search.

/// Bounds the distance of two convex primitives A and B from both sides. From below by
/// (v·c - h_A(v) - h_B(-v)) / |v|, where c leads from A's centre to B's; from above by the distance of the points
/// a / max(1, g_A(a)) of A and b / max(1, g_B(b)) of B. `vector` and `on_a` in A's own frame, `on_b` in B's.
struct Separation {
  std::uint32_t primitive_a;
  std::uint32_t primitive_b;
  Point vector;
  Point on_a;
  Point on_b;
};

/// A section of a primitive is its part between two heights of its own axis, before the bend.
enum class SectionCut : std::uint8_t {
  none,  ///< a plane separates the two sections
  a,     ///< that of A is halved: first what both cuts of the lower half, then what those of the upper half say
  b,     ///< that of B
};

/// Separates a section of A from one of B (docs/mathematics.md §9).
struct SectionPlane {
  Point normal;    ///< from A to B, in the frame of model A; of any length
  double slope_a;  ///< the number v of §9 that belongs to A's section; of no matter without a bend
  double slope_b;
};

/// Bounds the distance of two primitives from below, bent or not: by the least of their sections'.
struct DividedSeparation {
  std::uint32_t primitive_a;
  std::uint32_t primitive_b;
  std::vector<SectionCut> cuts;      ///< in preorder, first of both whole primitives
  std::vector<SectionPlane> planes;  ///< of each SectionCut::none, in this order
};

/// A ball that holds a primitive of one model, and how far the other model is from its centre.
struct EnclosingBall {
  std::uint32_t primitive;
  Point centre;       ///< in the frame of the other model
  double multiplier;  ///< μ of verify/proof/solid_pair.hpp: of no matter where the primitive is a ball
  double distance;    ///< what `proof` proves of the signed distance of the centre to the other model
  Certificate proof;
};

/// A primitive of one model that is not bent, and how far it is from the other model, all of it.
struct SurroundedPrimitive {
  std::uint32_t primitive;
  double distance;          ///< what is proven: the other model has nothing as near
  std::vector<bool> cover;  ///< as Certificate::cover, of the primitive's neighbourhood (docs/mathematics.md §28)
};

/// If both models are is_union_of_convex, `separations` count: the first decides the upper end, and a pair without one
/// is far by its bounding spheres. If one has a mesh, `common` alone counts. For all other models `divisions`, balls,
/// covers and `near_points` count.
struct PairCertificate {
  std::vector<Separation> separations = {};
  std::vector<DividedSeparation> divisions = {};
  std::vector<EnclosingBall> balls_a = {};  ///< about primitives of A
  std::vector<EnclosingBall> balls_b = {};
  std::vector<SurroundedPrimitive> covers_a = {};  ///< primitives of A
  std::vector<SurroundedPrimitive> covers_b = {};  ///< primitives of B
  /// A point of A in its frame, and one of B in its own: the distance is no more than theirs.
  std::optional<std::array<Point, 2>> near_points = {};
  /// A point of A's frame in both models: the distance is 0 and needs nothing else.
  std::optional<Point> common = {};
};

/// An enclosure that its certificate proves.
struct CertifiedDistance {
  Enclosure distance;
  PairCertificate certificate;
};

// Distances of two models of any kind, with what proves them again.

/// By certificates where both models are is_union_of_convex, else by search. Immutable after construction: safe to call
/// from many threads.
class CertifiedDistances {
 public:
  /// `tolerance` is of searches, as SearchOptions has it.
  CertifiedDistances(const Model& a, const Model& b, double tolerance);

  /// Encloses the distance of A and of B moved by `pose`, as far as the certificate proves it; once `interrupted` says
  /// so what is proven by then. Throws as ModelSearch.
  [[nodiscard]] CertifiedDistance operator()(const Pose& pose, const std::function<bool()>& interrupted) const;

 private:
  struct State;
  Hidden<State> state_;
};

// The distance of two unions of convex primitives, whose numbers may be uncertain: enclosure, certificate, closest
// points. For other models there is ModelSearch.

namespace verify {
class PairMemory;
}  // namespace verify

enum class Proximity {
  separated,    ///< proven disjoint: lo > 0
  overlapping,  ///< proven to have a common point, which may be the only one: the distance is [0, 0]
  undecided,    ///< neither is proven: lo = 0 < hi, which is small unless interrupted or where uncertain members differ
};

/// Boxes, in the frame of model A, that contain every pair of closest points.
struct ClosestPoints {
  std::array<Enclosure, 3> on_a;
  std::array<Enclosure, 3> on_b;
  bool unique;  ///< proven: there is exactly one pair of closest points
};

/// Holds for every member of A and every member of B, where these are uncertain.
struct ModelDistance {
  Enclosure distance;
  Proximity proximity;
  PairCertificate certificate;  ///< of exact models; of uncertain ones there is none: it is empty
  bool complete = true;  ///< false: interrupted before all pairs of primitives that may be the nearest were looked at
};

/// Two models in one frame, each the union of all its primitives, none bent. Immutable after construction: safe to call
/// from many threads.
class PairDistance {
 public:
  /// Throws Error(input) for other models, and as `bracket`.
  PairDistance(const UncertainModel& a, const UncertainModel& b);

  /// Encloses the exact distance of A and of B moved by `pose`, as tightly as the method gives; 0 where they meet.
  /// Where `interrupted`, polled after each pair of primitives, says so, what is proven by then: valid, and wide.
  [[nodiscard]] ModelDistance operator()(const Pose& pose = {}, const std::function<bool()>& interrupted = {}) const;

  /// Keeps what earlier poses proved, for the next ones. Not for several threads at once.
  class Memory {
   public:
    Memory();

   private:
    friend PairDistance;
    Hidden<verify::PairMemory> pairs_;
  };

  /// The same distance, bit for bit, without a certificate: pairs of primitives that were farther apart than B has
  /// moved since are passed over. Worth it along a path, of models of many primitives. Precondition: `memory` was of no
  /// other models.
  [[nodiscard]] ModelDistance operator()(const Pose& pose, Memory& memory,
                                         const std::function<bool()>& interrupted = {}) const;

  /// The closest points of separated exact models; nothing where a model is uncertain, where `found` is not separated
  /// or not complete, or where `interrupted`, polled before each pair of primitives, says so. Precondition: `found` is
  /// the answer for the same pose. Slower than the distance: some milliseconds a pair.
  [[nodiscard]] std::optional<ClosestPoints> closest_points(const ModelDistance& found, const Pose& pose = {},
                                                            const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

// The host's own proof of a signed distance: Boost.Interval and MPFR, no OpenCL. Slow, independent, the last word.

/// Signed distance to a model (outside: Euclidean distance; inside: minus the distance to the boundary): by the
/// certificates of docs/mathematics.md §2 and §5 where they are tight, by branch and bound (§9 to §11) where primitives
/// overlap, are bent or are combined by other operations than the union. Immutable after construction: safe to call
/// from many threads.
class SignedDistance {
 public:
  explicit SignedDistance(const Model& model);

  /// Encloses the exact signed distance of `point`; works until it is at most `tolerance` wide or the method's
  /// limit is reached (0 asks for the tightest). Never throws for finite points; the enclosure is always valid. Of an
  /// empty solid, an intersection of what has nothing in common, the upper end is infinite.
  [[nodiscard]] Enclosure operator()(const Point& point, double tolerance) const;

  /// The same, but a search ends as soon as `interrupted`, polled by the calling thread, says so: the enclosure is
  /// valid then, and wide.
  [[nodiscard]] Enclosure operator()(const Point& point, double tolerance,
                                     const std::function<bool()>& interrupted) const;

  /// The same with what proves it: `Checker` proves the enclosure again from the certificate. The enclosure is what the
  /// certificate's binary64 numbers prove, which may be wider than the other's by their rounding; inside overlaps also
  /// because a cover would have too many cells. Of several primitives together, and of set operations, covers and
  /// witnesses prove it (docs/mathematics.md §28): some milliseconds to some tenths of a second a point.
  [[nodiscard]] CertifiedEnclosure certified(const Point& point, double tolerance) const;

  /// The same, interrupted as above. Without `covers` every end is proven by one primitive alone, as the obligation of
  /// `Bracket` asks; throws Error(input) then, unless the model is the union of its primitives.
  [[nodiscard]] CertifiedEnclosure certified(const Point& point, double tolerance,
                                             const std::function<bool()>& interrupted, bool covers = true) const;

  /// Where the model's surface is closest to `point`. Of models that are is_union_of_convex as tight as binary64
  /// allows, whatever the tolerance, wherever that is unique: always outside, but where two primitives are as near as
  /// each other; inside where no other primitive covers the closest point. Elsewhere the distance is that of the calls
  /// above, and the box holds every point as far as that. Never throws for finite points.
  [[nodiscard]] ClosestPoint closest_point(const Point& point, double tolerance,
                                           const std::function<bool()>& interrupted = {}) const;

  /// The same without a search: where nothing is proven of the point, what a signed distance says that is known to lie
  /// in `known`.
  [[nodiscard]] ClosestPoint closest_point(const Point& point, const Enclosure& known) const;

 private:
  struct State;
  Hidden<State> state_;
};

/// Radius of a sphere that contains the model: half the diagonal of the bounding box of the primitives' posed boxes,
/// rounded up. The default tolerance is 1e-6 times this.
[[nodiscard]] double bounding_radius(const Model& model);

// The closest points of many points, and of two models in many poses, by all processors of the host.

struct ClosestPointOptions {
  /// The tolerance of distances where no closest point is proven, as of SignedDistance; model units.
  double tolerance;
  /// Known enclosures of these distances; with them nothing is searched for. Empty, or as many as points.
  std::span<const Enclosure> known = {};
  /// Polled by several threads; once true, it must stay true, and ends the work early. Empty: never.
  std::function<bool()> interrupted = {};
};

/// Sums up the closest points of many points.
struct ClosestPointSummary {
  std::size_t points = 0;      ///< finished rows, from the front: all unless interrupted
  std::size_t unique = 0;      ///< of these
  double widest_point = 0.0;   ///< of the boxes of unique ones, the widest of their intervals, in model units
  double widest_normal = 0.0;  ///< of points only
  bool interrupted = false;

  [[nodiscard]] bool operator==(const ClosestPointSummary&) const = default;
};

/// Row i is SignedDistance::closest_point of point i; rows that are not finished are valid, and say no more than what
/// is known. Throws Error(input) unless there are as many rows as points, and for a point that is not finite.
ClosestPointSummary closest_points(const SignedDistance& distance, const PointColumns& points,
                                   std::span<ClosestPoint> rows, const ClosestPointOptions& options);

/// Row i is PairDistance::closest_points for pose i; where that says nothing, the models not being proven separate, and
/// in rows that are not finished, the boxes are infinite. Throws Error(input) unless there are as many rows as poses.
ClosestPointSummary closest_points(const PairDistance& distance, std::span<const Pose> poses,
                                   std::span<ClosestPoints> rows, const std::function<bool()>& interrupted = {});

/// Sums up finished rows.
[[nodiscard]] ClosestPointSummary summary_of(std::span<const ClosestPoint> rows);
[[nodiscard]] ClosestPointSummary summary_of(std::span<const ClosestPoints> rows);

/// The summary of the rows of both.
[[nodiscard]] ClosestPointSummary joined(const ClosestPointSummary& a, const ClosestPointSummary& b);

// The host's own proof of the distance of a triangle to a model: Boost.Interval and MPFR, no OpenCL.

/// Distance of a triangle, its interior included, to a model: 0 where they meet (docs/mathematics.md §6). Immutable
/// after construction: safe to call from many threads.
class TriangleDistance {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit TriangleDistance(const Model& model);

  /// Encloses the exact distance as tightly as the method gives. The triangle may be degenerate. Never throws for
  /// finite corners; the enclosure is always valid, and [0, 0] where the triangle is proven to meet the model.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle) const;

  /// The same with what proves it: the enclosure is what `Checker` proves from the certificate.
  [[nodiscard]] CertifiedEnclosure certified(const Triangle& triangle) const;

 private:
  struct State;
  Hidden<State> state_;
};

// The distance of a triangle to any model, bent or built by set operations, by branch and bound over parts of the
// triangle. For unions of convex primitives TriangleDistance is faster.

/// Distance of a triangle, its interior included, to a model: 0 where they meet (docs/mathematics.md §6), from signed
/// distances of points (SignedDistance). Immutable after construction: safe to call from many threads.
class TriangleSearch {
 public:
  explicit TriangleSearch(const Model& model);

  /// Encloses the exact distance; works until it is at most `tolerance` wide, in model units, until `interrupted`,
  /// polled by the calling thread, says so, or until its budget of points is spent: then it is valid, and wide. The
  /// triangle may be degenerate. Never throws for finite corners; [0, 0] where the triangle is proven to meet the
  /// model. Of an empty solid the upper end is infinite.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, double tolerance,
                                     const std::function<bool()>& interrupted = {}) const;

  /// The same with what proves it: the enclosure is what `Checker` proves from the certificate, by a witness and a
  /// cover (docs/mathematics.md §28). Some milliseconds to some tenths of a second a triangle; wide where a cover would
  /// have too many cells.
  [[nodiscard]] CertifiedEnclosure certified(const Triangle& triangle, double tolerance,
                                             const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

// The distance of any two models, bent or built by set operations: by planes between their primitives where these
// decide, else by branch and bound over pairs of cubes.

struct SearchOptions {
  double tolerance;                        ///< in model units: stop at this width; 0: at that of rounding errors
  std::function<bool()> interrupted = {};  ///< polled; true ends the search
  /// Called now and then with what is proven so far and the number of cubes evaluated.
  std::function<void(const Enclosure&, std::uint64_t)> progress = {};
};

struct SearchedDistance {
  Enclosure distance;
  Proximity proximity;
  /// Proven to lie in A and, stated in B's own frame, in B; `distance.hi` apart. Nothing where none was found in time.
  std::optional<std::array<Point, 2>> near_points;
  std::optional<Point> common;  ///< in the frame of A: proven to lie in both
  std::uint64_t cubes;          ///< evaluated, of both models
  /// At most the tolerance wide, or that of rounding errors where the tolerance is below.
  bool reached;
};

/// Two models in one frame. Immutable after construction: safe to call from many threads.
class ModelSearch {
 public:
  ModelSearch(const Model& a, const Model& b);

  /// Encloses the exact distance of A and of B moved by `pose`, 0 where they meet; works until it is at most the
  /// tolerance wide, interrupted, or out of its budget of cubes and pairs: then it is valid, and wide. Throws
  /// Error(input) where a model is proven to have no point at all.
  [[nodiscard]] SearchedDistance operator()(const Pose& pose, const SearchOptions& options) const;

  /// `found` with what proves it again (verisq/pair_checker.hpp): its points, planes between the primitives' sections,
  /// balls about primitives in hollows, covers about those without a bend. Wider than `found` where these do not
  /// decide, as of bent necks beside rims, and where interrupted. Precondition: `found` at the same pose; one of the
  /// models is not is_union_of_convex, for which PairDistance has certificates.
  [[nodiscard]] CertifiedDistance certified(const Pose& pose, const SearchedDistance& found,
                                            const SearchOptions& options) const;

 private:
  struct State;
  Hidden<State> state_;
};

// Proves distances of two models again from their certificates, by MPFR alone: without device, solver or search.

/// Two models, bent or built by set operations or not. Immutable after construction: safe to call from many threads.
class PairChecker {
 public:
  PairChecker(const Model& a, const Model& b);

  /// Returns what the certificate proves about the distance of A and of B moved by `pose`, whatever it holds: an
  /// enclosure of the exact distance, [0, infinity] if it proves nothing. Primitives that a model does not have, and
  /// vectors and points that are not finite, prove nothing. Once `interrupted`, polled unless empty, says so, less is
  /// proven.
  [[nodiscard]] Enclosure prove(const Pose& pose, const PairCertificate& certificate,
                                const std::function<bool()>& interrupted = {}) const;

  /// Judges a claim about this distance: never `proved` for an enclosure that does not contain it.
  /// `unproved` says nothing once interrupted. Precondition: `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Pose& pose, const Enclosure& claimed, const PairCertificate& certificate,
                                   const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

// Moves a whole model.

/// The model moved by x -> R x + t after its primitives' own poses: these are composed and rounded to nearest, so that
/// the moved model is a model of its own, exactly as its numbers state, within a few units in the last place of the
/// rigid motion. Quaternions come out with length 1 to rounding. Precondition: as for Pose. Throws Error(input) where
/// places overflow.
[[nodiscard]] Model posed(const Model& model, const Pose& pose);

/// Likewise with semi-axes and exponents known within bounds, which no motion changes. Throws Error(input) where a
/// translation is: a turned box of places is no box.
[[nodiscard]] UncertainModel posed(const UncertainModel& model, const Pose& pose);

/// A point moved likewise, each coordinate to nearest.
[[nodiscard]] Point posed(const Point& point, const Pose& pose);

/// Points that the model's file names, moved with it: each coordinate to nearest.
[[nodiscard]] FemurLandmarks posed(const FemurLandmarks& landmarks, const Pose& pose);

// The paper's own verified distance (§5.1), as published: GJK, a bisected segment, one interval plane.
//
// Here to be compared with: its enclosures are valid, but wider and slower than those of `SignedDistance` and
// `PairDistance`, which rest on the duality certificate.

/// How far GJK's floating-point answer may exceed the distance, relative to it, in the paper's tests.
inline constexpr double published_accuracy = 1e-6;

/// Eqs. (16) to (18): encloses the Euclidean distance of a point to one posed superquadric, [0, 0] where the point is
/// proven to lie in it. `accuracy` (0: the best that binary64 gives) changes the width, never the validity. Throws
/// Error(input) for a bent solid, like all here; otherwise never for finite points.
[[nodiscard]] Enclosure published_distance(const Primitive& solid, const Point& point,
                                           double accuracy = published_accuracy);

/// Eqs. (19) and (20): encloses the distance of two posed superquadrics, [0, 0] where they are proven to meet.
[[nodiscard]] Enclosure published_distance(const Primitive& a, const Primitive& b,
                                           double accuracy = published_accuracy);

/// The number that the method starts from: GJK alone, in floating point. Nothing proves it.
[[nodiscard]] double unverified_distance(const Primitive& solid, const Point& point,
                                         double accuracy = published_accuracy);
[[nodiscard]] double unverified_distance(const Primitive& a, const Primitive& b, double accuracy = published_accuracy);

}  // namespace verisq
