/// Ways of an implant into its seat: distances along them, the bone that it takes away, and what proves both.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/clearance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/hidden.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Proves the smallest signed distance of a point to an implant on its way in again: MPFR, no OpenCL, no search.

/// A part of the way that a point of the bone takes as the resting implant sees it. The certificate proves how far
/// `segment` (as the triangle of its first and twice its second end) is from the implant; where that is more than 0, no
/// point of the way's part is deeper inside, or less far outside, than the segment is far, less what lies between the
/// two (docs/mathematics.md §16).
struct WayPart {
  double until;                  ///< the time when it ends; it begins where the part before ends, the first at 0
  std::array<Point, 2> segment;  ///< in the implant's frame
  Certificate certificate;       ///< of a triangle

  [[nodiscard]] bool operator==(const WayPart&) const = default;
};

/// The certificate of an enclosure [lo, hi] of the smallest signed distance along a path.
struct InsertionCertificate {
  double deepest = 0.0;        ///< a time, of which the distance is at most hi
  Certificate at_deepest;      ///< of the point at that time
  std::vector<WayPart> parts;  ///< of all of the way: of each the distance is at least lo

  [[nodiscard]] bool operator==(const InsertionCertificate&) const = default;
};

/// The implant moves by the poses after its primitives' own, between them as smallest_distance_along says. Immutable
/// after construction: safe to call from many threads.
class InsertionChecker {
 public:
  /// Throws Error(input) for a path without poses, for poses that are not finite or have a zero quaternion, and as
  /// Checker.
  InsertionChecker(const Model& implant, std::span<const Pose> path);

  /// Never says `proved` of an enclosure that does not contain the smallest signed distance of the point along the
  /// path, whatever the certificate holds. Once `interrupted`, polled unless empty, says so, less is proven: `unproved`
  /// says nothing then. Precondition: `point` is finite, `claimed` holds no NaN.
  [[nodiscard]] Finding operator()(const Point& point, const Enclosure& claimed,
                                   const InsertionCertificate& certificate,
                                   const std::function<bool()>& interrupted = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

// Proves the smallest signed distance of a bone's whole surface to an implant on its way in again: MPFR, no OpenCL, no
// search.

/// How a piece of a triangle is bounded on a part of the way. At first the piece is the triangle, and the part is the
/// whole way.
enum class WayCell : std::uint8_t {
  by_vertices,  ///< the proven distances of the triangle's vertices, which change by no more than the place, suffice
  moved,        ///< moved out of the implant, the piece is clear of it all the while
  quartered,    ///< the piece is divided at the middles of its sides: at each corner one, then the middle one
  halved,       ///< the part is divided: first the earlier half
};

/// No piece is quartered more often.
inline constexpr int most_quarterings = 20;

/// More cells than that, in all triangles together, prove nothing: what would take longer to follow no checker need
/// have.
inline constexpr std::size_t most_cells_of_way_surface = std::size_t{1} << 21U;

/// As the resting implant sees it, the piece sweeps a region within a bulge of the convex hull of the places where its
/// corners begin and end. That hull, moved by `step`, is outside of each primitive, beyond a half-space of
/// one of its `normals`, or of one that the checker tries where it has none here. Then nothing in the cell is deeper
/// inside than the step is long, but for the bulge (docs/mathematics.md §16).
struct MovedCell {
  Point step;  ///< in the implant's frame
  std::vector<Normal> normals;

  [[nodiscard]] bool operator==(const MovedCell&) const = default;
};

/// How one triangle is divided.
struct WayTriangle {
  std::uint32_t triangle = 0;
  std::vector<WayCell> cells;    ///< in preorder
  std::vector<MovedCell> moved;  ///< one for each cell that is moved, in their order

  [[nodiscard]] bool operator==(const WayTriangle&) const = default;
};

/// A point of the surface at a time.
struct WayWitness {
  std::uint32_t triangle = 0;
  std::array<double, 2> weights{};  ///< as of `Certificate`
  double time = 0.0;
  Certificate certificate;  ///< of the point where the resting implant sees it

  [[nodiscard]] bool operator==(const WayWitness&) const = default;
};

/// The certificate of an enclosure [lo, hi] of the smallest signed distance of all points of all triangles along the
/// way, beside the proofs of their vertices.
struct WaySurfaceCertificate {
  std::optional<WayWitness> deepest;   ///< its distance is at most hi; none where a vertex is as deep
  std::vector<WayTriangle> triangles;  ///< in the order of the mesh; of all others the vertices suffice

  [[nodiscard]] bool operator==(const WaySurfaceCertificate&) const = default;
};

/// The implant, a union of convex primitives, moves by the poses after its primitives' own, between them as in
/// insertion.hpp. Immutable after construction: safe to call from many threads.
class WaySurfaceChecker {
 public:
  /// Throws Error(input) for another model, for a mesh without triangles, and for a path as InsertionChecker. `bone`
  /// has to outlive this.
  WaySurfaceChecker(const Model& implant, std::span<const Pose> path, const Mesh& bone);

  /// Never says `proved` of an enclosure that does not contain the smallest signed distance, whatever the certificate
  /// holds, if `of_vertices` are proven: enclosures of the smallest signed distance of each vertex along the way.
  /// Interrupted, it has proven nothing from below. Precondition: one for each vertex, and no NaN.
  [[nodiscard]] Finding operator()(std::span<const Enclosure> of_vertices, const Enclosure& claimed,
                                   const WaySurfaceCertificate& certificate, const CheckOptions& options = {}) const;

 private:
  struct State;
  Hidden<State> state_;
};

// How deep an implant cuts into the bone on its way in: the bone that must be removed.

/// Poses along a straight way into the last pose: `steps` + 1 poses, equally spaced over `length` against the
/// direction, so that the motion ends in `last` moving along the direction. Precondition: direction not zero, finite;
/// length > 0; steps > 0.
[[nodiscard]] std::vector<Pose> straight_path(const Pose& last, const Point& direction, double length,
                                              std::size_t steps);

/// A way of `length` along the direction into the pose where the implant's file has it, on which the implant turns
/// about the direction (right-handed, through a point that is said elsewhere) at constant speed.
struct WayIn {
  Point direction;  ///< not zero
  double length;    ///< > 0
  double turn_degrees = 0.0;
};

/// Poses so close to each other that the way hardly leaves the screw about an axis through `centre`: what is between
/// them is as said below. A way without a turn has two. Throws Error(input) for what is not finite or out of range.
[[nodiscard]] std::vector<Pose> path_of(const WayIn& way, const Point& centre);

/// The middle of the box that bounds the implant: about which fits turn it, and ways in do.
[[nodiscard]] Point turning_centre(const Model& implant);

/// Between two poses of a path the translation is linear in time and the rotation turns about a fixed axis at constant
/// speed, by the smaller angle (of opposite orientations either way).
struct InsertionOptions {
  double tolerance;             ///< of the enclosures, in model units, > 0: a coarse path cannot reach a fine one
  std::string device = "auto";  ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
  std::function<void(double done)> progress = [](double) {};
};

/// For each point of the bone the smallest signed distance to the implant along the whole path, between the poses too:
/// minus the depth of bone to be removed there where it is negative. `rows` in the order of the points.
struct Insertion {
  std::vector<MapResult> rows;
  std::vector<double> deepest;  ///< of each row a time, k at pose k, of which the distance is at most the upper end
  MapSummary summary;
};

/// The implant (any model) moves by the poses after its primitives' own. Proven between the poses by how far a point of
/// the bone moves in the implant's frame. Throws Error(input) for a path without poses, for poses that are not finite
/// or have a zero quaternion, and as Mapper.
[[nodiscard]] Insertion smallest_distance_along(std::span<const Pose> path, const Model& implant,
                                                std::span<const Point> bone, const InsertionOptions& options);

/// So many points are searched together: on a processor's device a row may depend, in its last bits, on the others.
inline constexpr std::size_t points_per_insertion_block = 1024;

/// The same, some of the points at a time: whole blocks of them give the rows that all points together do.
class InsertionMapper {
 public:
  /// `bone` must outlive this. Throws as `smallest_distance_along`.
  InsertionMapper(std::span<const Pose> path, const Model& implant, std::span<const Point> bone,
                  const InsertionOptions& options);

  /// Precondition: points of the bone; `progress` tells of them alone.
  [[nodiscard]] Insertion operator()(std::size_t first, std::size_t count);

 private:
  struct State;
  Hidden<State> state_;
};

// The smallest distances along an implant's way in, with what proves them again.

struct CertifiedInsertion {
  std::vector<MapResult> rows;  ///< what the certificates prove, each an enclosure of the smallest distance
  std::vector<InsertionCertificate> certificates;
  MapSummary summary;  ///< as of the rows that were found
};

/// Certifies what `smallest_distance_along` found with the same arguments. Rows are about as tight as those, and wide
/// where a certificate would have too many parts. Interrupted, it has the rows that are proven by then, the first ones;
/// no device is used. Throws Error(input) unless the implant is is_union_of_convex. Precondition: `found` has a row for
/// each point of the bone.
[[nodiscard]] CertifiedInsertion certified_insertion(std::span<const Pose> path, const Model& implant,
                                                     std::span<const Point> bone, const Insertion& found,
                                                     const InsertionOptions& options);

// The smallest distance of a whole surface along an implant's way in, with what proves it again.

struct CertifiedWaySurface {
  Enclosure smallest_distance{};  ///< what the certificate proves
  WaySurfaceCertificate certificate;
  bool interrupted = false;  ///< then there is neither
};

/// Certifies what `mesh_clearance_along` found with the same arguments, given what certificates prove of each vertex
/// (`certified_insertion`). About as tight as what was found, and wider where a certificate would have too many
/// cells. No device is used. Throws Error(input) as WaySurfaceChecker.
[[nodiscard]] CertifiedWaySurface certified_way_surface(std::span<const Pose> path, const Model& implant,
                                                        const Mesh& bone, std::span<const Enclosure> of_vertices,
                                                        const MeshClearance& found, const InsertionOptions& options);

// Proves again how much bone an implant takes away on its way in: interval arithmetic, no OpenCL, no search.

/// A cube is judged as it is, or divided into its eight octants.
enum class CubeDivision : std::uint8_t { none, divided };

/// More cubes than that prove nothing: what would take longer to follow no checker need have.
inline constexpr std::size_t most_cubes_of_certificate = std::size_t{1} << 23U;

/// A cube that holds all that is swept, with all of its parts in preorder: of the octants those of smaller z first, of
/// these those of smaller y, then x. Wherever they are, volumes in them can be bounded; where the cubes are small, they
/// are bounded closely (docs/mathematics.md §23).
struct RemovedVolumeCertificate {
  Point centre{};           ///< of the whole cube
  double half_width = 0.0;  ///< likewise, in the units of the model
  std::vector<CubeDivision> cubes = {};
};

struct ProvenRemovedVolume {
  Enclosure volume{0.0, infinity};  ///< proven, in cubic model units
  std::uint64_t cubes = 0;          ///< that were looked at
  bool interrupted = false;         ///< then nothing is proven
};

/// The implant, a union of convex primitives, moves by the poses after its primitives' own, between them as in
/// insertion.hpp. Immutable after construction: safe to call from many threads.
class RemovedVolumeChecker {
 public:
  /// Throws Error(input) for another model, for a path without poses, for poses that are not finite or have a zero
  /// quaternion, for a resection that is not finite or has no normal, and for surfaces that are not finite, that are
  /// not closed with the fans over their rims, each edge run through as often one way as the other, or enclose nothing;
  /// and where a cavity lies beside the bone's outer surface, so that it is not one in that bone.
  RemovedVolumeChecker(const Model& implant, std::span<const Pose> path, const BoneRegion& bone);

  /// Returns the volume that the certificate proves, whatever it holds, of all bone that lies in the implant at some
  /// time. It has no upper end if its cube may miss a part of what is swept. It proves nothing if its parts are not
  /// those of one cube, or if their centres or widths are no binary64 numbers.
  [[nodiscard]] ProvenRemovedVolume operator()(const RemovedVolumeCertificate& certificate,
                                               const CheckOptions& options) const;

  /// Over how many rims each surface was closed.
  [[nodiscard]] const std::vector<std::size_t>& rims() const;

 private:
  struct State;
  Hidden<State> state_;
};

// How much bone an implant takes away on its way in: the volume that it sweeps of the bone, proven.

/// Largest width of the volume's enclosure that is usually asked for, divided by its lower end.
inline constexpr double usual_volume_tolerance = 0.02;

/// So little that nobody asks how much more exactly, however small the volume is: 1e-7 of the cube about the implant's
/// bounding sphere, in cubic model units.
[[nodiscard]] double negligible_volume(const Model& implant);

/// The work ends when the enclosure is at most as wide as one of both tolerances allows.
struct RemovedVolumeOptions {
  double relative_tolerance = usual_volume_tolerance;  ///< of the volume's lower end, >= 0
  double tolerance = 0.0;                              ///< in cubic model units, >= 0
  std::uint64_t most_cubes = std::uint64_t{1} << 21U;  ///< looked at, about: then the enclosure stays as it is
  std::function<bool()> interrupted = [] { return false; };
  std::function<void(const Enclosure& volume)> progress = [](const Enclosure&) {};
};

struct RemovedVolume {
  Enclosure volume;  ///< of all bone that lies in the implant at some time, in cubic model units
  bool within_tolerance = false;
  std::uint64_t cubes = 0;                ///< looked at
  std::vector<std::size_t> rims = {};     ///< of each surface, over which it was closed
  bool interrupted = false;               ///< what is told is proven all the same
  RemovedVolumeCertificate divided = {};  ///< the cubes of the search: certified_removed_volume.hpp
};

/// The implant, a union of convex primitives, moves by the poses after its primitives' own, between them as in
/// insertion.hpp. Throws Error(input) for another model, a path as there, options out of range, a surface as
/// check_surface_has_sides, a cavity beside the bone's outer surface, and where numbers overflow.
[[nodiscard]] RemovedVolume removed_volume(std::span<const Pose> path, const Model& implant, const BoneRegion& bone,
                                           const RemovedVolumeOptions& options);

// The volume of bone that an implant takes away on its way in, with what proves it again.

struct CertifiedRemovedVolume {
  Enclosure volume;  ///< what the certificate proves with a little to spare, in cubic model units
  RemovedVolumeCertificate certificate;
  bool interrupted = false;  ///< then nothing is proven
};

/// Certifies what `removed_volume` found with the same arguments. Throws as RemovedVolumeChecker.
[[nodiscard]] CertifiedRemovedVolume certified_removed_volume(std::span<const Pose> path, const Model& implant,
                                                              const BoneRegion& bone, const RemovedVolume& found,
                                                              const CheckOptions& options);

// The way in that takes the least bone away: the best of many straight or turning ways that are tried.

/// Ways into one last pose, from a middle one: directions that are off its direction by no more than an angle, turns
/// that differ from its turn by no more than another.
struct WaysIn {
  WayIn middle;
  double cone_degrees = 0.0;  ///< in [0, 80]
  double turn_degrees = 0.0;  ///< in [0, 180]
};

struct LeastRemovalProgress {
  std::size_t tried;
  std::size_t ways;  ///< to be tried in all
  Enclosure least;   ///< volume of the best one so far
};

struct LeastRemovalOptions {
  RemovedVolumeOptions volume;  ///< of the chosen way; its progress is not asked
  /// Ways are compared by the upper ends of volumes no wider than this share of their lower ends, or than `volume` asks
  /// for, where a moderate number of cubes allows it.
  double relative_tolerance = 0.05;
  std::function<void(const LeastRemovalProgress&)> progress = [](const LeastRemovalProgress&) {};
};

struct LeastRemoval {
  WayIn way;
  std::vector<Pose> path;    ///< of it
  RemovedVolume removed;     ///< of it, as closely as asked for: proven
  Enclosure of_middle;       ///< what the middle way takes away: proven, as closely as ways were compared
  std::size_t tried = 0;     ///< ways, the middle one among them
  std::size_t worse = 0;     ///< of them, proven to take away more than the chosen one
  bool interrupted = false;  ///< before all ways were tried, or the volume was as narrow as asked for
};

/// Tries ways that are spread over all of the family, then ever closer about the best one; each is given up as soon as
/// it is proven to take more away than the best. The volumes are proven, that there is no better way is not. The
/// implant ends where its model has it, and turns about an axis through `centre`. Throws Error(input) for angles out of
/// their ranges, where both are 0, and as path_of and removed_volume.
[[nodiscard]] LeastRemoval least_removal(const WaysIn& ways, const Point& centre, const Model& implant,
                                         const BoneRegion& bone, const LeastRemovalOptions& options);

// Where bone is, of which an insertion takes some away, from the surfaces that bound it.

struct NamedMesh {
  std::string name;  ///< stands for it in messages
  Mesh mesh;
};

/// Around a cavity, up to the bone's outer surface, the resection, or both. Throws Error(input) naming option and file
/// as `verisq insert` does, where nothing says where the bone ends, and for surfaces that are not what they should be:
/// one each, manifold and consistently oriented, the outer one's normals pointing outward, the cavity not beside it.
[[nodiscard]] BoneRegion bone_around(NamedMesh cavity, std::optional<NamedMesh> outer,
                                     const std::optional<Plane>& resection);

/// Inside the bone's outer surface. Throws likewise.
[[nodiscard]] BoneRegion bone_inside(NamedMesh outer, const std::optional<Plane>& resection);

/// The part of a mesh that the resection leaves. Throws Error(input) where that is nothing.
[[nodiscard]] Mesh before_resection(const NamedMesh& mesh, const Plane& resection);

}  // namespace verisq
