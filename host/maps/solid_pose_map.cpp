/// What the host proves of poses of bent solids and set operations.
#include "host/maps/solid_pose_map.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>

#include "host/maps/pose_text.hpp"
#include "host/maps/prepared_map.hpp"
#include "host/maps/rough_distance.hpp"
#include "host/maps/tightest_enclosure.hpp"
#include "verify/analysis/largest_coordinate.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/sets/bounded_motion.hpp"
#include "verify/sets/bounding_box.hpp"
#include "verisq/model_search.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

/// Asked by many threads in turn. Once true it stays so.
class Interrupted {
 public:
  explicit Interrupted(const std::function<bool()>& poll) : poll_(poll) {}

  bool operator()() {
    if (!seen_) {
      const std::lock_guard lock(polling_);
      if (poll_()) seen_ = true;
    }
    return seen_;
  }
  [[nodiscard]] bool seen() const { return seen_; }
  void forget() { seen_ = false; }

 private:
  std::function<bool()> poll_;
  std::mutex polling_;
  std::atomic<bool> seen_ = false;
};

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
        out_of_time_(options.out_of_time),
        interrupted_(std::make_unique<Interrupted>(options.interrupted)),
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
    const auto stop = [this] { return (*interrupted_)() || (out_of_time_ && out_of_time_()); };
    return {search_(pose, {.tolerance = tolerance_, .interrupted = stop}).distance, {}};
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

  // A search takes up to minutes: it ends when the map is interrupted, and its row is not told.
  void begin() const { interrupted_->forget(); }
  [[nodiscard]] bool interrupted() const { return interrupted_->seen(); }

 private:
  double radius_;
  double tolerance_;
  std::function<bool()> out_of_time_;  // empty: no limit
  std::unique_ptr<Interrupted> interrupted_;
  Reach a_;
  Reach b_;
  ModelSearch search_;
};

}  // namespace

std::unique_ptr<ExactMap<Pose>> solid_pose_map(const Model& a, const Model& b, const MapOptions& options) {
  if (options.certificates) throw Error(ErrorKind::input, "maps of poses have no certificates");
  if (options.point_radius != 0.0) throw Error(ErrorKind::input, "maps of poses have no points with a radius");
  MapOptions of_host = options;
  if (of_host.device == "auto") of_host.device = "host";  // with a device that is named, the notice says why
  return std::make_unique<PreparedMap<Pose, SolidPoseProver>>(
      SolidPoseProver(a, b, options), of_host, a, PreparedMap<Pose, SolidPoseProver>::MakeBatch(),
      "poses of bent solids and set operations are searched on the host");
}

}  // namespace verisq
