/// Proves distances of two models again from their certificates, by MPFR alone: without device, solver or search.
#pragma once

#include <memory>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/pair_certificate.hpp>

namespace verisq {

/// Two models, bent or built by set operations or not. Immutable after construction: safe to call from many threads.
class PairChecker {
 public:
  PairChecker(const Model& a, const Model& b);
  ~PairChecker();
  PairChecker(PairChecker&&) noexcept;
  PairChecker& operator=(PairChecker&&) noexcept;

  /// What the certificate proves about the distance of A and of B moved by `pose`, whatever it holds: an enclosure of
  /// the exact distance, [0, infinity] if it proves nothing. Primitives that a model does not have, and vectors and
  /// points that are not finite, prove nothing.
  [[nodiscard]] Enclosure prove(const Pose& pose, const PairCertificate& certificate) const;

  /// What that says of a claim about this distance: never `proved` of an enclosure that does not contain it.
  /// Precondition: `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Pose& pose, const Enclosure& claimed,
                                   const PairCertificate& certificate) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
