/// Proposes normals part by part and an escape, and asks the checker how much they prove.
#include "verify/sets/bent_union_certificate.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/distance_up.hpp"
#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/union_of_convex.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

double sphere_bound_of(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& solid) { return solid.proof().lower_by_sphere(x); }, part);
}

bool contains(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& solid) { return solid.proof().contains(x); }, part);
}

/// The ends and the normals of all parts that may be the nearest, that of the upper end first.
CertifiedEnclosure of_parts(std::span<const UnionPart> parts, const Point& x) {
  CertifiedEnclosure result{{infinity, infinity}, {}};
  auto& [distance, certificate] = result;
  const auto bound_of = [&](std::size_t i) { return sphere_bound_of(parts[i], x); };
  for (const auto& [bound, i] : nearest_spheres_first(parts.size(), bound_of)) {
    if (bound > distance.hi) break;  // neither this part nor a later one can be the nearest
    const CertifiedEnclosure found = certificate_of_part(parts[i], static_cast<std::uint32_t>(i), x);
    const auto& normals = found.certificate.normals;
    const bool decides = found.distance.hi < distance.hi;
    if (decides) {
      certificate.normals.insert(certificate.normals.begin(), normals.begin(), normals.end());
    } else {
      certificate.normals.push_back(normals.back());  // that of the lower end
    }
    distance = {std::min(distance.lo, found.distance.lo), std::min(distance.hi, found.distance.hi)};
  }
  return result;
}

/// A bent part's ball about x, as large as can be proven; nothing where none can. Its radius is a little below the
/// distance to an `escape`, by a margin that grows until the proof succeeds.
std::optional<CertifiedEnclosure> deeper(std::span<const UnionPart> parts, const ExactChecker& checker, const Point& x,
                                         const Certificate& certificate, const Point& escape) {
  constexpr double first_margin = 0x1p-50;
  constexpr double last_margin = 0x1p-4;
  constexpr double growth = 64.0;
  const double distance = distance_up(x, escape);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto* const bent = std::get_if<BentDistance>(&parts[i]);
    if (bent == nullptr || !contains(parts[i], x)) continue;
    Certificate more = certificate;
    more.normals.insert(more.normals.begin(), {static_cast<std::uint32_t>(i), rounded(bent->way(escape, x))});
    for (double margin = first_margin; margin <= last_margin; margin *= growth) {
      const Enclosure claimed{-infinity, -distance * (1.0 - margin)};
      if (checker(x, claimed, more).hi <= claimed.hi) return CertifiedEnclosure{claimed, more};
    }
  }
  return std::nullopt;
}

}  // namespace

CertifiedEnclosure certificate_of_part(const UnionPart& part, std::uint32_t index, const Point& x) {
  if (const auto* const convex = std::get_if<ConvexPrimitive>(&part)) {
    constexpr double tightest = 0.0;  // one vector then proves both ends, as a rule
    CertifiedEnclosure found = signed_distance({convex, 1}, x, tightest);
    for (Normal& normal : found.certificate.normals) normal.primitive = index;
    return found;
  }
  const auto [distance, normal] = std::get<BentDistance>(part).foot(x);
  return {distance, {{{index, rounded(normal)}}, std::nullopt}};
}

CertifiedEnclosure bent_union_certificate(std::span<const UnionPart> parts, const ExactChecker& checker, const Point& x,
                                          const FindEscape& find_escape) {
  CertifiedEnclosure found = of_parts(parts, x);
  auto& [distance, certificate] = found;
  const bool inside = std::ranges::any_of(parts, [&](const UnionPart& part) { return contains(part, x); });
  if (inside) {
    certificate.escape = find_escape();
    if (certificate.escape) {
      const auto ball = deeper(parts, checker, x, certificate, *certificate.escape);
      if (ball && ball->distance.hi < distance.hi) {
        distance.hi = ball->distance.hi;
        certificate = ball->certificate;
      }
    }
  } else if (!(distance.lo > 0.0)) {
    certificate.escape = x;  // proves that x does not lie inside
    if (std::isinf(checker(x, distance, certificate).lo)) certificate.escape = find_escape();
  }
  distance = checker(x, distance, certificate);
  distance = {distance.lo + 0.0, distance.hi + 0.0};  // for readers of maps "-0" would look like a sign
  return found;
}

}  // namespace verisq::verify
