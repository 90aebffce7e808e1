/// What two certified enclosures of one value say together.
#pragma once

#include <utility>

#include "verify/proof/intersection.hpp"
#include "verisq/certificate.hpp"

namespace verisq {

/// With what proves it: upper end first, as certificates want it, then what proves the lower end. All of `b` where that
/// has a cover, which goes with the points that it was made with. `what` names the value, as verify::intersection wants
/// it.
template <class What>
[[nodiscard]] CertifiedEnclosure certified_intersection(const CertifiedEnclosure& a, const CertifiedEnclosure& b,
                                                        const What& what) {
  const Enclosure both = verify::intersection(a.distance, b.distance, what);
  if (!b.certificate.cover.empty()) return b;
  const CertifiedEnclosure& upper = b.distance.hi < a.distance.hi ? b : a;
  const CertifiedEnclosure& lower = b.distance.lo > a.distance.lo ? b : a;
  Certificate certificate{upper.certificate.normals, lower.certificate.escape, upper.certificate.weights,
                          upper.certificate.witness};
  if (&lower != &upper) {
    certificate.normals.insert(certificate.normals.end(), lower.certificate.normals.begin(),
                               lower.certificate.normals.end());
  }
  return {both, std::move(certificate)};
}

}  // namespace verisq
