/// By the patch's sample: balls about it that hold the patch.
#include "host/deviation/certified_place.hpp"

#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <variant>

#include "verify/deviation/patch_cover.hpp"

namespace verisq {
namespace {

/// Of a patch's radius: how well the distance of its middle from a boundary has to be known.
constexpr double share_of_radius = 0.25;

}  // namespace

PatchPlacer::PatchPlacer(const Model& model, const SeenInterruption& interrupted)
    : distance_(model), checker_(model), samples_(model), interrupted_(interrupted) {
  for (const Primitive& primitive : model.primitives) each_.emplace_back(Model{model.units, {primitive}, {}});
}

std::optional<CertifiedPoint> PatchPlacer::off_boundary(const verify::Patch& patch, std::size_t primitive) const {
  if (!samples_.is_union()) return off_boundary_of_set(patch);
  for (std::size_t other = 0; other < each_.size(); ++other) {
    if (other == primitive) continue;
    if (auto point = inside(patch, other)) return point;
  }
  return std::nullopt;
}

std::optional<CertifiedPoint> PatchPlacer::on_boundary(const verify::Patch& patch, std::size_t primitive) const {
  CertifiedPoint by{patch.sample, {{-infinity, infinity}, {}}};
  std::vector<Normal> away;
  for (std::size_t other = 0; other < each_.size(); ++other) {
    if (other == primitive) continue;
    const auto normals = away_from(patch, other);
    if (!normals) return std::nullopt;
    away.insert(away.end(), normals->begin(), normals->end());
  }
  if (!samples_.is_union()) {
    by.signed_distance =
        distance_.certified(patch.sample, share_of_radius * patch.radius, [this] { return interrupted_(); });
  }
  std::vector<Normal>& normals = by.signed_distance.certificate.normals;
  normals.insert(normals.end(), away.begin(), away.end());
  const auto proven = [this](const Point& x, const CertifiedEnclosure& claimed) {
    bool proved = false;
    return samples_.distance(x, claimed, proved);
  };
  if (!verify::is_on_boundary(patch, primitive, by, samples_, proven)) return std::nullopt;
  return by;
}

/// Normals that prove its surface farther from the sample than the patch reaches; none where its sphere does.
std::optional<std::vector<Normal>> PatchPlacer::away_from(const verify::Patch& patch, std::size_t other) const {
  const Point& x = patch.sample;
  const auto by_sphere = [&](const auto& solid) { return solid.lower_by_sphere(x); };
  if (std::visit(by_sphere, checker_.primitives()[other]) > patch.radius) return std::vector<Normal>{};
  CertifiedEnclosure one = each_[other].certified(x, share_of_radius * patch.radius);
  const bool is_inside = !samples_.is_union() && one.distance.hi < -patch.radius;
  if (!is_inside && !(one.distance.lo > patch.radius)) return std::nullopt;
  for (Normal& normal : one.certificate.normals) normal.primitive = static_cast<std::uint32_t>(other);
  return std::move(one.certificate.normals);
}

/// By a point inside and one outside, both at a distance of about the tolerance. Set operations have no other
/// certificate of points as near to the boundary as rounding is.
CertifiedEnclosure PatchPlacer::between_both_sides(const Point& x, double tolerance) const {
  CertifiedEnclosure result{{-infinity, infinity}, {}};
  constexpr std::size_t directions = 27;  // -1, 0 and 1 along each axis
  for (std::size_t n = 0; n < directions; ++n) {
    const std::array steps{n % 3, n / 3 % 3, n / 9};
    Point p = x;
    for (std::size_t i = 0; i < 3; ++i) p[i] += tolerance * (static_cast<double>(steps[i]) - 1.0) / std::sqrt(3.0);
    Certificate by_point;
    by_point.escape = p;
    by_point.witness = p;
    const auto [lo, hi] = checker_(x, {-2.0 * tolerance, 2.0 * tolerance}, by_point);
    if (lo > result.distance.lo) std::tie(result.distance.lo, result.certificate.escape) = std::tie(lo, p);
    if (hi < result.distance.hi) std::tie(result.distance.hi, result.certificate.witness) = std::tie(hi, p);
  }
  return result;
}

CertifiedPoint PatchPlacer::near_boundary(const Point& x, double tolerance) const {
  CertifiedPoint point{x, distance_.certified(x, tolerance, [this] { return interrupted_(); })};
  const Enclosure& distance = point.signed_distance.distance;
  if (!std::isfinite(distance.lo) || !std::isfinite(distance.hi))
    point.signed_distance = between_both_sides(x, tolerance);
  return point;
}

/// In a union what lies within another primitive; a ball in that is proven sooner than one in all of them together.
std::optional<CertifiedPoint> PatchPlacer::inside(const verify::Patch& patch, std::size_t other) const {
  const Point& x = patch.sample;
  if (!std::visit([&](const auto& solid) { return solid.contains(x); }, checker_.primitives()[other])) {
    return std::nullopt;
  }
  CertifiedEnclosure within = each_[other].certified(x, share_of_radius * patch.radius);
  if (!(within.distance.hi < -patch.radius)) return std::nullopt;
  // A smaller ball than the largest takes less to be proven.
  const double depth =
      within.certificate.cover.empty() ? 0.5 * (patch.radius - within.distance.hi) : -within.distance.hi;
  within.distance = {-infinity, -depth};
  within.certificate.escape.reset();
  for (Normal& normal : within.certificate.normals) normal.primitive = static_cast<std::uint32_t>(other);
  return proven_off(patch, {x, std::move(within)});
}

std::optional<CertifiedPoint> PatchPlacer::off_boundary_of_set(const verify::Patch& patch) const {
  const auto interrupted = [this] { return interrupted_(); };
  const double tolerance = share_of_radius * patch.radius;
  const Enclosure distance = distance_(patch.sample, tolerance, interrupted);
  if (!verify::is_off_boundary(patch, patch.sample, distance)) return std::nullopt;
  return proven_off(patch, {patch.sample, distance_.certified(patch.sample, tolerance, interrupted)});
}

std::optional<CertifiedPoint> PatchPlacer::proven_off(const verify::Patch& patch, CertifiedPoint point) const {
  const auto& [claimed, certificate] = point.signed_distance;
  if (!verify::is_off_boundary(patch, point.point, checker_(point.point, claimed, certificate))) return std::nullopt;
  return point;
}

}  // namespace verisq
