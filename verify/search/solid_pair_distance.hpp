/// The distance of two solids of any kind: balls around them, covers that certify the distance, and the search.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "verify/proof/exact_checker.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/search/solid_pair_cells.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// A lower bound of the distance of a union of convex primitives from any solid: the distance of the centres of balls
// that enclose them, less the balls' radii. The head of a joint is a ball, or nearly one, and all of its cup may be
// about as far from it as the nearest point is.

struct Ball {
  Point centre;
  double radius;
};

/// Balls that the model's set operations take away, in its frame.
[[nodiscard]] std::vector<Ball> hollows(const Model& model);

/// About the best multiplier for the bound of the distance of the primitive's points from x, of the model's frame
/// (verify/proof/solid_pair.hpp).
[[nodiscard]] double multiplier_about(const Primitive& primitive, const Point& x);

/// The bound with that multiplier.
[[nodiscard]] double farthest_up(const Primitive& primitive, const Point& x);

/// Balls that contain the primitive and may be far from the other model. `hollows` are those of the other model; all
/// vectors are in the frame of the primitive's own model. None if the primitive is not nearly round and lies in no
/// hollow.
[[nodiscard]] std::vector<Ball> enclosing_balls(const Primitive& primitive, std::span<const Ball> hollows);

class EnclosingBalls {
 public:
  /// Nothing unless the model is a union of a few convex primitives.
  [[nodiscard]] static std::optional<EnclosingBalls> of(const Model& model);

  /// Returns whether all primitives are balls, so that no hollow is needed.
  [[nodiscard]] bool all_are_balls() const;

  /// A lower bound of the distance of these primitives, in A's frame, from B's solid, or the other way round; minus
  /// infinity if nothing is proven. A ball is its own enclosing ball. Any other primitive must lie in a hollow of the
  /// other solid: the enclosing ball about the hollow's centre is as far from the hollow's wall as the primitive is. If
  /// it leaves the hollow, the ball about its own centre may serve. Distances of centres are searched for to
  /// `tolerance`.
  [[nodiscard]] double lower_from_b(const SolidDistance& b, std::span<const Ball> hollows_of_b,
                                    const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const;
  [[nodiscard]] double lower_from_a(const SolidDistance& a, std::span<const Ball> hollows_of_a,
                                    const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const;

 private:
  /// A centre in the frame of the other solid, and a bound of how far it lies from there.
  struct Located {
    Point centre;
    double off;
  };

  [[nodiscard]] double lower_from(const SolidDistance& solid, std::span<const Ball> hollows,
                                  const std::function<Located(const Point&)>& locate, double tolerance,
                                  const std::function<bool()>& interrupted) const;

  explicit EnclosingBalls(std::vector<Primitive> primitives) : primitives_(std::move(primitives)) {}

  std::vector<Primitive> primitives_;
};

// Certificates of the distance of two solids: planes between sections of their primitives, balls about the primitives,
// or covers of their neighbourhoods.

/// A model, and the data that searches derive from it.
struct SearchedModel {
  explicit SearchedModel(const Model& of) : model(of), solid(of), places(of) {}

  Model model;
  SearchSolid solid;
  ExactChecker places;
};

/// The largest number of cells of a cover; a cover about a neck beside a rim has some 200.
inline constexpr std::size_t most_cells_about_a_primitive = 1000;

/// A certificate by planes alone: they lose least while a model moves.
[[nodiscard]] PairCertificate planes_between(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                                             const SearchedDistance& found, const SearchOptions& options);

/// The certificate as defined by ModelSearch::certified.
[[nodiscard]] PairCertificate certificate_of(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                                             const SearchedDistance& found, const SearchOptions& options);

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
