/// Spreads ways over caps of directions and turns, ever smaller ones about the best.
#include "verisq/least_removal.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "host/errors/refusal.hpp"
#include "host/mesh/eigen_points.hpp"

namespace verisq {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double widest_cone = 80.0;
constexpr double largest_turn = 180.0;
constexpr double largest_turn_of_way = 360.0;

/// Ways of each round, the middle one besides.
constexpr std::array<std::size_t, 4> ways_of_rounds{15, 12, 12, 12};
/// From a round to the next, of cone and turn.
constexpr double shrinking = 0.4;

/// Of a way that is compared, at most: of turning ways more would cost minutes each.
constexpr std::uint64_t most_cubes_compared = std::uint64_t{1} << 16U;

/// Of a low-discrepancy sequence in three dimensions: powers of the root of x⁴ = x + 1 (M. Roberts, "The unreasonable
/// effectiveness of quasirandom sequences", 2018).
constexpr double generalised_golden_ratio = 1.2207440846057596;

double fraction(double x) {
  return x - std::floor(x);
}

void check_family(const WaysIn& ways) {
  if (!(ways.cone_degrees >= 0.0 && ways.cone_degrees <= widest_cone))
    refuse(fmt::format("ways in: a cone of {} degrees is not between 0 and {}", ways.cone_degrees, widest_cone));
  if (!(ways.turn_degrees >= 0.0 && ways.turn_degrees <= largest_turn))
    refuse(fmt::format("ways in: turns by {} degrees are not between 0 and {}", ways.turn_degrees, largest_turn));
  const double farthest = std::abs(ways.middle.turn_degrees) + ways.turn_degrees;
  if (!(farthest <= largest_turn_of_way))
    refuse(fmt::format("ways in: turns by up to {} degrees are beyond {}", farthest, largest_turn_of_way));
  if (ways.cone_degrees == 0.0 && ways.turn_degrees == 0.0)
    refuse("ways in: with neither a cone nor turns there is one way");
}

/// Off the axis by `angle`, in the direction of `azimuth` about it.
Eigen::Vector3d tilted(const Eigen::Vector3d& axis, double angle, double azimuth) {
  const Eigen::Vector3d across = axis.unitOrthogonal();
  const Eigen::Vector3d other = axis.cross(across);
  return std::cos(angle) * axis + std::sin(angle) * (std::cos(azimuth) * across + std::sin(azimuth) * other);
}

/// The direction, or the nearest one that is off the axis by no more than `angle`.
Eigen::Vector3d within_cone(const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d off_axis = direction - direction.dot(axis) * axis;
  if (std::atan2(off_axis.norm(), direction.dot(axis)) <= angle || !(off_axis.norm() > 0.0)) return direction;
  return std::cos(angle) * axis + std::sin(angle) * off_axis.normalized();
}

class WaySearch {
 public:
  WaySearch(const WaysIn& ways, const Point& centre, const Model& implant, const BoneRegion& bone,
            const LeastRemovalOptions& options)
      : ways_(ways),
        axis_(vector_of(ways.middle.direction).stableNormalized()),
        centre_(centre),
        implant_(implant),
        bone_(bone),
        options_(options) {}

  LeastRemoval operator()() {
    LeastRemoval found{};
    found.of_middle = consider(ways_.middle);
    double share = 1.0;
    for (const std::size_t ways : ways_of_rounds) {
      const WayIn about = best_;
      for (std::size_t k = 0; k < ways && !options_.volume.interrupted(); ++k) consider(way_about(about, share));
      share *= shrinking;
    }
    found.way = best_;
    found.path = path_of(best_, centre_);
    found.removed = removed_volume(found.path, implant_, bone_, options_.volume);
    found.tried = volumes_.size();
    found.worse = static_cast<std::size_t>(
        std::ranges::count_if(volumes_, [&](const Enclosure& volume) { return volume.lo > found.removed.volume.hi; }));
    found.interrupted = options_.volume.interrupted();
    return found;
  }

 private:
  /// The next one of the sequence, in a share of the family about this way.
  WayIn way_about(const WayIn& about, double share) {
    ++drawn_;
    const auto n = static_cast<double>(drawn_);
    const double radius = fraction(0.5 + n / generalised_golden_ratio);
    const double azimuth = fraction(0.5 + n / std::pow(generalised_golden_ratio, 2));
    const double turn = fraction(0.5 + n / std::pow(generalised_golden_ratio, 3));
    const double cone = ways_.cone_degrees * degree;
    // Evenly over the cap: its area within an angle grows with the angle's square, nearly.
    const Eigen::Vector3d drawn = tilted(vector_of(about.direction).stableNormalized(),
                                         share * cone * std::sqrt(radius), 2.0 * std::numbers::pi * azimuth);
    WayIn way = about;
    if (ways_.cone_degrees > 0.0) way.direction = point_of(within_cone(axis_, cone, drawn));
    const double middle = ways_.middle.turn_degrees;
    way.turn_degrees = std::clamp(about.turn_degrees + share * ways_.turn_degrees * (2.0 * turn - 1.0),
                                  middle - ways_.turn_degrees, middle + ways_.turn_degrees);
    return way;
  }

  /// What it takes away, or enough to see that this is more than the best does.
  Enclosure consider(const WayIn& way) {
    RemovedVolumeOptions options = options_.volume;
    options.relative_tolerance = std::max(options.relative_tolerance, options_.relative_tolerance);
    options.most_cubes = std::min(options.most_cubes, most_cubes_compared);
    double known = 0.0;
    options.progress = [&known](const Enclosure& volume) { known = volume.lo; };
    options.interrupted = [&] { return known > least_.hi || options_.volume.interrupted(); };
    const Enclosure volume = removed_volume(path_of(way, centre_), implant_, bone_, options).volume;
    if (volumes_.empty() || volume.hi < least_.hi) {
      least_ = volume;
      best_ = way;
    }
    volumes_.push_back(volume);
    options_.progress({volumes_.size(), all_ways(), least_});
    return volume;
  }

  static std::size_t all_ways() {
    std::size_t ways = 1;
    for (const std::size_t more : ways_of_rounds) ways += more;
    return ways;
  }

  const WaysIn& ways_;
  Eigen::Vector3d axis_;
  Point centre_;
  const Model& implant_;
  const BoneRegion& bone_;
  const LeastRemovalOptions& options_;
  std::size_t drawn_ = 0;
  WayIn best_{};
  Enclosure least_{0.0, infinity};
  std::vector<Enclosure> volumes_;
};

}  // namespace

LeastRemoval least_removal(const WaysIn& ways, const Point& centre, const Model& implant, const BoneRegion& bone,
                           const LeastRemovalOptions& options) {
  check_family(ways);
  static_cast<void>(path_of(ways.middle, centre));  // refuses what is no way
  return WaySearch(ways, centre, implant, bone, options)();
}

}  // namespace verisq
