/// Proves that a union of primitives lies within a closed mesh, or around it (docs/mathematics.md §21).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verisq/model.hpp"
#include "verisq/recovery.hpp"

namespace verisq::verify {

/// The nerve of convex bodies, as far as it is known: the sets of bodies that may have a common point, and the sets
/// that do have one. Homology is over the field of two elements.
class Nerve {
 public:
  using Three = std::array<std::uint32_t, 3>;
  using Four = std::array<std::uint32_t, 4>;

  /// `may_meet(i, j)`, i < j, is false only where bodies i and j have no common point.
  Nerve(std::size_t bodies, const std::function<bool(std::size_t, std::size_t)>& may_meet);

  /// Sets of four bodies of which each two may meet.
  [[nodiscard]] std::vector<Four> fours() const;

  /// Adds the fact that these four bodies have a common point. Precondition: the indices ascend.
  void add(const Four& common);

  /// True proves that the union of the bodies has no cavity: the nerve has no more cycles of three than boundaries of
  /// four. False proves nothing.
  [[nodiscard]] bool is_without_cavities() const { return filled_() == cycles_; }

 private:
  /// A vector over the field: the places of its ones, ascending.
  using Chain = std::vector<std::uint32_t>;

  /// The rank: how many of the added chains are independent.
  class Rank {
   public:
    void add(Chain chain);
    [[nodiscard]] std::size_t operator()() const { return by_last_.size(); }

   private:
    std::map<std::uint32_t, Chain> by_last_;
  };

  [[nodiscard]] bool may_meet(std::size_t i, std::size_t j) const { return may_meet_[i * bodies_ + j]; }
  [[nodiscard]] Chain boundary(const Three& group) const;

  std::size_t bodies_;
  std::vector<bool> may_meet_;
  std::vector<Three> threes_;  ///< ascending
  std::size_t cycles_ = 0;
  Rank filled_;
};

/// True proves that the union of the primitives has no cavity: no bounded space that it surrounds and does not contain.
/// False proves nothing. Several primitives, one of them bent, and an interruption give false.
[[nodiscard]] bool is_without_cavities(std::span<const Primitive> primitives, const ContainmentCertificate& certificate,
                                       const std::function<bool()>& interrupted);

/// True proves that every point of the triangle lies in one of the convex bodies: the triangle is halved until a body
/// contains all three corners of each piece. False proves nothing. Precondition: finite corners.
[[nodiscard]] bool lies_in_union(const Triangle& triangle, std::span<const PosedSuperquadric> bodies,
                                 const std::function<bool()>& interrupted);

}  // namespace verisq::verify
