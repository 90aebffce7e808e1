/// Two solids of any kind that overlap: a point deep in both, and a short translation that parts them.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verisq/distance.hpp"
#include "verisq/model.hpp"
#include "verisq/penetration.hpp"

namespace verisq::verify {

/// Model A, and model B moved by a pose. Searches go on in small steps as long as they find something better: what they
/// find is good, not the best. All points are in the frame of A.
class Overlap {
 public:
  /// `size` is about that of the models. `interrupted` ends every search.
  Overlap(const Model& a, const Model& b, const Pose& pose, double size, std::function<bool()> interrupted);

  /// A point whose depths in both solids have about the largest sum. `common` is a point of both, if one is known.
  [[nodiscard]] Point deepest(const std::optional<Point>& common) const;

  /// Balls about it in both, as large as they are proven to be.
  [[nodiscard]] std::array<InnerBall, 2> balls_about(const Point& x, double tolerance) const;

  /// A translation of B that is shorter than `reach`, the way along `direction` that parts the models' hulls; nothing
  /// where none was found. `deep` is a point of both.
  [[nodiscard]] std::optional<PartingTranslation> parting(const Point& direction, double reach, const Point& deep);

 private:
  struct Deep {
    double depth;  ///< about the sum of both
    Point place;
  };

  [[nodiscard]] Deep deep_at(const Point& x) const;
  [[nodiscard]] Deep climbed(Deep best) const;
  /// About how deep a point lies in each of both.
  [[nodiscard]] std::array<double, 2> depths(const Point& x) const;
  [[nodiscard]] bool still_meet(const Point& translation) const;
  [[nodiscard]] Pose after(const Point& translation) const;
  [[nodiscard]] bool parts(const Point& translation);
  bool shorten(const Point& direction);
  void turn_about_best();

  SignedDistance a_, b_;
  CertifiedDistances certified_;
  std::variant<PairDistance, ModelSearch> distance_;
  Pose pose_;
  ApproximateMotion<double> motion_;
  std::vector<Point> centres_;  ///< of all primitives
  double size_;
  std::function<bool()> interrupted_;
  Point deep_{};  ///< of a parting: a point of both
  std::array<double, 2> depths_of_deep_{};
  Point best_{};           ///< the best direction so far
  double way_ = 0.0;       ///< along it: is known to part
  std::size_t asked_ = 0;  ///< distances
};

}  // namespace verisq::verify
