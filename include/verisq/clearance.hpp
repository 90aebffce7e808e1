/// How near a mesh comes to a model: sums, shares and areas of its distances, and on which side it lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/hidden.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq {

// How much of an area is no farther than a distance.

/// Areas in squares of the model unit.
struct AreaWithin {
  Enclosure area{0.0, 0.0};    ///< of all
  Enclosure within{0.0, 0.0};  ///< of what is no farther than the distance asked about
  Enclosure share{0.0, 0.0};   ///< of all that is, in [0, 1]: narrower than what follows of the two areas
};

// On which side of a surface something has to lie.

/// Where a primitive has to lie.
enum class SurfaceSide : std::uint8_t {
  inside,   ///< of the surface, closed over its rims
  outside,  ///< likewise
  any,      ///< it may pass through the openings
};

/// "inside", "outside", "any".
[[nodiscard]] constexpr std::string_view to_string(SurfaceSide side) {
  switch (side) {
    case SurfaceSide::inside: return "inside";
    case SurfaceSide::outside: return "outside";
    case SurfaceSide::any: break;
  }
  return "any";
}

// Where bone is, by the surfaces that bound it.

enum class BoneSide : std::uint8_t {
  inside,   ///< of the surface: it is the bone's outer one
  outside,  ///< it is that of a cavity in the bone
};

/// A surface, closed over its rims by fans about their means, and on which side of it bone may be. Inside is where the
/// closed surface winds about a point as it does about its volume, outside where it does not wind.
struct BoneSurface {
  Mesh mesh;
  BoneSide bone;
};

/// Bone is where all of these say so; without any, everywhere.
struct BoneRegion {
  std::vector<BoneSurface> surfaces = {};
  std::optional<Plane> resection = {};  ///< what lies beyond has been cut off before
};

// How well the distance of one point of the bone to an implant serves: the function f of the paper's Eq. (4).

/// f(d) = 1 / (1 + ((d - target) / scale)^2) - (min(d, 0) / scale)^2: 1 at the wanted distance, 1/2 at `scale` from it,
/// towards 0 for points that the implant does not reach, and falling without bound for those deeper and deeper inside
/// it. Continuously differentiable; rises up to the target and falls beyond it. In model units. `serves` is the band of
/// distances that meet the criterion. Preconditions: finite; target >= 0, scale > 0.
struct Fitness {
  double target;
  double scale;
  Enclosure serves;
};

/// Bone grows onto the implant: the closer the better, at most `gap` apart (2 mm in the paper), and pressed in by no
/// more than `penetration_limit`. Throws Error(input) unless gap > 0, penetration_limit >= 0, both finite.
[[nodiscard]] Fitness cementless(double gap, double penetration_limit);

/// A layer of cement `gap` thick all around, to within `tolerance`. The ends of the band, gap -+ tolerance, are rounded
/// inward: what lies in `serves` lies in the exact band. Throws Error(input) unless finite, gap >= 0, tolerance > 0.
[[nodiscard]] Fitness cemented(double gap, double tolerance);

/// f and f' to nearest, for searches.
[[nodiscard]] double value(const Fitness& fitness, double distance);
[[nodiscard]] double slope(const Fitness& fitness, double distance);

/// All values of f over the enclosure, rounded outward: proven. Minus infinity from a lower end that is, 0 (the limit)
/// from an upper end that is infinite; [-infinity, 1] for what is no interval (NaN).
[[nodiscard]] Enclosure value(const Fitness& fitness, const Enclosure& distance);

// Proven distances of a bone's points, summed up: for all of them, and for each area.

struct Area {
  std::string name;
  double weight;  ///< of each of its points in the objective; finite, >= 0
  [[nodiscard]] bool operator==(const Area&) const = default;
};

/// One area: the number of its points whose distance is proven to lie in `Fitness::serves`, is proven not to, and is
/// neither.
struct AreaClearance {
  Area area;
  std::uint64_t points = 0;
  std::uint64_t proven_within = 0;
  std::uint64_t proven_outside = 0;
  std::uint64_t undecided = 0;
  Enclosure smallest_distance;  ///< of its points
  // Statistics of the signed distances of its points. Each point counts once. Undefined for an area without points.
  Enclosure mean_distance{};
  Enclosure median_distance{};  ///< no more than half of them are farther, no more than half nearer
  Enclosure distance_of_95{};   ///< so near are at least 95 % of them, by the nearest rank
};

/// All points together; `map` sums up the map that found their distances.
struct Clearance {
  MapSummary map;
  Enclosure objective;                ///< F of Eq. (4)
  Enclosure smallest_distance;        ///< signed, of all points: negative where bone lies inside the implant
  Enclosure deepest_penetration;      ///< of a point of the cavity; [0, 0] where every point is proven outside
  std::uint64_t proven_too_deep = 0;  ///< points proven deeper inside than the limit
  std::uint64_t proven_shallow = 0;   ///< points proven no deeper than the limit; the rest is undecided
  std::vector<AreaClearance> areas;   ///< as in the cavity
};

// The numbers that a fit claims about the distances of a bone's vertices, and what proven distances prove of each.

/// The terms of these numbers: which distances serve, how deep points may lie, and the area of each point.
struct ClearanceTerms {
  Fitness fitness;
  double penetration_limit;
  std::vector<Area> areas;
  std::vector<std::uint32_t> area_of;  ///< one a point, an index of `areas`
};

/// `what` is of all points "objective", "smallest_distance", "deepest_penetration", or "points_within_limit" (how many
/// lie no deeper than the limit), or "surface_distance", the smallest distance of all points of the triangles between
/// them, 0 where the surface meets the model; of the points of an area "points_within_band" (how many distances serve),
/// "smallest_distance", "mean_distance", "median_distance", "distance_of_95", as in `AreaClearance`.
struct ClearanceClaim {
  std::string what;
  std::string area;  ///< empty: all points
  Enclosure value;   ///< contains the exact number
};

/// All of them, in this order; none of an area without points, of the surface where `surface` is given.
[[nodiscard]] std::vector<ClearanceClaim> claims_of(const Clearance& clearance,
                                                    const std::optional<Enclosure>& surface = {});

/// Sums up enclosures of the points' distances; its `map` is empty. Precondition: as many as `area_of`
/// has points.
[[nodiscard]] Clearance clearance_of(const ClearanceTerms& terms, std::span<const Enclosure> distances);

/// Judges each claim by `proven`, the clearance of proven distances, and by `surface`, which encloses the distance of
/// all points of triangles. Claims of another name or area are unproved, by [-infinity, infinity].
[[nodiscard]] std::vector<Finding> check(std::span<const ClearanceClaim> claims, const Clearance& proven,
                                         const std::optional<Enclosure>& surface = {});

// The surface that an implant is fitted into: points of the bone, grouped into areas of different weight.

/// Every index of `area_of` is below `areas.size()`; one a point. The triangles, whose indices are below
/// `points.size()`, are the surface that the implant must not cut between the points; there may be none.
struct Cavity {
  std::vector<Point> points;
  std::vector<Area> areas;
  std::vector<std::uint32_t> area_of;
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
};

/// An area as a box in the coordinates of the mesh, faces included: key `areas` of a model file. Precondition: lower
/// corner at most the upper one, all finite.
struct AreaBox {
  Area area;
  Point lower;
  Point upper;
  [[nodiscard]] bool operator==(const AreaBox&) const = default;
};

/// The areas of a model file, none where it has no key `areas`. Throws Error(input) as `read_model`.
[[nodiscard]] std::vector<AreaBox> read_areas(const std::filesystem::path& model);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] std::vector<AreaBox> parse_areas(std::string_view json, std::string_view name);

/// Every point belongs to the first box that holds it; where there is none, to a last area "elsewhere" of weight
/// `weight_elsewhere`, which is there only if it has a point.
[[nodiscard]] Cavity cavity(std::vector<Point> points, std::span<const AreaBox> boxes, double weight_elsewhere = 1.0);

/// The areas are the values of the points' labels, one each, in ascending order, named by their numbers; a value
/// without a weight in `weights` (area names are the numbers) has weight 1. Throws Error(input) for a weight of a value
/// that does not occur.
[[nodiscard]] Cavity labelled_cavity(std::vector<Point> points, std::span<const std::int64_t> labels,
                                     std::span<const Area> weights);

/// The same of the vertices of a `.ply` file, whose labels are an integer property of theirs. Throws Error(input) for
/// another format, an absent property or one that is not an integer type, and likewise.
[[nodiscard]] Cavity read_labelled_cavity(const std::filesystem::path& mesh, const std::string& property,
                                          std::span<const Area> weights);

// Proves how well a posed implant serves a cavity: the certified report of a fit.

/// Maps all points of the cavity against the posed implant (any model) and sums up. The rows go to `sink` as they come.
/// If the map was interrupted, the report covers the rows delivered: the first `map.points` of the cavity. Errors as
/// Mapper.
[[nodiscard]] Clearance certified_clearance(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                                            double penetration_limit, const MapOptions& options,
                                            const Sink<Point>& sink);

// Proves how close a whole mesh, between its vertices too, comes to a model, and how deep it enters it.

struct MeshClearanceOptions {
  double penetration_limit = 0.0;              ///< model units, >= 0
  double tolerance;                            ///< of the smallest distance, in model units, > 0
  std::optional<double> limit_tolerance = {};  ///< how close to the limit a triangle is still decided; else the same
  std::uint64_t most_samples = 1U << 23U;      ///< distances asked for, about: then what is open stays undecided
  std::string device = "auto";                 ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
};

struct PointOnTriangle {
  Point point;             ///< to nearest
  std::uint32_t triangle;  ///< index in the mesh
};

/// Every triangle is counted once.
struct MeshClearance {
  Enclosure smallest_distance;  ///< signed, over all points of all triangles; its lower end proves the whole surface
  std::uint64_t proven_within = 0;    ///< no point of the triangle lies deeper than the limit
  std::uint64_t proven_too_deep = 0;  ///< some point of it does
  std::uint64_t undecided = 0;
  std::vector<PointOnTriangle> too_deep;  ///< of each triangle proven too deep the deepest point looked at
  PointOnTriangle deepest = {};           ///< along a path: but for rounding of a distance no more than the upper end
  std::uint64_t samples = 0;              ///< distances asked for
  bool interrupted = false;               ///< what is told is proven all the same
};

/// Branch and bound over the triangles, for any model. Throws Error(input) for a mesh without triangles, and as
/// Mapper.
[[nodiscard]] MeshClearance mesh_clearance(const Model& model, const Mesh& mesh, const MeshClearanceOptions& options);

/// The same of the smallest signed distances along a path, at the poses and between them (insertion.hpp): they, too,
/// change by no more than the place moves. Of a triangle that is cut the point is any that proves it. Throws likewise,
/// and for a path as there.
[[nodiscard]] MeshClearance mesh_clearance_along(std::span<const Pose> path, const Model& model, const Mesh& mesh,
                                                 const MeshClearanceOptions& options);

// Proves again on which side of a surface the parts of an implant lie, from model and mesh alone: MPFR, no OpenCL, no
// search.

/// That every point of a primitive, whole, which lies deeper in it than the limit of penetration is on that side.
struct SideClaim {
  std::size_t primitive;  ///< an index
  SurfaceSide side;       ///< any is always kept
};

enum class SideFinding : std::uint8_t {
  kept,             ///< proven: see SideChecker
  other_side,       ///< proven to be broken: the centre lies deeper than the limit, and is not on that side
  enters_surface,   ///< it is not proven to keep off the surface, so that it may reach through
  reaches_through,  ///< it is not proven to keep off the openings
  no_deep_point,    ///< it has no point that is known to lie deeper than the limit of penetration
  on_the_surface,   ///< rounding leaves its point's side open
  strongly_bent,    ///< its points deeper than the limit of penetration are not known to be connected
  several_parts,    ///< the surface is in several parts, and nobody says of which that is the side
  no_volume,        ///< it is not proven that the surface, closed over its rims, encloses anything
};

/// "proven", "other side", "not off the surface", "not off the openings", "centre not deep enough", "centre not
/// decided", "bend too strong for the limit", "surface in several parts",
/// "surface encloses nothing".
[[nodiscard]] constexpr std::string_view to_string(SideFinding finding) {
  switch (finding) {
    case SideFinding::kept: return "proven";
    case SideFinding::other_side: return "other side";
    case SideFinding::enters_surface: return "not off the surface";
    case SideFinding::reaches_through: return "not off the openings";
    case SideFinding::no_deep_point: return "centre not deep enough";
    case SideFinding::on_the_surface: return "centre not decided";
    case SideFinding::strongly_bent: return "bend too strong for the limit";
    case SideFinding::several_parts: return "surface in several parts";
    case SideFinding::no_volume: break;
  }
  return "surface encloses nothing";
}

/// `proved` where it is kept, `refuted` where the other side is, else `unproved`.
[[nodiscard]] Verdict verdict_of(SideFinding finding);

/// Immutable after construction: safe to call from many threads.
class SideChecker {
 public:
  /// Takes any model; each of its primitives is asked for on its own. Precondition: triangles of vertices that are
  /// there, finite coordinates. Throws Error(input) for a mesh without sides, as `check_surface_has_sides`, a limit
  /// that is not finite and at least 0, and models that are none.
  SideChecker(const Model& model, const Mesh& surface, double penetration_limit);

  /// Kept: no point of the surface, nor of the fans that close it over its rims, lies deeper in the primitive than the
  /// limit; those points that do are connected, the centre among them, which is on that side: hence all of them are. A
  /// mesh is asked for all of its parts (docs/mathematics.md §22). Inside is where the closed surface winds about a
  /// point as it does about its volume, outside where it does not wind. Nothing is kept of a surface in several parts,
  /// as of one whose triangles share no vertices, nor of one that encloses nothing, nor once interrupted.
  /// Precondition: there is such a primitive.
  [[nodiscard]] SideFinding operator()(const SideClaim& claim, const CheckOptions& options = {}) const;

  /// Whether the closed surface's normals point outward, as a bone's; nothing where that is not proven.
  [[nodiscard]] std::optional<bool> faces_outward() const;

  /// Over which the surface is closed, by fans about their means.
  [[nodiscard]] std::size_t rims() const;

 private:
  struct State;
  Hidden<State> state_;
};

// Proves on which side of a surface the parts of an implant lie: inside a cavity, outside a bone.

/// Indices of primitives, ascending, that hold the model's solid together: every point of it lies in one of them, so
/// that their sides tell the solid's. All those of a union; of an intersection those of the first operand that has
/// some; of a difference those of its first one.
[[nodiscard]] std::vector<std::uint32_t> covering_primitives(const Model& model);

struct Sides {
  std::vector<SideFinding> of_primitives;  ///< `kept` for each that may lie anywhere
  std::size_t rims = 0;                    ///< over which the surface was closed, by fans about their means
  [[nodiscard]] bool kept() const;
};

/// Whether the surface, closed over its rims, is proven to face outward. Precondition: it has sides.
[[nodiscard]] bool faces_outward(const Mesh& surface);

/// Throws Error(input) unless the triangles enclose a side: manifold, and consistently oriented.
void check_surface_has_sides(const Mesh& surface);

/// Returns for each primitive what `SideChecker` finds. In a model of set operations the whole primitive is meant, with
/// the parts that are cut away: to prove that it keeps off the surface is more than the solid needs.
/// `covering_primitives` are those that hold it. Throws Error(input) unless `required` is one a primitive, and as
/// SideChecker.
[[nodiscard]] Sides prove_sides(
    const Model& model, const Mesh& surface, std::span<const SurfaceSide> required, double penetration_limit,
    const std::function<bool()>& interrupted = [] { return false; });

/// The sides that `SideChecker` can prove again: those that are kept, without `any`. Precondition: `required` is what
/// was asked of the same primitives.
[[nodiscard]] std::vector<SideClaim> claims_of(const Sides& sides, std::span<const SurfaceSide> required);

}  // namespace verisq
