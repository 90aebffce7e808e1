/// What the host proves of points, and the map that it makes with a device.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "host/batches/model_source.hpp"
#include "host/batches/point_batch.hpp"
#include "host/batches/rows_side_by_side.hpp"
#include "host/batches/solid_batch.hpp"
#include "host/maps/exact_map.hpp"
#include "host/maps/piped_map.hpp"
#include "host/maps/prepared_map.hpp"
#include "host/maps/rough_distance.hpp"
#include "host/maps/tightest_enclosure.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/search/has_taper.hpp"
#include "verify/search/witness_estimate.hpp"
#include "verify/sets/coarse_distance.hpp"
#include "verify/sets/set_tree.hpp"
#include "verisq/error.hpp"
#include "verisq/published_method.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

static_assert(rows_per_block == device::rows_side_by_side);

bool never() {
  return false;
}

double tightest_outside_of(const Model& model) {
  return verify::has_taper(model) ? tightest_outside_of_tapered : tightest_outside;
}

class PointProver {
 public:
  PointProver(const Model& model, const MapOptions& options)
      : model_(model),
        tolerance_(options.tolerance),
        certificates_(options.certificates),
        covers_(options.covers),
        published_(options.method == Method::published),
        out_of_time_(options.out_of_time ? options.out_of_time : never),
        radius_(bounding_radius(model)),
        tightest_outside_(tightest_outside_of(model)),
        distance_(model),
        witness_distance_(model) {
    if (published_ && (certificates_ || options.device != "host"))
      throw Error(ErrorKind::input, "the published method runs on the host alone and has no certificates");
    if (published_) verify::require_union_of_convex(model, "the published method");
    if (published_) verify::require_no_taper(model, "the published method");
    if (certificates_ && !covers_) verify::require_union(model, "certificates without covers");
    refuse_empty(model, distance_, options.interrupted);
    if (!options.out_of_time) return;
    if (certificates_) {
      coarse_proof_ = std::make_unique<verify::CoarseProof>(model);
    } else {
      coarse_distance_ =
          std::make_unique<verify::CoarseDistance>(coarse_distance(model, distance_, options.interrupted));
    }
  }

  void check(const Point& p) const {
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      throw Error(ErrorKind::input, fmt::format("point {} is not finite", describe(p)));
  }

  [[nodiscard]] std::string describe(const Point& p) const { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

  // False for NaN.
  [[nodiscard]] bool at_limit(const Point& point, const Enclosure& found) const {
    return verified(found, tightest_width(point, found, radius_, tightest_outside_));
  }

  [[nodiscard]] CertifiedEnclosure prove(const Point& point) const {
    if (published_) return {published(point), {}};
    return certificates_ ? distance_.certified(point, tolerance_, out_of_time_, covers_)
                         : CertifiedEnclosure{distance_(point, tolerance_, out_of_time_), {}};
  }

  [[nodiscard]] CertifiedEnclosure coarse(const Point& point) const {
    return certificates_ ? (*coarse_proof_)(point) : CertifiedEnclosure{(*coarse_distance_)(point), {}};
  }

  [[nodiscard]] bool witnessed(const Point& point, double hi, const Certificate& certificate) const {
    return witness_distance_({point[0], point[1], point[2]}, certificate.normals.front()) <= hi;
  }

 private:
  // The published method knows points outside: the least of the primitives' distances where all are positive.
  [[nodiscard]] Enclosure published(const Point& point) const {
    Enclosure least = published_distance(model_.primitives.front(), point);
    for (const Primitive& primitive : model_.primitives) {
      const Enclosure other = published_distance(primitive, point);
      least = {std::min(least.lo, other.lo), std::min(least.hi, other.hi)};
    }
    return least.lo > 0.0 ? least : distance_(point, tolerance_);
  }

  Model model_;
  double tolerance_;
  bool certificates_;
  bool covers_;
  bool published_;
  std::function<bool()> out_of_time_;
  double radius_;
  double tightest_outside_;
  SignedDistance distance_;
  verify::WitnessEstimate witness_distance_;
  std::unique_ptr<verify::CoarseDistance> coarse_distance_;  // without certificates, where there is a time limit
  std::unique_ptr<verify::CoarseProof> coarse_proof_;        // with certificates
};

/// Rows as tight as the device's proofs get may still be narrowed by a search, which is told their tolerance: with one
/// of 0 there is no more to ask for.
device::RowCriterion criterion(const MapOptions& options, double radius, bool searched, double outside) {
  const bool open_inside = searched && options.tolerance > 0.0;
  return {options.tolerance, open_inside ? -1.0 : tightest_inside * radius, outside, radius};
}

}  // namespace

std::unique_ptr<ExactMap<Point>> point_map(const Model& model, const MapOptions& options) {
  using Map = PreparedMap<Point, PointProver>;
  std::string unsuited = device::why_not_compiled(model);
  if (!is_union_of_convex(model)) {
    if (options.certificates) unsuited = "certificates of bent solids and set operations are the host's";
    const auto make_batch = [&](const device::Device& device) {
      return device::solid_batch(device, model, options.tolerance);
    };
    return std::make_unique<Map>(PointProver(model, options), options, model, make_batch, unsuited);
  }
  if (options.certificates) {
    const auto make_batch = [&](const device::Device& device) {
      return device::point_batch(device, model, options.tolerance, true);
    };
    return std::make_unique<Map>(PointProver(model, options), options, model, make_batch);
  }
  // Where primitives overlap a depth is that of no single one: it takes a search over cubes, which has no certificates.
  Map::MakeBatch make_search;
  const double radius = bounding_radius(model);
  if (model.primitives.size() > 1 && unsuited.empty()) {
    const double tolerance = std::max(options.tolerance, tightest_inside * radius);
    make_search = [model, tolerance](const device::Device& device) {
      return device::solid_batch(device, model, tolerance);
    };
  }
  return std::make_unique<PipedMap<PointProver>>(
      PointProver(model, options), options, model,
      criterion(options, radius, make_search != nullptr, tightest_outside_of(model)), make_search);
}

}  // namespace verisq
