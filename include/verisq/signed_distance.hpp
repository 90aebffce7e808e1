/// The host's own proof of a signed distance: Boost.Interval and MPFR, no OpenCL. Slow, independent, the last word.
#pragma once

#include <functional>
#include <memory>
#include <verisq/certificate.hpp>
#include <verisq/closest_point.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Signed distance to a model (outside: Euclidean distance; inside: minus the distance to the boundary): by the
/// certificates of docs/mathematics.md §2 and §5 where they are tight, by branch and bound (§9 to §11) where primitives
/// overlap, are bent or are combined by other operations than the union. Immutable after construction: safe to call
/// from many threads.
class SignedDistance {
 public:
  explicit SignedDistance(const Model& model);
  ~SignedDistance();
  SignedDistance(SignedDistance&&) noexcept;
  SignedDistance& operator=(SignedDistance&&) noexcept;

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
  std::unique_ptr<State> state_;
};

/// Radius of a sphere that contains the model: half the diagonal of the bounding box of the primitives' posed boxes,
/// rounded up. The default tolerance is 1e-6 times this.
[[nodiscard]] double bounding_radius(const Model& model);

}  // namespace verisq
