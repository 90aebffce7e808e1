/// The main job: a guaranteed signed distance for every point of a stream.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <verisq/certificate.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// How the host proves points outside.
enum class Method {
  duality,    ///< certificates of docs/mathematics.md §2: tight
  published,  ///< the paper's bisected segment (published_method.hpp), to compare with: on the host, no certificates
};

struct MapOptions {
  /// Absolute, in model units: rows at most as wide are verified. 0 asks for the tightest: then those are verified that
  /// are as tight as the methods get, at most 1e-12 of the largest coordinate or the model's radius wide; of points
  /// inside, 2e-9 of the radius.
  double tolerance;
  std::string device = "auto";                               ///< "auto", "host", an index or a part of a device's name
  bool certificates = false;                                 ///< deliver what proves each enclosure again
  Method method = Method::duality;                           ///< of points; triangles know duality alone
  std::function<bool()> interrupted = [] { return false; };  ///< polled between chunks; true ends the map early
  /// A time limit: polled, also by several threads at once; once true, it must stay true. Running searches end then,
  /// and no other begins. What the device has not begun by then is not begun any more. Every row is delivered all the
  /// same, with what is proven so far or known without a search: valid, and wide. Empty: no limit.
  std::function<bool()> out_of_time = {};
};

struct MapSummary {
  std::string device;        ///< name of the device used, or "host"
  std::uint64_t points = 0;  ///< rows delivered to the sink
  std::uint64_t device_verified = 0;
  std::uint64_t host_verified = 0;
  std::uint64_t wide = 0;
  std::uint64_t wide_inside = 0;  ///< of those, rows with a lower end below 0
  double minimum_lo = 0.0;        ///< enclosure of the smallest signed distance of all points
  double minimum_hi = 0.0;
  double largest_width = 0.0;
  double device_seconds = 0.0;  ///< during which kernels ran, those of two chunks at once counted once
  double host_seconds = 0.0;    ///< wall time of the host's proofs
  bool interrupted = false;
  bool out_of_time = false;  ///< the limit came while rows were wide
  std::string notice;        ///< why a device was passed over; empty when nothing to say
};

/// Fills the span from the front; returns how many, 0 at the end.
using PointSource = std::function<std::size_t(std::span<Point>)>;
/// Receives rows in the order of the points; certificates are empty unless the options ask for them.
using MapSink = std::function<void(std::span<const Point>, std::span<const MapResult>, std::span<const Certificate>)>;

/// A model made ready for maps: device chosen and tested, kernels compiled, buffers allocated. Many maps of one model
/// pay for that once.
class DistanceMapper {
 public:
  /// Throws Error(input) when no device matches `options.device`, when a named device failed its self-test, for the
  /// published method with a device or certificates, for either of these unless the model is_union_of_convex, or for a
  /// model that is proven to have no point.
  DistanceMapper(const Model& model, const MapOptions& options);
  ~DistanceMapper();
  DistanceMapper(DistanceMapper&&) noexcept;
  DistanceMapper& operator=(DistanceMapper&&) noexcept;

  /// Maps all points of `source`. Memory is bounded by a few chunks, whatever their number; transfers overlap with
  /// work. Throws Error(input) for a point that is not finite, and what source and sink throw. One call at a time.
  MapSummary map(const PointSource& source, const MapSink& sink);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// As PointSource and MapSink.
using TriangleSource = std::function<std::size_t(std::span<Triangle>)>;
using TriangleSink =
    std::function<void(std::span<const Triangle>, std::span<const MapResult>, std::span<const Certificate>)>;

/// As DistanceMapper for the distance of whole triangles to the model, which is 0 where they meet it, of models that
/// are is_union_of_convex only.
class TriangleMapper {
 public:
  TriangleMapper(const Model& model, const MapOptions& options);
  ~TriangleMapper();
  TriangleMapper(TriangleMapper&&) noexcept;
  TriangleMapper& operator=(TriangleMapper&&) noexcept;

  MapSummary map(const TriangleSource& source, const TriangleSink& sink);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One map of a model: DistanceMapper(model, options).map(source, sink).
MapSummary map_points(const Model& model, const PointSource& source, const MapSink& sink, const MapOptions& options);

}  // namespace verisq
