/// Those of the whole model, and of each primitive alone.
#include "host/deviation/certified_samples.hpp"

#include <cstdint>
#include <utility>

#include "verify/proof/convex_union.hpp"

namespace verisq {

CertifiedSamples::CertifiedSamples(const Model& model, double tolerance)
    : model_(model), checked_(model), tolerance_(tolerance) {
  if (!verify::is_union(model) || model.primitives.size() == 1) return;
  for (const Primitive& primitive : model.primitives) {
    each_.push_back({SignedDistance(Model{model.units, {primitive}, {}}), is_bent(primitive)});
  }
}

CertifiedEnclosure CertifiedSamples::at(const Point& x, const std::function<bool()>& interrupted) const {
  return model_.certified(x, tolerance_, interrupted);
}

bool CertifiedSamples::is_one_convex(const Point& x, double reach, Certificate& certificate) const {
  if (each_.empty()) return false;
  if (checked_.is_one_convex(x, reach, certificate)) return true;
  std::vector<Normal> others;
  bool one_near = false;
  for (std::uint32_t i = 0; i < each_.size(); ++i) {
    const CertifiedEnclosure one = each_[i].distance.certified(x, tolerance_);
    if (!(one.distance.lo >= reach)) {
      if (std::exchange(one_near, true) || each_[i].bent) return false;
      continue;
    }
    for (const auto& [primitive, v] : one.certificate.normals) others.push_back({i, v});
  }
  certificate.normals.insert(certificate.normals.end(), others.begin(), others.end());
  return one_near;
}

}  // namespace verisq
