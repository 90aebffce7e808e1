/// Checks on which side of a mesh a solid lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/closed_surface.hpp"
#include "verify/proof/solid_pair.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The points of a primitive that lie deeper in it than a limit: that triangles keep off them, that its centre is one,
// that they are connected (docs/mathematics.md §22).

/// All that is said is proven in 127-bit interval arithmetic; false says nothing. Immutable: safe to ask from many
/// threads.
class DeepPart {
 public:
  /// Preconditions: limit finite, at least 0; of a bend that it keeps off its centre and is less than a full turn.
  DeepPart(const Primitive& primitive, double limit);

  /// That no point of the triangles lies deeper in the primitive. False, too, where that takes too many half-spaces:
  /// the fewer the nearer those triangles are to each other; and once interrupted. Precondition: finite.
  [[nodiscard]] bool keeps_off(std::span<const Triangle> triangles, const Hook& interrupted = {}) const;

  /// True where the centre, to which the pose takes the origin, lies deeper; false once interrupted.
  [[nodiscard]] bool holds_centre(const Hook& interrupted = {}) const;

  [[nodiscard]] bool is_connected() const;

 private:
  using Plain = Coordinates<double>;

  /// In the primitive's own frame, enclosed and about.
  struct Corner {
    PreciseVector exact;
    Plain about;
  };
  using Corners = std::vector<Corner>;

  /// Whole triangles, or a part of one, and the points of the primitive between two heights.
  struct Case {
    Corners corners;  ///< of each triangle three, one after the other
    PosedSections::Section section;
  };
  using Halves = std::optional<std::array<Case, 2>>;

  [[nodiscard]] bool are_apart(const Case& part) const;
  [[nodiscard]] PosedSections::Section widened(const PosedSections::Section& section) const;
  [[nodiscard]] Halves halves(const Case& part) const;
  /// Nothing where none is about to separate them.
  [[nodiscard]] std::optional<Point> proposed_normal(const Corners& corners,
                                                     const SectionMapping::Section& section) const;
  [[nodiscard]] Plain normal_near(const Plain& x) const;

  Primitive primitive_;
  double limit_;
  PosedSections sections_;
  SectionMapping mapping_;
  NearestNormal nearest_;
  double focus_;   ///< along z, about: of the unbent solid
  double beyond_;  ///< how much the height before the bend may change on a way as long as `limit_`
};

// A mesh that is closed over its rims, and on which side of it a point lies (docs/mathematics.md §22).

/// Throws Error(input) for a mesh without triangles, and unless every edge is one of at most two triangles, which run
/// through it in opposite ways. Precondition: triangles of vertices that are there.
void require_sides(const Mesh& mesh);

/// Immutable: safe to ask from many threads.
class OrientedSurface {
 public:
  /// Preconditions: triangles of vertices that are there, finite coordinates. Throws as `require_sides`.
  explicit OrientedSurface(const Mesh& mesh);

  /// Its triangles, and after them those that close it over its rims.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return closed_.triangles(); }
  [[nodiscard]] std::size_t triangles_of_mesh() const { return triangles().size() - closing_.mesh.triangles.size(); }
  [[nodiscard]] std::size_t rims() const { return closing_.rims; }
  /// Whether its normals point outward; nothing where that is not proven.
  [[nodiscard]] std::optional<bool> faces_outward() const {
    return orientation_ ? std::optional(*orientation_ > 0) : std::nullopt;
  }
  /// Sets of its triangles that are connected through edges.
  [[nodiscard]] std::size_t components() const { return components_; }

  enum class Side : std::uint8_t { inside, outside, neither };

  /// Inside is where it winds about the point as it does about its volume, outside where it does not wind; neither
  /// where it winds the other way about, because it crosses itself. Nothing where that is not proven, as on the
  /// surface. Precondition: finite.
  [[nodiscard]] std::optional<Side> side_of(const Point& point) const;

 private:
  Closing closing_;
  std::size_t components_;
  ClosedSurface closed_;
  std::optional<int> orientation_;  ///< the proven sign of the volume that it encloses
};

}  // namespace verisq::verify
