/// What the host proves of triangles, and the map that it makes with a device.
#include <memory>
#include <string>

#include "host/batches/device_model.hpp"
#include "host/batches/triangle_batch.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/prepared_map.hpp"
#include "host/maps/solid_triangle_map.hpp"
#include "host/maps/tightest_enclosure.hpp"
#include "host/maps/triangle_text.hpp"
#include "verify/search/witness_estimate.hpp"
#include "verify/sets/coarse_distance.hpp"
#include "verisq/error.hpp"
#include "verisq/signed_distance.hpp"
#include "verisq/triangle_distance.hpp"

namespace verisq {
namespace {

class TriangleProver {
 public:
  TriangleProver(const Model& model, const MapOptions& options)
      : certificates_(options.certificates),
        radius_(bounding_radius(model)),
        distance_(model),
        coarse_(model),
        witness_distance_(model) {}

  void check(const Triangle& triangle) const { require_finite(triangle); }
  [[nodiscard]] std::string describe(const Triangle& triangle) const { return text_of(triangle); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Triangle& triangle, const Enclosure& found) const {
    return verified(found, tightest_width(triangle, found, radius_));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Triangle& triangle) const {
    return certificates_ ? distance_.certified(triangle) : CertifiedEnclosure{distance_(triangle), {}};
  }

  [[nodiscard]] CertifiedEnclosure coarse(const Triangle& triangle) const { return coarse_(triangle); }

  [[nodiscard]] bool witnessed(const Triangle& triangle, double hi, const Certificate& certificate) const {
    if (!certificate.weights) return false;
    const auto [w1, w2] = *certificate.weights;
    std::array<long double, 3> q{};
    for (std::size_t i = 0; i < 3; ++i) {
      const long double corner = triangle[0][i];
      q[i] = corner + w1 * (triangle[1][i] - corner) + w2 * (triangle[2][i] - corner);
    }
    return witness_distance_(q, certificate.normals.front()) <= hi;
  }

 private:
  bool certificates_;
  double radius_;
  TriangleDistance distance_;
  verify::CoarseProof coarse_;
  verify::WitnessEstimate witness_distance_;
};

}  // namespace

std::unique_ptr<ExactMap<Triangle>> triangle_map(const Model& model, const MapOptions& options) {
  if (options.method == Method::published) throw Error(ErrorKind::input, "the published method maps points alone");
  if (!is_union_of_convex(model)) return solid_triangle_map(model, options);
  const auto make_batch = [&](const device::Device& device) {
    return device::triangle_batch(device, model, options.certificates);
  };
  return std::make_unique<PreparedMap<Triangle, TriangleProver>>(
      TriangleProver(model, options), options, model, make_batch, device::why_not_as_triangles_or_pairs(model));
}

}  // namespace verisq
