/// This file implements the hull of a difference of overlap.hpp.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "verify/search/overlap.hpp"

namespace verisq::verify {

namespace {

using Vector = DifferenceHull::Vector;

/// Vertices are rounded and pulled in by less than this share of the size: whatever is no higher lies in one plane.
constexpr long double flatness = 0x1p-42L;

Vector opposite(const Vector& v) {
  return {-v[0], -v[1], -v[2]};
}

}  // namespace

/// The new vertex of that direction.
std::optional<std::uint32_t> DifferenceHull::asked(const Vector& direction) {
  const std::optional<FarthestPoint> found = support_(direction);
  if (!found) return std::nullopt;
  const long double reach = dot(direction, found->farthest);
  if (reach < reach_) {
    reach_ = reach;
    direction_ = direction;
  }
  points_.push_back(*found);
  vertices_.push_back({found->vertex[0], found->vertex[1], found->vertex[2]});
  for (const long double x : vertices_.back()) size_ = std::max(size_, std::fabs(x));
  return static_cast<std::uint32_t>(vertices_.size() - 1);
}

std::optional<std::uint32_t> DifferenceHull::farther_of_both_ways(const Vector& direction, const Vector& from) {
  const std::optional<std::uint32_t> ahead = asked(direction);
  const std::optional<std::uint32_t> behind = asked(opposite(direction));
  if (!ahead || !behind) return std::nullopt;
  const auto way = [&](std::uint32_t n) { return std::fabs(dot(direction, difference(vertices_[n], from))); };
  return way(*ahead) < way(*behind) ? behind : ahead;
}

/// The first tetrahedron; false where the set seems to be flat.
bool DifferenceHull::begin() {
  const std::optional<std::uint32_t> a = asked({1, 0, 0});
  const std::optional<std::uint32_t> b = asked({-1, 0, 0});
  if (!a || !b) return false;
  const Vector side = difference(vertices_[*b], vertices_[*a]);
  const std::optional<std::uint32_t> c = farther_of_both_ways(unit_across(side), vertices_[*a]);
  if (!c) return false;
  const Vector normal = unit_of(cross(side, difference(vertices_[*c], vertices_[*a]))).value_or(Vector{});
  const std::optional<std::uint32_t> d = farther_of_both_ways(normal, vertices_[*a]);
  if (!d) return false;
  const long double height = dot(normal, difference(vertices_[*d], vertices_[*a]));
  if (!(std::fabs(height) > flatness * size_)) return false;
  const auto [one, other] = height > 0 ? std::pair(*c, *b) : std::pair(*b, *c);
  facets_ = {facet(*a, one, other), facet(*a, other, *d), facet(other, one, *d), facet(one, *a, *d)};
  return true;
}

/// A facet without an area is never the nearest.
DifferenceHull::Facet DifferenceHull::facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const Vector normal =
      unit_of(cross(difference(vertices_[b], vertices_[a]), difference(vertices_[c], vertices_[a]))).value_or(Vector{});
  const bool is_flat = dot(normal, normal) == 0;
  return {{a, b, c}, normal, is_flat ? static_cast<long double>(infinity) : dot(normal, vertices_[a])};
}

const DifferenceHull::Facet& DifferenceHull::nearest() const {
  return *std::ranges::min_element(facets_, {}, &Facet::height);
}

/// The facets that the vertex sees are replaced by those from the rim of all they cover to the vertex. Every rim is
/// closed, so that the surface stays so, whatever roundings say of single facets.
void DifferenceHull::insert(std::uint32_t vertex) {
  const auto sees = [&](const Facet& facet) {
    return dot(facet.normal, vertices_[vertex]) - facet.height > -flatness * size_;
  };
  const auto kept = std::partition(facets_.begin(), facets_.end(), [&](const Facet& facet) { return !sees(facet); });
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (auto facet = kept; facet != facets_.end(); ++facet) {
    const auto& corners = facet->corners;
    for (std::size_t k = 0; k < 3; ++k) sides.emplace(corners[k], corners[(k + 1) % 3]);
  }
  facets_.erase(kept, facets_.end());
  for (const auto& [from, to] : sides)
    if (!sides.contains({to, from})) facets_.push_back(facet(from, to, vertex));
}

void DifferenceHull::grow(const Limits& limits) {
  if (facets_.empty() && !begin()) return;
  while (!facets_.empty() && facets_.size() <= limits.facets && !limits.interrupted()) {
    if (reach() <= limits.enough || reach() - depth() <= limits.tolerance) return;
    const Facet seed = nearest();
    const std::optional<std::uint32_t> vertex = asked(seed.normal);
    if (!vertex) return;
    if (!(dot(seed.normal, vertices_[*vertex]) - seed.height > flatness * size_)) return;
    insert(*vertex);
  }
}

double DifferenceHull::depth() const {
  return facets_.empty() ? 0.0 : static_cast<double>(nearest().height);
}

DifferenceHull::Surface DifferenceHull::surface() const {
  Surface result;
  std::vector<std::optional<std::uint32_t>> place(vertices_.size());
  for (const Facet& facet : facets_) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::optional<std::uint32_t>& number = place[facet.corners[k]];
      if (!number) {
        number = static_cast<std::uint32_t>(result.on_a.size());
        result.mesh.vertices.push_back(points_[facet.corners[k]].vertex);
        result.on_a.push_back(points_[facet.corners[k]].on_a);
      }
      triangle[k] = *number;
    }
    result.mesh.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace verisq::verify
