/// What two proofs of the same distance say together.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "verisq/certificate.hpp"
#include "verisq/error.hpp"

namespace verisq {

/// Both contain the exact value; if they have nothing in common one of them is wrong, which must never pass silently:
/// throws Error(failure) that names the query.
[[nodiscard]] inline Enclosure intersection(const Enclosure& a, const Enclosure& b, const std::string& query) {
  const Enclosure both{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
  if (both.lo <= both.hi) return both;
  throw Error(ErrorKind::failure, fmt::format("device and host contradict each other at {}: [{}, {}] and [{}, {}]; "
                                              "please report",
                                              query, a.lo, a.hi, b.lo, b.hi));
}

/// The certificate of an intersection: upper end first, as certificates want it, then what proves the lower end.
[[nodiscard]] inline Certificate merged(const CertifiedEnclosure& a, const CertifiedEnclosure& b) {
  const CertifiedEnclosure& upper = b.distance.hi < a.distance.hi ? b : a;
  const CertifiedEnclosure& lower = b.distance.lo > a.distance.lo ? b : a;
  Certificate both{upper.certificate.normals, lower.certificate.escape, upper.certificate.weights};
  if (&lower != &upper)
    both.normals.insert(both.normals.end(), lower.certificate.normals.begin(), lower.certificate.normals.end());
  return both;
}

}  // namespace verisq
