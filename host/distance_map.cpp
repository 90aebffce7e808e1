/// This file implements the map of points.
#include "verisq/distance_map.hpp"

#include <algorithm>
#include <cmath>

#include "host/device/point_batch.hpp"
#include "host/map_run.hpp"
#include "verify/witness_estimate.hpp"
#include "verisq/error.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

// With a tolerance below these widths the host is asked only for what is wider than them: the device's certificates
// outside, and its branch and bound inside, are then as good as the methods are (design 2, §2, §5).
constexpr double outside_limit = 1e-12;  // of max(largest |coordinate|, radius of the model)
constexpr double inside_limit = 2e-9;    // of the radius of the model

class PointProver {
 public:
  PointProver(const Model& model, const MapOptions& options)
      : tolerance_(options.tolerance),
        certificates_(options.certificates),
        radius_(bounding_radius(model)),
        distance_(model),
        witness_distance_(model) {}

  void check(const Point& p) const {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      throw Error(ErrorKind::input, fmt::format("point {} is not finite", describe(p)));
  }

  [[nodiscard]] std::string describe(const Point& p) const { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Point& point, const Enclosure& found) const {
    if (found.lo < 0.0) return verified(found, inside_limit * radius_);
    const double size = std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2]), radius_});
    return verified(found, outside_limit * size);
  }

  [[nodiscard]] CertifiedEnclosure prove(const Point& point) const {
    return certificates_ ? distance_.certified(point, tolerance_)
                         : CertifiedEnclosure{distance_(point, tolerance_), {}};
  }

  [[nodiscard]] bool witnessed(const Point& point, double hi, const Certificate& certificate) const {
    return witness_distance_({point[0], point[1], point[2]}, certificate.normals.front()) <= hi;
  }

 private:
  double tolerance_;
  bool certificates_;
  double radius_;
  SignedDistance distance_;
  verify::WitnessEstimate witness_distance_;
};

}  // namespace

struct DistanceMapper::State {
  Mapping<Point, PointProver, device::PointBatch> mapping;
};

DistanceMapper::DistanceMapper(const Model& model, const MapOptions& options)
    : state_(new State{{PointProver(model, options), options, model, [&](auto& batch, const device::Device& device) {
                          batch.emplace(device, model, options.tolerance, options.certificates);
                        }}}) {}
DistanceMapper::~DistanceMapper() = default;
DistanceMapper::DistanceMapper(DistanceMapper&&) noexcept = default;
DistanceMapper& DistanceMapper::operator=(DistanceMapper&&) noexcept = default;

MapSummary DistanceMapper::map(const PointSource& source, const MapSink& sink) {
  return state_->mapping.map(source, sink);
}

MapSummary map_points(const Model& model, const PointSource& source, const MapSink& sink, const MapOptions& options) {
  return DistanceMapper(model, options).map(source, sink);
}

}  // namespace verisq
