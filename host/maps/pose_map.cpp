/// What the host proves of poses, and the map that it makes with a device.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "host/batches/device_model.hpp"
#include "host/batches/pose_batch.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/pose_text.hpp"
#include "host/maps/prepared_map.hpp"
#include "host/maps/solid_pose_map.hpp"
#include "host/maps/tightest_enclosure.hpp"
#include "verify/sets/bounded_motion.hpp"
#include "verisq/error.hpp"
#include "verisq/model_distance.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

class PoseProver {
 public:
  PoseProver(const Model& a, const Model& b, const MapOptions& options)
      : out_of_time_(options.out_of_time),
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
    return {distance_(pose, *memory, out_of_time_).distance, {}};
  }

  // The centre of a primitive lies in it.
  [[nodiscard]] CertifiedEnclosure coarse(const Pose& pose) const {
    return {{0.0, verify::BoundedMotion(pose).distance_up(centre_a_, centre_b_)}, {}};
  }

  // There are no certificates.
  [[nodiscard]] bool witnessed(const Pose& /*pose*/, double /*hi*/, const Certificate& /*none*/) const { return true; }

 private:
  /// One for each thread at work: that of poses which are neighbours, or nearly.
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

  std::function<bool()> out_of_time_;  // empty: no limit
  double radius_;
  Point centre_a_;
  Point centre_b_;
  PairDistance distance_;
  std::unique_ptr<Memories> memories_ = std::make_unique<Memories>();
};

}  // namespace

std::unique_ptr<ExactMap<Pose>> pose_map(const Model& a, const Model& b, const MapOptions& options) {
  if (!is_union_of_convex(a) || !is_union_of_convex(b)) return solid_pose_map(a, b, options);
  if (options.certificates) throw Error(ErrorKind::input, "maps of poses have no certificates");
  if (options.point_radius != 0.0) throw Error(ErrorKind::input, "maps of poses have no points with a radius");
  const auto make_batch = [&](const device::Device& device) { return device::pose_batch(device, a, b); };
  const Model both = device::joined(a, b);
  return std::make_unique<PreparedMap<Pose, PoseProver>>(PoseProver(a, b, options), options, both, make_batch,
                                                         device::why_not_as_triangles_or_pairs(both));
}

}  // namespace verisq
