/// Proves the smallest signed distance of a point to an implant on its way in again: MPFR, no OpenCL, no search.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>
#include <verisq/certificate.hpp>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// A part of the way that a point of the bone takes as the resting implant sees it. The certificate proves how far
/// `segment` (as the triangle of its first and twice its second end) is from the implant; where that is more than 0, no
/// point of the way's part is deeper inside, or less far outside, than the segment is far, less what lies between the
/// two (docs/mathematics.md §16).
struct WayPart {
  double until;                  ///< the time when it ends; it begins where the part before ends, the first at 0
  std::array<Point, 2> segment;  ///< in the implant's frame
  Certificate certificate;       ///< of a triangle

  [[nodiscard]] bool operator==(const WayPart&) const = default;
};

/// What proves an enclosure [lo, hi] of the smallest signed distance along a path, whatever it holds.
struct InsertionCertificate {
  double deepest = 0.0;        ///< a time, of which the distance is at most hi
  Certificate at_deepest;      ///< of the point at that time
  std::vector<WayPart> parts;  ///< of all of the way: of each the distance is at least lo

  [[nodiscard]] bool operator==(const InsertionCertificate&) const = default;
};

/// The implant moves by the poses after its primitives' own, between them as smallest_distance_along says. Immutable
/// after construction: safe to call from many threads.
class InsertionChecker {
 public:
  /// Throws Error(input) for a path without poses, for poses that are not finite or have a zero quaternion, and as
  /// Checker.
  InsertionChecker(const Model& implant, std::span<const Pose> path);
  ~InsertionChecker();
  InsertionChecker(InsertionChecker&&) noexcept;
  InsertionChecker& operator=(InsertionChecker&&) noexcept;

  /// Never says `proved` of an enclosure that does not contain the smallest signed distance of the point along the
  /// path, whatever the certificate holds. Precondition: `point` is finite, `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Point& point, const Enclosure& claimed,
                                   const InsertionCertificate& certificate) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
