/// The distance of two solids of any kind.
#pragma once

#include <optional>
#include <vector>

#include "verify/search/solid_pair_certificate.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Models in units of a power of two: searches square lengths, and squares of huge or tiny ones are not binary64
// numbers.

/// A power of two about the largest length: of both models, or `largest` if that is larger. 1 unless that length is
/// huge or tiny, and division by the unit changes nothing but the exponent of each number of the models.
[[nodiscard]] double unit_of(const Model& a, const Model& b, double largest = 0.0);

/// Precondition: a unit other than 1 is the result of unit_of.
[[nodiscard]] Model in_units(const Model& model, double unit);

/// Divided by the unit; nothing if that rounds or overflows.
[[nodiscard]] std::optional<double> in_units(double length, double unit);
[[nodiscard]] std::optional<Point> in_units(const Point& x, double unit);
[[nodiscard]] std::optional<Pose> in_units(const Pose& pose, double unit);

/// Divided by the unit; 0 if that underflows, the largest number if it overflows.
[[nodiscard]] double tolerance_in_units(double tolerance, double unit);

/// From units to lengths, rounded outward.
[[nodiscard]] Enclosure in_lengths(const Enclosure& e, double unit);

// The distance of two solids by branch and bound over pairs of cubes (docs/mathematics.md §10, §11).

/// The search behind ModelSearch, which documents it.
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
  /// If balls enclose a model, the distances of their centres bound the distance of the models, however much of the
  /// other solid is about as near.
  struct Enclosed {
    EnclosingBalls balls;
    std::vector<Ball> hollows;  ///< of the other model
    SolidDistance distance;     ///< distances from the other model
  };

  [[nodiscard]] static std::optional<Enclosed> enclosed(const Model& model, const Model& other);

  SearchedModel a_;
  SearchedModel b_;
  std::optional<Enclosed> enclosed_a_;
  std::optional<Enclosed> enclosed_b_;
};

}  // namespace verisq::verify
