/// Maps: enclosed distances of many points, triangles or poses to a model, on a device or the host.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/hidden.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// One row of a map: an enclosure and who proved it.

enum class Status : std::uint8_t {
  device_verified = 0,  ///< at most the tolerance wide, proven by the device's kernels
  host_verified = 1,    ///< left open by the device, proven by the host
  wide = 2,             ///< valid, but wider than the tolerance
};

/// The word used in `.csv` and `.json`: "device-verified", "host-verified", "wide".
[[nodiscard]] constexpr std::string_view to_string(Status status) {
  switch (status) {
    case Status::device_verified: return "device-verified";
    case Status::host_verified: return "host-verified";
    case Status::wide: break;
  }
  return "wide";
}

struct MapResult {
  Enclosure distance;
  Status status;
};

// The summary of all rows of a map.

struct MapSummary {
  std::string device;        ///< name of the device used, or "host"
  std::uint64_t points = 0;  ///< rows delivered to the sink
  std::uint64_t device_verified = 0;
  std::uint64_t host_verified = 0;
  std::uint64_t wide = 0;
  std::uint64_t wide_inside = 0;  ///< of those, rows with a lower end below 0
  double minimum_lo = 0.0;        ///< enclosure of the smallest distance of all rows
  double minimum_hi = 0.0;
  double largest_width = 0.0;
  double device_seconds = 0.0;  ///< during which kernels ran, those of two chunks at once counted once
  double host_seconds = 0.0;    ///< wall time of the host's proofs
  bool interrupted = false;
  bool out_of_time = false;  ///< the limit came while rows were wide
  std::string notice;        ///< why a device was passed over, or what depths mean; empty when nothing to say
};

// Queries and rows of a map where the caller has them in memory: columns with any stride.

/// Value i is first[i * stride]. A view: the memory must outlive it. A stride may be negative, of what is only read 0.
template <class Value>
struct Column {
  Value* first = nullptr;
  std::ptrdiff_t stride = 1;

  [[nodiscard]] Value& operator[](std::size_t i) const { return *at(i); }
  /// The column from value i on.
  [[nodiscard]] Column from(std::size_t i) const { return {at(i), stride}; }

 private:
  [[nodiscard]] Value* at(std::size_t i) const { return first + static_cast<std::ptrdiff_t>(i) * stride; }
};

/// Points wherever their coordinates lie.
class PointColumns {
 public:
  /// Points as they are, of stride 3: a vector or span of them.
  template <std::convertible_to<std::span<const Point>> Points>
  PointColumns(const Points& points) : PointColumns(of_points(points)) {}

  /// One column for each coordinate. Throws Error(input) unless they have one length.
  PointColumns(std::span<const double> x, std::span<const double> y, std::span<const double> z)
      : PointColumns(y.size() == x.size() && z.size() == x.size()
                         ? x.size()
                         : throw Error(ErrorKind::input, "the columns of the coordinates have different lengths"),
                     {x.data()}, {y.data()}, {z.data()}) {}

  PointColumns(std::size_t size, Column<const double> x, Column<const double> y, Column<const double> z)
      : size_(size), coordinates_{x, y, z} {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const std::array<Column<const double>, 3>& coordinates() const { return coordinates_; }
  [[nodiscard]] Point operator[](std::size_t i) const {
    return {coordinates_[0][i], coordinates_[1][i], coordinates_[2][i]};
  }

  /// Precondition: there are as many.
  [[nodiscard]] PointColumns subspan(std::size_t first, std::size_t count) const {
    return {count, coordinates_[0].from(first), coordinates_[1].from(first), coordinates_[2].from(first)};
  }

 private:
  static PointColumns of_points(std::span<const Point> points) {
    if (points.empty()) return {0, {}, {}, {}};
    const double* const first{points.front().data()};
    return {points.size(), {first, 3}, {first + 1, 3}, {first + 2, 3}};
  }

  std::size_t size_;
  std::array<Column<const double>, 3> coordinates_;
};

/// Where rows of a map go. Their values share memory neither with each other nor with the queries; columns that
/// interleave, like those of one record, are apart where their strides in bytes are the same.
class ResultColumns {
 public:
  /// Rows as they are.
  ResultColumns(std::span<MapResult> rows) : ResultColumns(of_rows(rows)) {}
  ResultColumns(std::vector<MapResult>& rows) : ResultColumns(of_rows(rows)) {}

  /// One column each. Throws Error(input) unless they have one length.
  ResultColumns(std::span<double> lo, std::span<double> hi, std::span<Status> status)
      : ResultColumns(hi.size() == lo.size() && status.size() == lo.size()
                          ? lo.size()
                          : throw Error(ErrorKind::input, "the columns of the rows have different lengths"),
                      {lo.data()}, {hi.data()}, {status.data()}) {}

  ResultColumns(std::size_t size, Column<double> lo, Column<double> hi, Column<Status> status)
      : size_(size), lo_(lo), hi_(hi), status_(status) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Column<double> lo() const { return lo_; }
  [[nodiscard]] Column<double> hi() const { return hi_; }
  [[nodiscard]] Column<Status> status() const { return status_; }
  [[nodiscard]] MapResult operator[](std::size_t i) const { return {{lo_[i], hi_[i]}, status_[i]}; }
  void set(std::size_t i, const MapResult& row) const {
    lo_[i] = row.distance.lo;
    hi_[i] = row.distance.hi;
    status_[i] = row.status;
  }

  /// Precondition: there are as many.
  [[nodiscard]] ResultColumns subspan(std::size_t first, std::size_t count) const {
    return {count, lo_.from(first), hi_.from(first), status_.from(first)};
  }

 private:
  static ResultColumns of_rows(std::span<MapResult> rows) {
    if (rows.empty()) return {0, ends(), ends(), {}};
    MapResult& first = rows[0];
    return {rows.size(), ends(&first.distance.lo), ends(&first.distance.hi), {&first.status, sizeof(MapResult)}};
  }

  static Column<double> ends(double* first = nullptr) { return {first, sizeof(MapResult) / sizeof(double)}; }

  std::size_t size_;
  Column<double> lo_;
  Column<double> hi_;
  Column<Status> status_;
};

/// All queries of a map: points wherever their coordinates lie, others as they are.
template <class Query>
struct QueriesInMemory {
  using type = std::span<const Query>;
};
template <>
struct QueriesInMemory<Point> {
  using type = PointColumns;
};

// A model whose place is known within bounds only: what a tracking system or a registration leaves open.

/// All poses x -> centre + E (x - centre) + d of what stands at its nominal pose: E any rotation about any axis by at
/// most `rotation`, |d[i]| <= translation[i].
struct PoseUncertainty {
  std::array<double, 3> translation{};  ///< along each axis, in model units; finite, at least 0
  double rotation = 0.0;                ///< in radians; finite, at least 0
  /// The point that the rotation leaves in place: in the coordinates of the points or triangles; for poses, in those of
  /// the model that they move.
  Point centre{};
};

/// Radians that are no less than the angle: for bounds that are known in degrees. Precondition: finite, at least 0.
[[nodiscard]] inline double radians_up(double degrees) {
  constexpr double above_pi_by_180 = 0x1.1df46a2529d3ap-6;  // the next binary64 number above it
  return std::nextafter(degrees * above_pi_by_180, infinity);
}

// The main job: a guaranteed distance for every point, triangle or pose of a stream.

/// So few rows are not worth a device's start, which takes a tenth of a second, or the first time as long as its
/// kernels take to compile: the host proves so many ordinary ones in a fiftieth. Who knows that there are no more asks
/// for "host" where "auto" was meant.
inline constexpr std::size_t few_rows = 128;

/// Rows `k rows_per_block` ... `(k + 1) rows_per_block - 1` of a map are a block: on a processor's device some are
/// proven side by side, and what one asks for its neighbours get, too. A row depends on its own block alone, so that
/// maps of whole blocks are, on the same device, bit by bit what one map of all has; not with a time limit, nor with
/// `pose_divisions`, where it depends on others', and on the clock.
inline constexpr std::size_t rows_per_block = 2048;

/// How the host proves points outside.
enum class Method {
  duality,    ///< certificates of docs/mathematics.md §2: tight
  published,  ///< the paper's bisected segment (published_method.hpp), to compare with: on the host, no certificates
};

struct MapOptions {
  /// Absolute, in model units: rows at most as wide are verified. 0 asks for the tightest: then those are verified that
  /// are as tight as the methods get, at most 1e-12 of the largest coordinate or the model's radius wide; of points
  /// inside, and of triangles and poses of models that are not is_union_of_convex, 2e-9 of the radius. Likewise where
  /// models or points are uncertain, whatever part of a row's width that is; of these the tightest is what the tightest
  /// distances to the bracketing models leave.
  double tolerance;
  /// "auto", "host", an index or a part of a device's name; for maps of points about models that are
  /// is_union_of_convex, without certificates, also several of these with commas between: they share the points, and a
  /// row is that of the device that it fell to.
  std::string device = "auto";
  bool certificates = false;  ///< deliver what proves each enclosure again; of poses there is nothing
  /// With certificates, of points and triangles that are exact about a model that is: prove what single primitives
  /// leave wide by covers (docs/mathematics.md §28), on the host. Points about models that are not the union of their
  /// primitives have no other certificates, triangles about bent ones neither.
  bool covers = true;
  Method method = Method::duality;  ///< of points; triangles and poses know duality alone
  /// Each point is any within this radius of the one given, each triangle any whose corners are; of poses 0.
  /// Precondition: finite, at least 0.
  double point_radius = 0.0;
  /// The model may be moved by any of these; of poses model B, after each of them. Then each row encloses the distances
  /// at all of these places, and the tolerance must be above 0: rows are never narrower than the distances differ. No
  /// certificates. Preconditions as there.
  std::optional<PoseUncertainty> pose_uncertainty = {};
  /// For points: the places where a point may stand, as seen from the model, are divided into at most so many parts
  /// along each axis; rounded down to a power of two. 1 widens a row by as much as the motions move its point, which
  /// always holds. From 16 on rows are little wider than the distances differ. Triangles and poses know 1 alone.
  unsigned pose_divisions = 1;
  std::function<bool()> interrupted = [] { return false; };  ///< polled between chunks; true ends the map early
  /// A time limit: polled, also by several threads at once; once true, it must stay true. Running searches end then,
  /// and no other begins. What the device has not begun by then is not begun any more. Every row is delivered all the
  /// same, with what is proven so far or known without a search: valid, and wide. Empty: no limit.
  std::function<bool()> out_of_time = {};
};

/// Fills the span from the front; returns how many, 0 at the end.
template <class Query>
using Source = std::function<std::size_t(std::span<Query>)>;
/// Receives rows in the order of the queries; certificates are empty unless the options ask for them.
template <class Query>
using Sink = std::function<void(std::span<const Query>, std::span<const MapResult>, std::span<const Certificate>)>;

/// Models made ready for maps: device chosen and tested, kernels compiled, buffers allocated. Many maps of one model
/// pay for that once. `Query` is one of
///   Point: each row encloses its signed distance to the model;
///   Triangle: the distance of the whole triangle, 0 where it meets the model;
///   Pose: the distance of model A and of model B moved by the pose (x -> R x + t, after B's primitives' own poses), 0
///     where they meet; unless both are is_union_of_convex the host searches each, and an interruption ends searches
///     under way, of which no row is told.
///
/// Meshes are solids for points (docs/mathematics.md §29): in unions with other primitives, or alone. A row encloses
/// the signed distance to the union; of a mesh alone, inside, minus the distance to the nearest triangle. Where
/// triangles cross, that is at most the depth, and the summary's notice says so. The host proves rows of meshes.
///
/// For uncertain models and points a row encloses the distances to every member from everything within `point_radius`.
/// The distances to the bracketing models (see Bracket) are asked for to half the tolerance each; seconds in the
/// summary add up those of their maps. An exact model is mapped directly. Certificates are those of Checker.
template <class Query>
class Mapper {
 public:
  /// Throws Error(input) for other models than those above, when no device matches `options.device`, when a named
  /// device failed its self-test, for the published method with a device or certificates, for it unless the model
  /// is_union_of_convex, for certificates without covers where there are no others, for a model that is proven to have
  /// no point, and as `bracket`.
  Mapper(const UncertainModel& model, const MapOptions& options) requires(!std::same_as<Query, Pose>);
  /// Throws Error(input) likewise, and for options that ask for certificates or give a point radius.
  Mapper(const UncertainModel& a, const UncertainModel& b,
         const MapOptions& options) requires std::same_as<Query, Pose>;

  /// Maps all queries of `source`. Memory is bounded by a few chunks, whatever their number; transfers overlap with
  /// work. Throws Error(input) for a query that is not finite or a pose whose quaternion is zero, and what source and
  /// sink throw. One call at a time.
  MapSummary map(const Source<Query>& source, const Sink<Query>& sink);

  /// For points PointColumns, to which a span of points or three spans of coordinates convert; for others a span.
  using Queries = typename QueriesInMemory<Query>::type;

  /// Maps `queries` and writes the row of each into the caller's memory, where nothing else may write meanwhile. Exact
  /// unions of convex primitives take the shortest way: kernels read the coordinates and write the rows where they are
  /// (of a device that computes in the host's memory; others copy), and the host sees only rows that are left open.
  /// Rows up to the summary's `points` are written; where a map was interrupted or threw, what the others hold is not
  /// specified. Throws Error(input) unless there are as many rows as queries, where columns of points and rows may
  /// share memory, and where the options ask for certificates, which have no column; otherwise as the other.
  MapSummary map(const Queries& queries, const ResultColumns& rows);

 private:
  struct State;
  Hidden<State> state_;
};

extern template class Mapper<Point>;
extern template class Mapper<Triangle>;
extern template class Mapper<Pose>;

using PointMapper = Mapper<Point>;
using TriangleMapper = Mapper<Triangle>;
using PoseMapper = Mapper<Pose>;

}  // namespace verisq
