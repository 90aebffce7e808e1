/// The distance of two unions of convex primitives, whose numbers may be uncertain: enclosure, certificate, closest
/// points. For other models there is model_search.hpp.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/pair_certificate.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

namespace verify {
class PairMemory;
}  // namespace verify

enum class Proximity {
  separated,    ///< proven disjoint: lo > 0
  overlapping,  ///< proven to have a common point: the distance is [0, 0]
  undecided,    ///< touching, or nearly: lo = 0, hi is small; of uncertain models also where members differ
};

/// Boxes, in the frame of model A, that contain every pair of closest points.
struct ClosestPoints {
  std::array<Enclosure, 3> on_a;
  std::array<Enclosure, 3> on_b;
  bool unique;  ///< proven: there is exactly one pair of closest points
};

/// What holds for every member of A and every member of B, where these are uncertain.
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
  ~PairDistance();
  PairDistance(PairDistance&&) noexcept;
  PairDistance& operator=(PairDistance&&) noexcept;

  /// Encloses the exact distance of A and of B moved by `pose`, as tightly as the method gives; 0 where they meet.
  /// Where `interrupted`, polled after each pair of primitives, says so, what is proven by then: valid, and wide.
  [[nodiscard]] ModelDistance operator()(const Pose& pose = {}, const std::function<bool()>& interrupted = {}) const;

  /// What earlier poses proved, for the next ones. Not for several threads at once.
  class Memory {
   public:
    Memory();
    ~Memory();
    Memory(Memory&&) noexcept;
    Memory& operator=(Memory&&) noexcept;

   private:
    friend PairDistance;
    std::unique_ptr<verify::PairMemory> pairs_;
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
  std::unique_ptr<State> state_;
};

}  // namespace verisq
