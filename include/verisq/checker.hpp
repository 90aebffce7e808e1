/// Certificates of maps and octrees, and the checks that prove their rows again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Certificates prove an enclosure again, without device, solver or search (docs/mathematics.md §2): a few vectors a
// point.

/// A vector v that bounds the signed distance of a point q to one primitive K, whatever v is: from below by
/// (v·q - h(v)) / |v| with K's support function h, because K lies in the half-space {v·x <= h(v)}; from above by
/// |q - b|, where b is the last point of K on the ray from K's centre (its focus, of a tapered one) through q - v. Both
/// are tight where v points along the gradient of the distance and, for q outside, is as long as the distance: b is
/// then the closest point. Given in the primitive's own frame, so that no rotation rounds it: in a flat solid the bound
/// would feel that. What it proves of a bent primitive Checker says.
struct Normal {
  std::uint32_t primitive;  ///< index in Model::primitives
  std::array<double, 3> vector;

  [[nodiscard]] bool operator==(const Normal&) const = default;
};

/// The certificate of one enclosure [lo, hi] of the signed distance of a point q to a solid, or of the distance of a
/// triangle (0 where it meets the union).
///
/// For a point and a union of primitives:
/// Lower end: with lo > 0, every primitive is farther than lo, by one of `normals` or by its bounding sphere. With
/// lo <= 0, `escape` is a point outside all primitives that is no farther than -lo from q; in a model of a single
/// primitive a normal serves as well.
/// Upper end: by one of `normals`; with hi < 0, the ball of radius -hi about q lies inside the primitive of the first
/// normal, which is proven by covering the ball with cones (the branch and bound needs no more than the radius), or by
/// `cover`.
///
/// For a point and any model, also of set operations: `witness` is a point inside, no farther than hi from q where that
/// is not negative, `escape` one outside, no farther than -lo where lo is not positive. With lo > 0, or hi < 0, `cover`
/// divides the cube about the ball of radius lo, or -hi, about q into cells of which each is proven to hold nothing of
/// the solid, or of its complement, in the ball (docs/mathematics.md §28): in preorder true for a cell that is halved
/// across the first of its longest edges, false for one that is not. `normals` tell on which side of their primitives
/// the whole ball lies.
///
/// For a union with meshes: of meshes nothing is needed, as a checker finds their nearest triangles itself. `normals`
/// are of the other primitives, for a point as above, for a triangle as below; `escape` is of the union.
///
/// For a triangle with corners t_i and a union: a normal v proves the lower end (min_i v·t_i - h(v)) / |v| for its
/// primitive, unless that is bent; the upper end is that of the point q = t_0 + w_1 (t_1 - t_0) + w_2 (t_2 - t_0) by
/// the first normal, w being `weights`; 0 where q is in the first normal's primitive. For a triangle and any model:
/// `witness` is a point inside, no farther than hi from q, any where q itself lies inside, and `cover` is that of the
/// box about all points nearer to the triangle than lo.
struct Certificate {
  std::vector<Normal> normals;                        ///< the first is that of the primitive that decides hi
  std::optional<Point> escape;                        ///< of a point only
  std::optional<std::array<double, 2>> weights = {};  ///< of a triangle only; they prove nothing unless w_1, w_2 >= 0
                                                      ///< and w_1 + w_2 <= 1 exactly
  std::optional<Point> witness = {};
  std::vector<bool> cover = {};  ///< empty where there is none

  [[nodiscard]] bool operator==(const Certificate&) const = default;
};

struct CertifiedEnclosure {
  Enclosure distance;
  Certificate certificate;
};

// How a certificate of many parts is worked through.

struct CheckOptions {
  /// Calls work(i) once for each i below `count`, in any order, by several threads.
  /// Unless given, one after the other.
  std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)> in_parallel =
      [](std::size_t count, const std::function<void(std::size_t)>& work) {
        for (std::size_t i = 0; i < count; ++i) work(i);
      };
  std::function<bool()> interrupted = [] { return false; };  ///< polled by any thread; once true it stays so
  std::function<void(double)> progress = [](double) {};      ///< how much is done, from 0 to 1
};

// Proves finished enclosures again from their certificates: MPFR, no OpenCL, no solver.

enum class Verdict {
  proved,    ///< the certificate proves both ends
  refuted,   ///< the exact signed distance (of a member) is proven to lie outside the enclosure, or lo > hi
  unproved,  ///< neither: the certificate proves less than the enclosure claims
};

[[nodiscard]] constexpr std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::proved: return "proved";
    case Verdict::refuted: return "refuted";
    case Verdict::unproved: break;
  }
  return "unproved";
}

struct Finding {
  Verdict verdict;
  Enclosure proven;  ///< what the certificate proves, rounded outward; an inner end is proven no farther than claimed
};

/// For an uncertain model or point, the certificate of an enclosure proves two statements: its normals bound the
/// distance to the largest (or inflated) model from below, with the escape if there is one, and that to the smallest
/// from above, the first normal first; each normal proves what it can for either. For a primitive K bent by β
/// (docs/mathematics.md §9) a normal v proves a lower end where |β(x) - q|² lies above its tangent plane at β⁻¹(q - v)
/// for all x of K that are near enough, and the upper end |q - β(b)|, b being β⁻¹(q - v) scaled to K's surface; with
/// hi < 0, that the ball of radius -hi lies inside, which is -hi along -v from q the nearest to the boundary. Immutable
/// after construction: safe to call from many threads.
class Checker {
 public:
  /// Each point is any within `point_radius` of the one given, each triangle any whose corners are. Precondition:
  /// finite, at least 0. Throws Error(input) where model or points are not exact and the model is not the union of its
  /// primitives, and as `bracket`.
  explicit Checker(const UncertainModel& model, double point_radius = 0.0);
  ~Checker();
  Checker(Checker&&) noexcept;
  Checker& operator=(Checker&&) noexcept;

  /// Never says `proved` of an enclosure that does not contain the exact signed distances of all members, whatever the
  /// certificate holds; `refuted` says that of one member. Normals of primitives that the model does not have, and
  /// vectors that are zero or not finite, prove nothing. Once `interrupted`, polled unless empty, says so, less is
  /// proven: `unproved` says nothing then. Precondition: `point` is finite, `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                   const std::function<bool()>& interrupted = {}) const;

  /// The same of the distance of a triangle, which is 0 where it meets the model. Precondition: finite corners.
  [[nodiscard]] Finding operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                   const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The cubes of an octree, exactly where they are.

/// The side of the solid on which a cube is proven to lie. The numbers are those of the array `colour` in a `.vtu`.
enum class CubeColour : std::uint8_t {
  white = 0,  ///< no point of it lies in the solid
  gray = 1,   ///< undecided
  black = 2,  ///< all of it lies in the solid's interior
};

/// The cube from which an octree grows. It contains the solid. Half-width and grid are powers of two, so that the
/// corners of all its cubes are binary64 numbers: nothing is rounded.
struct OctreeRoot {
  Point centre;
  double half_width;
};

/// A cube that was not split. Cube (i, j, k) of level l is the one with lower corner
/// centre - half_width + (i, j, k) edge, edge = 2 half_width / 2^l, of the root.
struct OctreeCube {
  std::array<std::uint32_t, 3> position;
  std::uint8_t level;
  CubeColour colour;
};

/// Edge of the cubes of a level, and lower corner of a cube: both exact.
[[nodiscard]] double edge(const OctreeRoot& root, int level);
[[nodiscard]] Point lower_corner(const OctreeRoot& root, const OctreeCube& cube);

/// No cube is split beyond this level: positions have 20 bits.
inline constexpr int deepest_octree_level = 20;

// Proves a finished octree again: MPFR, no OpenCL.

/// A closed cube and what is claimed of it: white, no point of it lies in the solid; black, all lie in its interior.
/// Lengths are in half-widths of the root: exact.
struct ColouredCube {
  std::array<double, 3> centre;  ///< from the root's
  double half_width;
  CubeColour colour;
};

/// Immutable after construction: safe to call from many threads.
class OctreeChecker {
 public:
  /// White cubes among `cubes` say nothing new. Throws Error(input) for cubes that overlap or are not the root's, and
  /// where a corner of a cube is no binary64 number: files could not draw it.
  OctreeChecker(const Model& model, const OctreeRoot& root, std::span<const OctreeCube> cubes);
  ~OctreeChecker();

  /// The cubes that must be proven for `volume` to contain the solid's volume: all black cubes, and as white ones the
  /// rest of the root and all space about it that the model may reach.
  [[nodiscard]] const std::vector<ColouredCube>& cubes() const;
  /// That of the black cubes, and of black and gray ones together with 2^-40 of its half-width about the root, rounded
  /// outward.
  [[nodiscard]] Enclosure volume() const;

  /// True where the claim is proven, by parts of the cube where it takes that; false once `interrupted`.
  [[nodiscard]] bool proves(const ColouredCube& cube, const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
