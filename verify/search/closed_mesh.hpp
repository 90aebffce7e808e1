/// A closed mesh as a solid: proven signed distances of points, and what of a cube it fills.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/mesh_solid.hpp"
#include "verify/search/triangle_geometry.hpp"
#include "verify/search/wide_tree.hpp"
#include "verify/solids/cube.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The solid: the triangles, and every point about which they wind (docs/mathematics.md §29). They may cross, touch and
/// coincide, lie in several shells, and be turned inward. Immutable: safe to ask from many threads.
class ClosedMesh {
 public:
  /// Throws Error(input) for a mesh without triangles, for one that is not closed, with the number of open edges, and
  /// for one whose largest coordinate is not in [WideTree::least_size, WideTree::largest_size]. Precondition: triangles
  /// of vertices that are there, finite coordinates.
  explicit ClosedMesh(const Mesh& mesh);

  enum class Side : std::uint8_t { outside, inside, on_surface };

  /// How the side was decided.
  enum class Means : std::uint8_t {
    box,     ///< the point lies beyond the mesh's box
    planes,  ///< of all triangles that may be nearest
    ray,     ///< the winding number
    exact,   ///< the point lies on a triangle
  };

  struct Distance {
    Enclosure signed_distance;  ///< to the solid; inside, minus the distance to the nearest triangle
    Side side;
    Means means;
    std::uint32_t triangle;  ///< one that is as near as the upper end says
    bool alone;              ///< it is proven to be the only nearest one
    Point closest;           ///< proposed: a point of the triangle, to rounding
    Point normal;            ///< proposed: about the gradient of the signed distance, of about unit length, or 0
  };

  /// `hint`: a triangle to begin with, as that of a neighbour. It changes no proof. Precondition: finite.
  [[nodiscard]] Distance signed_distance(const Point& point, std::optional<std::uint32_t> hint = {}) const;

  /// Encloses the distances of many points, in an order in which neighbours follow each other. Preconditions: finite;
  /// as many distances as points.
  void signed_distances(std::span<const Point> points, std::span<Distance> distances) const;

  /// How often the triangles wind about the point, counted along a ray. Precondition: the point lies on none.
  [[nodiscard]] int winding_number(const Point& point) const;

  struct Facts {
    std::size_t triangles = 0;
    std::size_t degenerate = 0;  ///< corners on a line
    std::size_t unclean = 0;     ///< not proven to meet others in common corners alone: they cross, touch or coincide
    std::size_t outward = 0;     ///< clean, the solid lies behind it and not before it
    std::size_t inward = 0;      ///< clean, the solid lies before it and not behind it
    std::size_t within = 0;      ///< clean, the solid lies on both sides
    std::size_t patches = 0;     ///< sets of clean triangles that are connected through sides

    /// Inside, minus the signed distance is the depth; else it is at most the depth.
    [[nodiscard]] bool depth_is_exact() const { return outward + inward == triangles; }
  };
  [[nodiscard]] const Facts& facts() const { return facts_; }
  [[nodiscard]] const WideTree& tree() const { return tree_; }

 private:
  /// On which sides of a triangle the solid lies, where no other triangle meets its inside.
  struct Sides {
    bool known = false;
    bool before = false;  ///< where the normal points to
    bool behind = false;
  };

  [[nodiscard]] std::vector<bool> clean_triangles() const;
  void find_sides(const std::vector<SidedEdge>& edges, const std::vector<bool>& clean);
  void set_sides(std::uint32_t n, int before);
  [[nodiscard]] std::optional<int> winding_before(std::uint32_t n) const;
  [[nodiscard]] bool is_in_box(const Point& point) const;
  [[nodiscard]] bool is_on_triangle(const Point& point, const WideTree::Nearest& nearest) const;
  [[nodiscard]] std::optional<Side> side_by_planes(const WideTree::Nearest& nearest) const;
  void decide_side(const Point& point, const WideTree::Nearest& nearest, Distance& distance) const;

  std::vector<Corners> corners_;  ///< equal for equal places
  WideTree tree_;
  std::vector<Sides> sides_;
  Facts facts_;
};

/// Returns whether the pose leaves every point exactly where it is.
[[nodiscard]] bool is_at_rest(const Pose& pose);

/// The triangles of a primitive that is a mesh, in its place. Precondition: `primitive.mesh`, finite pose.
[[nodiscard]] PlacedMesh placed(const Primitive& primitive);

/// A primitive that is a mesh, in its place in the model. Immutable: safe to ask from many threads.
class PosedMesh {
 public:
  /// Throws as ClosedMesh, with the primitive's name. Precondition: `primitive.mesh`, finite pose.
  explicit PosedMesh(const Primitive& primitive);

  /// As ClosedMesh::signed_distance, in the model's frame. A pose widens the enclosure by its rounding.
  [[nodiscard]] ClosedMesh::Distance signed_distance(const Point& point, std::optional<std::uint32_t> hint = {}) const;
  void signed_distances(std::span<const Point> points, std::span<ClosedMesh::Distance> distances) const;

  [[nodiscard]] const ClosedMesh& mesh() const { return mesh_; }
  /// Nothing where the mesh lies in the model as in its file.
  [[nodiscard]] const std::optional<RigidMotion>& motion() const { return motion_; }
  /// A triangle in the model's frame, to nearest.
  [[nodiscard]] Triangle triangle(std::uint32_t n) const;

  /// A point of the own frame, and how far it may be from the exact one. No number where it overflows.
  struct OwnPoint {
    Point point;
    double displacement;
  };
  [[nodiscard]] OwnPoint own_point(const Point& point) const;

  /// A triangle in the model's frame about a point of it: no coordinate is larger than `size_about` the point, nor off
  /// by more than 2^-50 of that size.
  [[nodiscard]] Triangle triangle_about(const Point& centre, std::uint32_t n) const;
  [[nodiscard]] double size_about(const Point& centre) const;

 private:
  struct Turned {
    std::array<Point, 3> rows;  ///< of the rotation to the model's frame, to nearest
    Point translation;
  };

  [[nodiscard]] Point model_point(const Point& own) const;
  [[nodiscard]] Point model_vector(const Point& own) const;
  void place(double displacement, ClosedMesh::Distance& distance) const;

  ClosedMesh mesh_;
  std::optional<RigidMotion> motion_;
  Turned turned_{};
};

/// Colour of the solid. Black cubes are free of triangles, those within the solid, too. For a point: black where it is
/// proven to lie inside, white where it is proven to lie outside.
[[nodiscard]] Colour colour(const PosedMesh& mesh, const Cube& cube);

/// A half-space that contains the part of the solid, or of the closure of its complement, in the cube. It touches the
/// surface in the cube. It proves nothing where the surface has no one side, and where very many triangles meet the
/// cube.
[[nodiscard]] HalfSpace half_space(const PosedMesh& mesh, const Cube& cube, Side side);

}  // namespace verisq::verify
