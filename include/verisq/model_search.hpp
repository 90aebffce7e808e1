/// The distance of any two models, bent or built by set operations: by planes between their primitives where these
/// decide, else by branch and bound over pairs of cubes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/pair_certificate.hpp>

namespace verisq {

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
  ~ModelSearch();
  ModelSearch(ModelSearch&&) noexcept;
  ModelSearch& operator=(ModelSearch&&) noexcept;

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
  std::unique_ptr<State> state_;
};

}  // namespace verisq
