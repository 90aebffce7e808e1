/// Each bisection hands the leaves around its edge on; a leaf with a vertex on one of its tetrahedron_edges is bisected
/// in turn.
#include "host/tessellation/bisected_tetrahedra.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace verisq::tessellation {
namespace {

constexpr std::array<std::array<std::size_t, 2>, 6> tetrahedron_edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

double determinant(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   const Eigen::Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace

BisectedTetrahedra::BisectedTetrahedra(const Eigen::Vector3d& lower, double width) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    vertices_.push_back(lower + width * Eigen::Vector3d(corner & 1U, corner >> 1U & 1U, corner >> 2U & 1U));
  }
  leaves_at_.resize(8);
  // Kuhn: one tetrahedron for each order of the three axes along a path from corner 0 to corner 7.
  std::array<unsigned, 3> axes{1, 2, 4};
  do {
    add_leaf({0, axes[0], axes[0] | axes[1], 7}, 3);
  } while (std::ranges::next_permutation(axes).found);
}

double BisectedTetrahedra::size(std::uint32_t k) const {
  double longest = 0.0;
  for (const auto& [i, j] : tetrahedron_edges) {
    const auto& corners = tetrahedra_[k].corners;
    longest = std::max(longest, (vertices_[corners[i]] - vertices_[corners[j]]).norm());
  }
  return longest;
}

void BisectedTetrahedra::bisect(std::span<const std::uint32_t> marked) {
  std::vector<std::uint32_t> open;
  for (const std::uint32_t k : marked) {
    if (is_leaf(k)) split(k, open);
    while (!open.empty()) {
      const std::uint32_t next = open.back();
      open.pop_back();
      if (is_leaf(next) && has_split_edge(tetrahedra_[next])) split(next, open);
    }
  }
}

std::uint32_t BisectedTetrahedra::leaf_at(const Eigen::Vector3d& point) const {
  // The least barycentric coordinate, up to a factor that is the same for siblings.
  const auto depth_in = [&](std::uint32_t k) {
    const auto& [a, b, c, d] = tetrahedra_[k].corners;
    const auto& v = vertices_;
    const double whole = determinant(v[a], v[b], v[c], v[d]);
    return std::min({determinant(point, v[b], v[c], v[d]) / whole, determinant(v[a], point, v[c], v[d]) / whole,
                     determinant(v[a], v[b], point, v[d]) / whole, determinant(v[a], v[b], v[c], point) / whole});
  };
  std::uint32_t k = 0;
  for (std::uint32_t root = 1; root < 6; ++root) {
    if (depth_in(root) > depth_in(k)) k = root;
  }
  while (!is_leaf(k)) {
    const std::uint32_t child = tetrahedra_[k].first_child;
    k = depth_in(child) >= depth_in(child + 1) ? child : child + 1;
  }
  return k;
}

void BisectedTetrahedra::add_leaf(const std::array<std::uint32_t, 4>& corners, std::uint8_t tag) {
  for (const std::uint32_t corner : corners) {
    leaves_at_[corner].push_back(static_cast<std::uint32_t>(tetrahedra_.size()));
  }
  tetrahedra_.push_back({corners, tag});
}

void BisectedTetrahedra::split(std::uint32_t k, std::vector<std::uint32_t>& open) {
  const auto [corners, tag, unused] = tetrahedra_[k];
  const std::uint32_t a = corners[0];
  const std::uint32_t b = corners[tag];
  const std::uint32_t middle = middle_of(a, b);
  for (const std::uint32_t corner : corners) std::erase(leaves_at_[corner], k);
  for (const std::uint32_t leaf : leaves_at_[a]) {
    if (std::ranges::count(tetrahedra_[leaf].corners, b) > 0) open.push_back(leaf);
  }
  tetrahedra_[k].first_child = static_cast<std::uint32_t>(tetrahedra_.size());
  std::array<std::uint32_t, 4> first = corners;
  first[tag] = middle;
  std::array<std::uint32_t, 4> second = corners;
  for (std::size_t i = 0; i < tag; ++i) second[i] = corners[i + 1];
  second[tag] = middle;
  const std::uint8_t next_tag = tag > 1 ? tag - 1 : 3;
  for (const auto& child : {first, second}) {
    open.push_back(static_cast<std::uint32_t>(tetrahedra_.size()));
    add_leaf(child, next_tag);
  }
}

bool BisectedTetrahedra::has_split_edge(const Tetrahedron& tetrahedron) const {
  const auto& corners = tetrahedron.corners;
  return std::ranges::any_of(tetrahedron_edges, [&](const auto& edge) {
    return middles_.contains(edge_key(corners[edge[0]], corners[edge[1]]));
  });
}

std::uint32_t BisectedTetrahedra::middle_of(std::uint32_t a, std::uint32_t b) {
  const auto [place, added] = middles_.try_emplace(edge_key(a, b), static_cast<std::uint32_t>(vertices_.size()));
  if (added) {
    vertices_.push_back((vertices_[a] + vertices_[b]) / 2.0);
    leaves_at_.emplace_back();
  }
  return place->second;
}

}  // namespace verisq::tessellation
