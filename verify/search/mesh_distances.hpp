/// Distances of a mesh to a model's surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/hidden.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The inputs of the searches of docs/mathematics.md §20: enclosures of signed distances, parallel work, the required
// widths of results, and when to end.

/// Fills each row with an enclosure of the signed distance of its point, to a model or to one primitive of it. False if
/// it ended early: then the rows are meaningless. Precondition: as many rows as points.
using SignedDistances = std::function<bool(std::span<const Point> points, std::span<Enclosure> rows)>;

/// Calls work(i) once for each i below `count`, in any order, by several threads.
using Parallel = std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;

struct DeviationSearch {
  SignedDistances to_model;
  /// To each primitive by itself; empty unless the model is a union of several convex ones.
  std::vector<SignedDistances> to_primitives = {};
  /// To each primitive by itself, for any model; empty if the model has one primitive and no set operations.
  std::vector<SignedDistances> to_each_primitive = {};
  bool convex = false;                    ///< the model is one convex primitive
  std::function<double(double)> allowed;  ///< the allowed width of an enclosure with this lower end; rises with it
  Parallel in_parallel;
  std::function<bool()> ended;             ///< polled; once true it stays so
  std::function<void(double)> progress;    ///< called with the approximate share of the work done, from 0 to 1
  std::uint64_t most_samples = 1U << 24U;  ///< limit of the number of distances, about
};

// The distances of a mesh's triangles from the boundary of a solid: the largest, the mean, and percentiles
// (docs/mathematics.md §20).

struct MeshDistances {
  Enclosure largest;  ///< the supremum
  Point where{};  ///< this point is `largest.lo` away from the boundary; a point of the mesh lies within rounding of it
  std::optional<Enclosure> mean = {};
  std::vector<Enclosure> percentiles = {};
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: everything is valid, and something wide
};

/// Parts of a mesh that are also measured by themselves: the region of each triangle, below `count`. Without regions:
/// empty, 0.
struct MeshRegions {
  std::span<const std::uint32_t> region_of = {};
  std::size_t count = 0;
};

class MeshSearch {
 public:
  /// `at_vertices`: signed distances of the mesh's vertices. Mesh, search and regions must outlive it. Precondition:
  /// the mesh has triangles; as many enclosures as vertices, each of which may be unbounded.
  MeshSearch(const Mesh& mesh, std::span<const Enclosure> at_vertices, const DeviationSearch& search,
             const MeshRegions& regions = {});

  /// Until the largest distance is narrow.
  void search_largest();
  /// Until mean and percentiles are.
  void search_statistics(std::span<const double> percentiles);

  /// Until of each region the share of its area that is no farther than `distance` is no wider than `width`.
  void search_within(double distance, double width);
  /// The areas of each region; all are 0 for a region without triangles.
  [[nodiscard]] std::vector<AreaWithin> within_by_region(double distance) const;
  /// The areas of the whole mesh.
  [[nodiscard]] AreaWithin within(double distance) const;

  /// For each region, `largest`, `where` and `mean`. Its largest is as narrow as that of the whole mesh if
  /// `search_largest` was not ended; its mean may be wide. All are 0 for a region without triangles.
  [[nodiscard]] std::vector<MeshDistances> found_by_region() const;

  /// The results so far; mean and percentiles only after the search for them.
  [[nodiscard]] MeshDistances found() const;

 private:
  class Pieces;
  Hidden<Pieces> pieces_;
};

}  // namespace verisq::verify
