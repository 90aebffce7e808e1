/// Proves finished enclosures again from their certificates: MPFR, no OpenCL, no solver.
#pragma once

#include <memory>
#include <verisq/certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

enum class Verdict {
  proved,    ///< the certificate proves both ends
  refuted,   ///< the exact signed distance (of a member) is proven to lie outside the enclosure, or lo > hi
  unproved,  ///< neither: the certificate proves less than the enclosure claims
};

struct Finding {
  Verdict verdict;
  Enclosure proven;  ///< what the certificate proves, rounded outward; an inner end is proven no farther than claimed
};

/// Of an uncertain model or point, the certificate of an enclosure proves two statements: its normals bound the
/// distance to the largest (or inflated) model from below, with the escape if there is one, and that to the smallest
/// from above, the first normal first; each normal proves what it can for either. Of a primitive K bent by β
/// (docs/mathematics.md §9) a normal v proves a lower end where |β(x) - q|² lies above its tangent plane at β⁻¹(q - v)
/// for all x of K that are near enough, and the upper end |q - β(b)|, b being β⁻¹(q - v) scaled to K's surface; with
/// hi < 0, that the ball of radius -hi lies inside, which is -hi along -v from q the nearest to the boundary. Immutable
/// after construction: safe to call from many threads.
class Checker {
 public:
  /// Each point is any within `point_radius` of the one given, each triangle any whose corners are. Precondition:
  /// finite, at least 0. Throws Error(input) where model or points are not exact and the model is not the union of its
  /// primitives, and as `bracket`.
  explicit Checker(const UncertainModel& model, double point_radius = 0.0);
  ~Checker();
  Checker(Checker&&) noexcept;
  Checker& operator=(Checker&&) noexcept;

  /// Never says `proved` of an enclosure that does not contain the exact signed distances of all members, whatever the
  /// certificate holds; `refuted` says that of one member. Normals of primitives that the model does not have, and
  /// vectors that are zero or not finite, prove nothing. Precondition: `point` is finite, `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const;

  /// The same of the distance of a triangle, which is 0 where it meets the model. Precondition: finite corners.
  [[nodiscard]] Finding operator()(const Triangle& triangle, const Enclosure& claimed,
                                   const Certificate& certificate) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
