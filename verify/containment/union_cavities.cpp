/// The second homology of the nerve, bounded from what is proven of pairs and of groups of four.
#include "verify/containment/union_cavities.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/common_point.hpp"
#include "verisq/model_distance.hpp"

namespace verisq::verify {

namespace {

/// A vector over the field of two elements: the places of its ones, ascending.
using Chain = std::vector<std::uint32_t>;

Chain sum(const Chain& a, const Chain& b) {
  Chain result;
  std::ranges::set_symmetric_difference(a, b, std::back_inserter(result));
  return result;
}

/// How many of the chains that were added are independent.
class Rank {
 public:
  void add(Chain chain) {
    while (!chain.empty()) {
      const auto [found, is_new] = by_last_.try_emplace(chain.back(), chain);
      if (is_new) return;
      chain = sum(chain, found->second);
    }
  }

  [[nodiscard]] std::size_t operator()() const { return by_last_.size(); }

 private:
  std::map<std::uint32_t, Chain> by_last_;
};

/// Which pairs are not proven to be apart.
class NearPairs {
 public:
  explicit NearPairs(std::span<const Primitive> primitives) : count_(primitives.size()), near_(count_ * count_) {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = i + 1; j < count_; ++j) {
        const PairDistance distance(Model{"", {primitives[i]}, {}}, Model{"", {primitives[j]}, {}});
        near_[i * count_ + j] = distance().proximity != Proximity::separated;
      }
    }
  }

  /// Precondition: i < j.
  [[nodiscard]] bool operator()(std::size_t i, std::size_t j) const { return near_[i * count_ + j]; }

 private:
  std::size_t count_;
  std::vector<bool> near_;
};

using Three = std::array<std::uint32_t, 3>;
using Four = std::array<std::uint32_t, 4>;

/// Groups of primitives that are near each other, in pairs.
std::vector<Three> groups_of_three(std::size_t count, const NearPairs& near) {
  std::vector<Three> groups;
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t j = i + 1; j < count; ++j)
      for (std::uint32_t k = j + 1; near(i, j) && k < count; ++k)
        if (near(i, k) && near(j, k)) groups.push_back({i, j, k});
  return groups;
}

std::vector<Four> groups_of_four(std::span<const Three> threes, std::size_t count, const NearPairs& near) {
  std::vector<Four> groups;
  for (const auto& [i, j, k] : threes)
    for (std::uint32_t l = k + 1; l < count; ++l)
      if (near(i, l) && near(j, l) && near(k, l)) groups.push_back({i, j, k, l});
  return groups;
}

/// Of a group of three: its pairs, numbered i + count * j.
Chain boundary(const Three& group, std::size_t count) {
  const auto pair = [count](std::uint32_t i, std::uint32_t j) { return static_cast<std::uint32_t>(i + count * j); };
  Chain chain{pair(group[0], group[1]), pair(group[0], group[2]), pair(group[1], group[2])};
  std::ranges::sort(chain);
  return chain;
}

/// Of a group of four: its groups of three, by their places in the sorted list.
Chain boundary(const Four& group, std::span<const Three> threes) {
  Chain chain;
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    Three face{};
    for (std::size_t i = 0, k = 0; i < 4; ++i)
      if (i != left_out) face[k++] = group[i];
    chain.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(threes, face) - threes.begin()));
  }
  std::ranges::sort(chain);
  return chain;
}

/// To nearest: for a proposal.
PlacedSuperquadric placed_in_model(const PosedSuperquadric& posed) {
  const auto nearest = [](const PreciseInterval& x) { return static_cast<double>(x.lower().to_long_double()); };
  PlacedSuperquadric placed{.solid = posed.superquadric(), .rotation = {}, .offset = {}};
  for (int i = 0; i < 3; ++i) {
    placed.offset[i] = nearest(posed.motion().translation[i]);
    for (int j = 0; j < 3; ++j) placed.rotation(i, j) = nearest(posed.motion().rotation(i, j));
  }
  return placed;
}

/// Whether a point of all four is found and proven to be one.
bool have_common_point(const Four& group, std::span<const PosedSuperquadric> posed) {
  std::vector<PlacedSuperquadric> placed;
  for (const std::uint32_t i : group) placed.push_back(placed_in_model(posed[i]));
  const std::optional<Eigen::Vector3d> found = common_point(placed);
  if (!found) return false;
  const Point point{(*found)[0], (*found)[1], (*found)[2]};
  return std::ranges::all_of(group, [&](std::uint32_t i) { return posed[i].contains(point); });
}

}  // namespace

/// With N the nerve, Z its cycles of groups of three and B the boundaries of groups of four: dim H = dim Z - dim B. All
/// groups of three that are not proven to be apart in pairs contain those of N, so their cycles contain Z; those groups
/// of four that are proven to have a common point are of N, so their boundaries lie in B.
bool is_without_cavities(std::span<const Primitive> primitives, const std::function<bool()>& ended) {
  const std::size_t count = primitives.size();
  if (count < 4) return true;  // a sphere in a complex takes four vertices
  const NearPairs near(primitives);
  const std::vector<Three> threes = groups_of_three(count, near);
  Rank of_threes;
  for (const Three& group : threes) of_threes.add(boundary(group, count));
  const std::size_t cycles = threes.size() - of_threes();
  if (cycles == 0) return true;
  std::vector<PosedSuperquadric> posed;
  for (const Primitive& primitive : primitives) posed.emplace_back(primitive);
  Rank of_fours;
  for (const Four& group : groups_of_four(threes, count, near)) {
    if (ended()) return false;
    if (have_common_point(group, posed)) of_fours.add(boundary(group, threes));
    if (of_fours() == cycles) return true;
  }
  return false;
}

}  // namespace verisq::verify
