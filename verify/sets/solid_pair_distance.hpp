/// The distance of two solids by branch and bound over pairs of cubes (docs/mathematics.md §10, §11).
#pragma once

#include <optional>
#include <vector>

#include "verify/sets/enclosing_balls.hpp"
#include "verify/sets/solid_pair_certificate.hpp"
#include "verisq/model_search.hpp"

namespace verisq::verify {

/// As ModelSearch says, which this does the work of.
class PairSearch {
 public:
  PairSearch(const Model& a, const Model& b);

  [[nodiscard]] SearchedDistance operator()(const Pose& pose, const SearchOptions& options) const;
  [[nodiscard]] CertifiedDistance certified(const Pose& pose, const SearchedDistance& found,
                                            const SearchOptions& options) const;

  [[nodiscard]] PairCertificate planes(const Pose& pose, const SearchedDistance& found,
                                       const SearchOptions& options) const {
    return planes_between(a_, b_, pose, found, options);
  }

  [[nodiscard]] const SearchSolid& solid_b() const { return b_.solid; }

 private:
  /// Where balls enclose a model, the distances of their centres bound that of the models, however much of the other
  /// solid is about as near.
  struct Enclosed {
    EnclosingBalls balls;
    std::vector<Ball> hollows;  ///< of the other model
    SolidDistance distance;     ///< from the other model
  };

  [[nodiscard]] static std::optional<Enclosed> enclosed(const Model& model, const Model& other);

  SearchedModel a_;
  SearchedModel b_;
  std::optional<Enclosed> enclosed_a_;
  std::optional<Enclosed> enclosed_b_;
};

}  // namespace verisq::verify
