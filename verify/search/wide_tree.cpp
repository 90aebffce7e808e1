/// This file implements wide_tree.hpp.
#include "verify/search/wide_tree.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/search/triangle_geometry.hpp"

namespace verisq::verify {

WideTree::WideTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  lower_ = upper_ = triangles_[0][0];
  for (const Triangle& triangle : triangles_) {
    for (const Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower_[i] = std::min(lower_[i], corner[i]);
        upper_[i] = std::max(upper_[i], corner[i]);
      }
    }
  }
  double radius = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    centre_[i] = lower_[i] / 2 + upper_[i] / 2;
    radius = std::max({radius, upper_[i] - centre_[i], centre_[i] - lower_[i]});
  }
  // A mesh of one point only has no size.
  scale_ = std::ldexp(1.0, -std::ilogb(std::max(radius, 0x1p-60 * largest_coordinate(std::array{lower_, upper_}))) - 1);
  build();
}

std::array<double, 3> WideTree::scaled(const Point& point) const {
  return {(point[0] - centre_[0]) * scale_, (point[1] - centre_[1]) * scale_, (point[2] - centre_[2]) * scale_};
}

// All that is near a point, a triangle or a ray.

template <class Visit>
void WideTree::visit(const std::array<float, 3>& lower, const std::array<float, 3>& upper, const Visit& leaf) const {
  std::array<std::uint32_t, most_open> open;
  std::size_t size = 0;
  open[size++] = 0;
  while (size > 0) {
    const std::uint32_t next = open[--size];
    if ((next & leaf_bit) != 0) {
      leaf(leaves_[next & ~leaf_bit]);
      continue;
    }
    const Node& node = nodes_[next];
    LaneMask<float, 8> meets = ~LaneMask<float, 8>{};
    for (std::size_t i = 0; i < 3; ++i) {
      meets &= (load<float>(node.lower[i]) <= Lanes<float, 8>{} + upper[i]) &
               (load<float>(node.upper[i]) >= Lanes<float, 8>{} + lower[i]);
    }
    for (unsigned lanes = bits_of(meets); lanes != 0; lanes &= lanes - 1)
      open[size++] = node.child[__builtin_ctz(lanes)];
  }
}

namespace {

/// Bounds how far rounding to binary32 moves a corner, a point and the end of a box together, in scaled coordinates:
/// each is at most 2, and moves by at most 2^-24.
constexpr float displacement = 0x1p-21F;

/// Which triangles of a leaf meet a box.
unsigned lanes_that_meet(const std::array<std::array<std::array<float, 8>, 3>, 3>& corner,
                         const std::array<float, 3>& lower, const std::array<float, 3>& upper) {
  LaneMask<float, 8> meets = ~LaneMask<float, 8>{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto a = load<float>(corner[0][i]);
    const auto b = load<float>(corner[1][i]);
    const auto c = load<float>(corner[2][i]);
    meets &= (lesser(lesser(a, b), c) <= Lanes<float, 8>{} + upper[i]) &
             (greater(greater(a, b), c) >= Lanes<float, 8>{} + lower[i]);
  }
  return bits_of(meets);
}

}  // namespace

void WideTree::within(const Point& point, double reach, std::vector<std::uint32_t>& found) const {
  const auto place = scaled(point);
  const double half = reach * scale_ * (1.0 + 0x1p-20);
  std::array<float, 3> lower, upper;
  for (std::size_t i = 0; i < 3; ++i) {
    const double margin = half + displacement + std::abs(place[i]) * 0x1p-22;
    lower[i] = static_cast<float>(std::clamp(place[i] - margin, -2.0, 2.0));
    upper[i] = static_cast<float>(std::clamp(place[i] + margin, -2.0, 2.0));
  }
  visit(lower, upper, [&](const Leaf& leaf) {
    const unsigned lanes = lanes_that_meet(leaf.corner, lower, upper);
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      if ((lanes >> lane & 1U) != 0) found.push_back(number_of_[leaf.first + lane]);
    }
  });
}

void WideTree::overlapping(std::uint32_t triangle, std::vector<std::uint32_t>& found) const {
  const std::uint32_t own = place_of_[triangle];
  std::array<float, 3> lower{2.0F, 2.0F, 2.0F};
  std::array<float, 3> upper{-2.0F, -2.0F, -2.0F};
  for (const Point& corner : triangles_[own]) {
    const auto place = scaled(corner);
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], static_cast<float>(place[i]) - displacement);
      upper[i] = std::max(upper[i], static_cast<float>(place[i]) + displacement);
    }
  }
  visit(lower, upper, [&](const Leaf& leaf) {
    if (leaf.first + leaf.count <= own + 1) return;
    const unsigned lanes = lanes_that_meet(leaf.corner, lower, upper);
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      const std::uint32_t place = leaf.first + lane;
      if (place > own && (lanes >> lane & 1U) != 0) found.push_back(number_of_[place]);
    }
  });
}

void WideTree::along_ray(const Point& point, std::size_t axis, bool upward, std::vector<std::uint32_t>& found) const {
  const auto place = scaled(point);
  std::array<float, 3> lower, upper;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto here = static_cast<float>(std::clamp(place[i], -2.0, 2.0));
    lower[i] = i == axis && !upward ? -2.0F : here - displacement;
    upper[i] = i == axis && upward ? 2.0F : here + displacement;
  }
  visit(lower, upper, [&](const Leaf& leaf) {
    const unsigned lanes = lanes_that_meet(leaf.corner, lower, upper);
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      if ((lanes >> lane & 1U) != 0) found.push_back(number_of_[leaf.first + lane]);
    }
  });
}

}  // namespace verisq::verify
