/// Checks on which side of a mesh a solid lies, and that a union of primitives lies within a closed mesh, or around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/closed_surface.hpp"
#include "verify/proof/mesh_solid.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/solid_pair.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/clearance.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"
#include "verisq/recovery.hpp"

namespace verisq::verify {

// The points of a primitive that lie deeper in it than a limit. Proves that triangles keep off them, that the centre is
// one of them, and that they are connected (docs/mathematics.md §22).

/// Every true answer is proven in 127-bit interval arithmetic; false proves nothing. Immutable: many threads may call
/// it.
class DeepPart {
 public:
  /// Preconditions: limit finite, at least 0; a bend keeps off its centre and is less than a full turn.
  DeepPart(const Primitive& primitive, double limit);

  /// True if no point of the triangles is proven to lie deeper in the primitive than the limit. False, too, if the
  /// proof takes too many half-spaces, and once interrupted. The nearer the triangles are to each other, the fewer
  /// half-spaces it takes. Precondition: finite.
  [[nodiscard]] bool keeps_off(std::span<const Triangle> triangles, const Hook& interrupted = {}) const;

  /// True if the centre, to which the pose takes the origin, is proven to lie deeper; false once interrupted.
  [[nodiscard]] bool holds_centre(const Hook& interrupted = {}) const;

  [[nodiscard]] bool is_connected() const;

 private:
  using Plain = Coordinates<double>;

  /// A corner in the primitive's own frame, enclosed and about.
  struct Corner {
    PreciseVector exact;
    Plain about;
  };
  using Corners = std::vector<Corner>;

  /// Whole triangles, or a part of one, and the points of the primitive between two heights.
  struct Case {
    Corners corners;  ///< three corners for each triangle, one after the other
    PosedSections::Section section;
  };
  using Halves = std::optional<std::array<Case, 2>>;

  [[nodiscard]] bool are_apart(const Case& part) const;
  [[nodiscard]] PosedSections::Section widened(const PosedSections::Section& section) const;
  [[nodiscard]] Halves halves(const Case& part) const;
  /// A normal that about separates the two; nothing if none is found.
  [[nodiscard]] std::optional<Point> proposed_normal(const Corners& corners,
                                                     const SectionMapping::Section& section) const;
  [[nodiscard]] Plain normal_near(const Plain& x) const;

  Primitive primitive_;
  double limit_;
  PosedSections sections_;
  SectionMapping mapping_;
  NearestNormal nearest_;
  double focus_;   ///< of the unbent solid, along z, about
  double beyond_;  ///< how much the height before the bend may change on a way as long as `limit_`
};

// A mesh that is closed over its rims, and the side of it on which a point lies (docs/mathematics.md §22).

/// Throws Error(input) for a mesh without triangles. Also throws if an edge belongs to more than two triangles, or to
/// two that run through it the same way. Precondition: triangles of existing vertices.
void require_sides(const Mesh& mesh);

/// Immutable: safe to ask from many threads.
class OrientedSurface {
 public:
  /// Preconditions: triangles of vertices that are there, finite coordinates. Throws as `require_sides`.
  explicit OrientedSurface(const Mesh& mesh);

  /// The triangles of the mesh, and after them the triangles that close it over its rims.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return closed_.triangles(); }
  [[nodiscard]] std::size_t triangles_of_mesh() const { return triangles().size() - closing_.mesh.triangles.size(); }
  [[nodiscard]] std::size_t rims() const { return closing_.rims; }
  /// Returns whether the normals point outward; nothing if that is not proven.
  [[nodiscard]] std::optional<bool> faces_outward() const {
    return orientation_ ? std::optional(*orientation_ > 0) : std::nullopt;
  }
  /// The number of sets of the mesh's triangles that are connected through edges.
  [[nodiscard]] std::size_t components() const { return components_; }

  enum class Side : std::uint8_t { inside, outside, neither };

  /// A point is inside if the surface winds about it in the sense of the enclosed volume, outside if the surface does
  /// not wind about it. It is neither if the surface winds in the opposite sense, because it crosses itself. Nothing if
  /// the side is not proven, for example on the surface. Precondition: finite.
  [[nodiscard]] std::optional<Side> side_of(const Point& point) const;

 private:
  Closing closing_;
  std::size_t components_;
  ClosedSurface closed_;
  std::optional<int> orientation_;  ///< the proven sign of the volume that it encloses
};

/// True proves that all of the triangles keep off something; false proves nothing.
using KeepsOff = std::function<bool(std::span<const Triangle> triangles)>;

/// The finding that a triangle of the surface, or of its closing, is not proven to keep off; nothing if all are.
[[nodiscard]] std::optional<SideFinding> met(const OrientedSurface& surface, const KeepsOff& keeps_off,
                                             const CheckOptions& options);

/// A primitive that is a mesh, and a surface of one part (docs/mathematics.md §22).
class MeshBesideSurface {
 public:
  /// Preconditions: the primitive has a mesh, and is valid. Both must outlive this.
  MeshBesideSurface(const Primitive& primitive, const OrientedSurface& surface);

  /// Kept: all points of the mesh's solid that lie deeper in it than the limit are on that side of the surface,
  /// provided that this is connected.
  [[nodiscard]] SideFinding operator()(OrientedSurface::Side wanted, double limit, const CheckOptions& options) const;

 private:
  struct Cube;
  class Settler;

  [[nodiscard]] SideFinding kept_wholly(OrientedSurface::Side wanted, const CheckOptions& options) const;
  [[nodiscard]] bool deep_points_are(OrientedSurface::Side wanted, double limit, const CheckOptions& options) const;
  [[nodiscard]] std::optional<OrientedSurface::Side> side_of_middle(double limit) const;
  [[nodiscard]] OrientedSurface::Side side_where(int winding) const;

  const Mesh& mesh_;
  MeshSolid solid_;
  const OrientedSurface& surface_;
  MeshSolid of_surface_;  ///< what the surface winds about
};

// Proves that a union of primitives lies within a closed mesh, or around it (docs/mathematics.md §21).

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
