/// Proves finished enclosures again from their certificates: MPFR, no OpenCL, no solver.
#pragma once

#include <memory>
#include <verisq/certificate.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

enum class Verdict {
  proved,    ///< the certificate proves both ends
  refuted,   ///< the exact signed distance is proven to lie outside the enclosure, or lo > hi
  unproved,  ///< neither: the certificate proves less than the enclosure claims
};

struct Finding {
  Verdict verdict;
  Enclosure proven;  ///< what the certificate proves, rounded outward; an inner end is proven no farther than claimed
};

/// Immutable after construction: safe to call from many threads.
class Checker {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit Checker(const Model& model);
  ~Checker();
  Checker(Checker&&) noexcept;
  Checker& operator=(Checker&&) noexcept;

  /// Never says `proved` of an enclosure that does not contain the exact signed distance of `point`, whatever the
  /// certificate holds. Normals of primitives that the model does not have, and vectors that are zero or not finite,
  /// prove nothing. Precondition: `point` is finite, `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const;

  /// The same of the distance of a triangle, which is 0 where it meets the model. Precondition: finite corners.
  [[nodiscard]] Finding operator()(const Triangle& triangle, const Enclosure& claimed,
                                   const Certificate& certificate) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
