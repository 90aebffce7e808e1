/// How deep an implant cuts into the bone on its way in: the bone that must be removed.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/map_result.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Poses along a straight way into the last pose: `steps` + 1 poses, equally spaced over `length` against the
/// direction, so that the motion ends in `last` moving along the direction. Precondition: direction not zero, finite;
/// length > 0; steps > 0.
[[nodiscard]] std::vector<Pose> straight_path(const Pose& last, const Point& direction, double length,
                                              std::size_t steps);

/// A way of `length` along the direction into the pose where the implant's file has it, on which the implant turns
/// about the direction (right-handed, through a point that is said elsewhere) at constant speed.
struct WayIn {
  Point direction;  ///< not zero
  double length;    ///< > 0
  double turn_degrees = 0.0;
};

/// Poses so close to each other that the way hardly leaves the screw about an axis through `centre`: what is between
/// them is as said below. A way without a turn has two. Throws Error(input) for what is not finite or out of range.
[[nodiscard]] std::vector<Pose> path_of(const WayIn& way, const Point& centre);

/// The middle of the box that bounds the implant: about which fits turn it, and ways in do.
[[nodiscard]] Point turning_centre(const Model& implant);

/// Between two poses of a path the translation is linear in time and the rotation turns about a fixed axis at constant
/// speed, by the smaller angle (of opposite orientations either way).
struct InsertionOptions {
  double tolerance;             ///< of the enclosures, in model units, > 0: a coarse path cannot reach a fine one
  std::string device = "auto";  ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
  std::function<void(double done)> progress = [](double) {};
};

/// For each point of the bone the smallest signed distance to the implant along the whole path, between the poses too:
/// minus the depth of bone to be removed there where it is negative. `rows` in the order of the points.
struct Insertion {
  std::vector<MapResult> rows;
  std::vector<double> deepest;  ///< of each row a time, k at pose k, of which the distance is at most the upper end
  MapSummary summary;
};

/// The implant (any model) moves by the poses after its primitives' own. Proven between the poses by how far a point of
/// the bone moves in the implant's frame. Throws Error(input) for a path without poses, for poses that are not finite
/// or have a zero quaternion, and as Mapper.
[[nodiscard]] Insertion smallest_distance_along(std::span<const Pose> path, const Model& implant,
                                                std::span<const Point> bone, const InsertionOptions& options);

/// So many points are searched together: on a processor's device a row may depend, in its last bits, on the others.
inline constexpr std::size_t points_per_insertion_block = 1024;

/// The same, some of the points at a time: whole blocks of them give the rows that all points together do.
class InsertionMapper {
 public:
  /// `bone` must outlive this. Throws as `smallest_distance_along`.
  InsertionMapper(std::span<const Pose> path, const Model& implant, std::span<const Point> bone,
                  const InsertionOptions& options);
  ~InsertionMapper();
  InsertionMapper(InsertionMapper&&) noexcept;
  InsertionMapper& operator=(InsertionMapper&&) noexcept;

  /// Precondition: points of the bone; `progress` tells of them alone.
  [[nodiscard]] Insertion operator()(std::size_t first, std::size_t count);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
