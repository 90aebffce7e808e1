/// What the host proves of triangles about bent solids and set operations, and the map that it makes with a device.
#include "host/maps/solid_triangle_map.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "host/batches/device_model.hpp"
#include "host/batches/model_source.hpp"
#include "host/batches/solid_triangle_batch.hpp"
#include "host/maps/prepared_map.hpp"
#include "host/maps/rough_distance.hpp"
#include "host/maps/tightest_enclosure.hpp"
#include "host/maps/triangle_text.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/sets/coarse_distance.hpp"
#include "verify/sets/triangle_pieces.hpp"
#include "verisq/signed_distance.hpp"
#include "verisq/triangle_search.hpp"

namespace verisq {
namespace {

/// As tight as searches get, where a tolerance of 0 asks for that.
double searched_tolerance(const MapOptions& options, double radius) {
  return std::max(options.tolerance, tightest_inside * radius);
}

class SolidTriangleProver {
 public:
  SolidTriangleProver(const Model& model, const MapOptions& options)
      : certificates_(options.certificates),
        radius_(bounding_radius(model)),
        tolerance_(searched_tolerance(options, radius_)),
        out_of_time_(options.out_of_time),
        search_(model) {
    if (certificates_ && !options.covers) verify::require_union_of_convex(model, "certificates without covers");
    const SignedDistance distance(model);
    refuse_empty(model, distance, options.interrupted);
    if (options.out_of_time) coarse_ = coarse_distance(model, distance, options.interrupted);
  }

  void check(const Triangle& triangle) const { require_finite(triangle); }
  [[nodiscard]] std::string describe(const Triangle& triangle) const { return text_of(triangle); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Triangle& triangle, const Enclosure& found) const {
    return verified(found, std::max(tightest_inside * radius_, tightest_width(triangle, found, radius_)));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Triangle& triangle) const {
    if (certificates_) return search_.certified(triangle, tolerance_, out_of_time_);
    return {search_(triangle, tolerance_, out_of_time_), {}};
  }

  [[nodiscard]] CertifiedEnclosure coarse(const Triangle& triangle) const {
    if (certificates_) return {{0.0, infinity}, {}};  // nothing else has one
    const verify::DividedTriangle divided(triangle);
    const Enclosure at_corner = (*coarse_)(triangle[0]);
    const double lower = std::max(0.0, divided.lower_by_ball(triangle, triangle[0], at_corner.lo));
    return {{lower, divided.upper_by_point(at_corner.hi)}, {}};
  }

  [[nodiscard]] bool witnessed(const Triangle& /*triangle*/, double /*hi*/, const Certificate& /*none*/) const {
    return false;
  }

 private:
  bool certificates_;
  double radius_;
  double tolerance_;
  std::function<bool()> out_of_time_;
  TriangleSearch search_;
  std::optional<verify::CoarseDistance> coarse_;  // where there is a time limit
};

}  // namespace

std::unique_ptr<ExactMap<Triangle>> solid_triangle_map(const Model& model, const MapOptions& options) {
  const std::string unsuited = options.certificates ? "certificates of bent solids and set operations are the host's"
                                                    : device::why_not_compiled(model);
  const auto make_batch = [&](const device::Device& device) {
    const double tolerance = searched_tolerance(options, bounding_radius(model));
    return device::solid_triangle_batch(device, model, tolerance, options.out_of_time);
  };
  return std::make_unique<PreparedMap<Triangle, SolidTriangleProver>>(SolidTriangleProver(model, options), options,
                                                                      model, make_batch, unsuited);
}

}  // namespace verisq
