/// Maps of a model in many poses, and closest points there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/device/device_model.hpp"
#include "host/device/program_self_test.hpp"
#include "host/device/query_batches.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "host/maps/uncertain_map.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_pair_cells.hpp"
#include "verisq/device.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"
#include "verisq/model.hpp"

namespace verisq {

// Text of poses for messages of maps.

[[nodiscard]] inline std::string text_of(const Pose& pose) {
  const auto& [t, q] = pose;
  return fmt::format("({}, {}, {}), quaternion ({}, {}, {}, {})", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

namespace {

/// Throws Error(input) unless all numbers are finite and the quaternion is not zero.
inline void require_pose(const Pose& pose) {
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::ranges::all_of(pose.translation, finite) || !std::ranges::all_of(pose.quaternion, finite))
    throw Error(ErrorKind::input, fmt::format("pose {} is not finite", text_of(pose)));
  if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0.0; }))
    throw Error(ErrorKind::input, fmt::format("pose {} has a zero quaternion", text_of(pose)));
}

// The map of poses where a model has a bend or set operations.

/// A point and how far the solid reaches from it, rounded up.
struct Reach {
  Point centre;
  double radius;
};

Reach reach_of(const Model& model) {
  using verify::PreciseInterval;
  using verify::Real;
  const verify::Box box = verify::bounding_box(model);
  Reach reach{};
  verify::PreciseVector half;
  for (std::size_t i = 0; i < 3; ++i) {
    reach.centre[i] = 0.5 * box.lower[i] + 0.5 * box.upper[i];
    const PreciseInterval sides(Real(box.lower[i]), Real(box.upper[i]));
    half[i] = abs(sides - PreciseInterval(Real(reach.centre[i])));
  }
  reach.radius = verify::length<Real>(half).upper().to_double(verify::Direction::up);
  return reach;
}

class SolidPoseProver {
 public:
  SolidPoseProver(const Model& a, const Model& b, const MapOptions& options)
      : radius_(std::max(bounding_radius(a), bounding_radius(b))),
        tolerance_(std::max(options.tolerance, tightest_inside * radius_)),
        stop_(either(options.interrupted, options.out_of_time)),
        a_(reach_of(a)),
        b_(reach_of(b)),
        search_(a, b) {
    for (const Model* model : {&a, &b}) refuse_empty(*model, SignedDistance(*model), options.interrupted);
  }

  void check(const Pose& pose) const { require_pose(pose); }
  [[nodiscard]] std::string describe(const Pose& pose) const { return text_of(pose); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Pose& pose, const Enclosure& found) const {
    return verified(found,
                    std::max(tightest_inside * radius_,
                             tightest_outside * std::max(verify::largest_coordinate(pose.translation), radius_)));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Pose& pose) const {
    return {search_(pose, {.tolerance = tolerance_, .interrupted = stop_}).distance, {}};
  }

  // Any two points are at most so far apart.
  [[nodiscard]] CertifiedEnclosure coarse(const Pose& pose) const {
    using verify::Direction;
    const double centres = verify::BoundedMotion(pose).distance_up(a_.centre, b_.centre);
    const double reaches = verify::add(a_.radius, b_.radius, Direction::up);
    return {{0.0, verify::add(centres, reaches, Direction::up)}, {}};
  }

  // There are no certificates.
  [[nodiscard]] bool witnessed(const Pose& /*pose*/, double /*hi*/, const Certificate& /*none*/) const { return true; }

 private:
  double radius_;
  double tolerance_;
  std::function<bool()> stop_;
  Reach a_;
  Reach b_;
  ModelSearch search_;
};

/// Like pose_map, by ModelSearch, pose by pose on all processors: kernels do not support such pairs. Throws the same
/// Error(input), and for a model that is proven to have no point.
std::unique_ptr<ExactMap<Pose>> solid_pose_map(const Model& a, const Model& b, const MapOptions& options) {
  if (options.certificates) throw Error(ErrorKind::input, "maps of poses have no certificates");
  if (options.point_radius != 0.0) throw Error(ErrorKind::input, "maps of poses have no points with a radius");
  MapOptions of_host = options;
  if (of_host.device == "auto") of_host.device = "host";  // with a device that is named, the notice says why
  return std::make_unique<PreparedMap<Pose, SolidPoseProver>>(
      SolidPoseProver(a, b, options), of_host, a, PreparedMap<Pose, SolidPoseProver>::MakeBatch(),
      "poses of bent solids and set operations are searched on the host");
}

class PoseProver {
 public:
  PoseProver(const Model& a, const Model& b, const MapOptions& options)
      : stop_(either(options.interrupted, options.out_of_time)),
        radius_(std::max(bounding_radius(a), bounding_radius(b))),
        centre_a_(a.primitives.front().pose.translation),
        centre_b_(b.primitives.front().pose.translation),
        distance_(a, b) {}

  void check(const Pose& pose) const { require_pose(pose); }
  [[nodiscard]] std::string describe(const Pose& pose) const { return text_of(pose); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Pose& pose, const Enclosure& found) const {
    const auto& t = pose.translation;
    return verified(found, tightest_width(t, found, radius_));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Pose& pose) const {
    const Lent memory(*memories_);
    return {distance_(pose, *memory, stop_).distance, {}};
  }

  // The centre of a primitive lies in it.
  [[nodiscard]] CertifiedEnclosure coarse(const Pose& pose) const {
    return {{0.0, verify::BoundedMotion(pose).distance_up(centre_a_, centre_b_)}, {}};
  }

  // There are no certificates.
  [[nodiscard]] bool witnessed(const Pose& /*pose*/, double /*hi*/, const Certificate& /*none*/) const { return true; }

 private:
  /// The memory of each thread at work, for poses that are neighbours, or nearly.
  class Memories {
   public:
    std::unique_ptr<PairDistance::Memory> taken() {
      const std::lock_guard lock(mutex_);
      if (free_.empty()) return std::make_unique<PairDistance::Memory>();
      auto last = std::move(free_.back());
      free_.pop_back();
      return last;
    }
    void give_back(std::unique_ptr<PairDistance::Memory> memory) {
      const std::lock_guard lock(mutex_);
      free_.push_back(std::move(memory));
    }

   private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<PairDistance::Memory>> free_;
  };

  class Lent {
   public:
    explicit Lent(Memories& memories) : memories_(memories), memory_(memories.taken()) {}
    ~Lent() { memories_.give_back(std::move(memory_)); }
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;
    PairDistance::Memory& operator*() const { return *memory_; }

   private:
    Memories& memories_;
    std::unique_ptr<PairDistance::Memory> memory_;
  };

  std::function<bool()> stop_;
  double radius_;
  Point centre_a_;
  Point centre_b_;
  PairDistance distance_;
  std::unique_ptr<Memories> memories_ = std::make_unique<Memories>();
};

std::unique_ptr<ExactMap<Pose>> pose_map(const Model& a, const Model& b, const MapOptions& options) {
  if (!is_union_of_convex(a) || !is_union_of_convex(b)) return solid_pose_map(a, b, options);
  if (options.certificates) throw Error(ErrorKind::input, "maps of poses have no certificates");
  if (options.point_radius != 0.0) throw Error(ErrorKind::input, "maps of poses have no points with a radius");
  const auto make_batch = [a, b](const device::Device& device) {
    return device::pose_batch(device, a, b, device::pose_distances_by_host);
  };
  const Model both = device::joined(a, b);
  return std::make_unique<PreparedMap<Pose, PoseProver>>(PoseProver(a, b, options), options, both, make_batch,
                                                         device::why_not_as_triangles_or_pairs(both));
}

ClosestPoints anywhere() {
  constexpr Enclosure anything{-infinity, infinity};
  return {{anything, anything, anything}, {anything, anything, anything}, false};
}

}  // namespace

ClosestPointSummary closest_points(const PairDistance& distance, std::span<const Pose> poses,
                                   std::span<ClosestPoints> rows, const std::function<bool()>& interrupted) {
  if (rows.size() != poses.size()) {
    throw Error(ErrorKind::input, fmt::format("{} rows for the closest points of {} poses", rows.size(), poses.size()));
  }
  const SeenInterruption seen(interrupted);
  const std::function<bool()> stop = [&seen] { return seen(); };
  const std::size_t done = in_parallel_until(seen, poses.size(), [&](std::size_t k) {
    rows[k] = distance.closest_points(distance(poses[k], stop), poses[k], stop).value_or(anywhere());
  });
  for (ClosestPoints& row : rows.subspan(done)) row = anywhere();
  ClosestPointSummary summary = summary_of(rows.first(done));
  summary.interrupted = done < poses.size();
  return summary;
}

namespace {

using verify::MemberBounds;

BracketedMap<Pose> maps_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  BracketedMap<Pose> maps{pose_map(a.smallest, b.smallest, options), std::nullopt, std::nullopt};
  if (!verify::same_solids(a) || !verify::same_solids(b)) maps.largest = pose_map(a.largest, b.largest, options);
  return maps;
}

BracketMap<Pose> bracket_map_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  for (const Bracket* models : {&a, &b}) refuse_empty_members(*models, options.interrupted);
  const MemberBounds bounds(a, b);
  return {bounds, options, maps_of(a, b, of_one_end(bounds, options))};
}

}  // namespace

UncertainPoseMap<Pose> map_of(const Bracket& a, const Bracket& b, const MapOptions& options) {
  check_uncertain_pose(options, false);
  const double reach = reach_of(options, b.largest);
  return {options, reach, bracket_map_of(a, b, at_nominal_pose(options, reach))};
}

template class Mapper<Pose>;

}  // namespace verisq
