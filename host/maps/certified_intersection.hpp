/// What proves the intersection of two certified enclosures.
#pragma once

#include "verisq/certificate.hpp"

namespace verisq {

/// The certificate of an intersection: upper end first, as certificates want it, then what proves the lower end.
[[nodiscard]] inline Certificate merged(const CertifiedEnclosure& a, const CertifiedEnclosure& b) {
  const CertifiedEnclosure& upper = b.distance.hi < a.distance.hi ? b : a;
  const CertifiedEnclosure& lower = b.distance.lo > a.distance.lo ? b : a;
  Certificate both{upper.certificate.normals, lower.certificate.escape, upper.certificate.weights};
  if (&lower != &upper)
    both.normals.insert(both.normals.end(), lower.certificate.normals.begin(), lower.certificate.normals.end());
  // A cover is of one of the two ends, and goes with the points that it was made with.
  const Certificate& of_cover = lower.certificate.cover.empty() ? upper.certificate : lower.certificate;
  both.witness = of_cover.witness ? of_cover.witness : upper.certificate.witness;
  if (of_cover.escape) both.escape = of_cover.escape;
  both.cover = of_cover.cover;
  return both;
}

}  // namespace verisq
