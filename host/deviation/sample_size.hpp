/// About how many bytes of a certificate file a point's certificate takes.
#pragma once

#include <cstddef>

#include "verisq/certificate.hpp"
#include "verisq/deviation_certificate.hpp"

namespace verisq {

[[nodiscard]] inline std::size_t size_of(const CertifiedEnclosure& sample) {
  const auto& [normals, escape, weights, witness, cover] = sample.certificate;
  return 80 + 75 * normals.size() + (escape ? 75 : 0) + (witness ? 75 : 0) + cover.size() / 4;
}

[[nodiscard]] inline std::size_t size_of(const CertifiedPoint& point) {
  return 80 + size_of(point.signed_distance);
}

}  // namespace verisq
