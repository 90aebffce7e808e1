/// Distances of a mesh to a model's surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// What the searches of docs/mathematics.md §20 are given: who encloses signed distances, who works in parallel, how
// narrow results shall be, and when to end.

/// Fills each row with an enclosure of the signed distance of its point, to a model or to one primitive of it. False
/// where it ended early: the rows mean nothing then. Precondition: as many rows as points.
using SignedDistances = std::function<bool(std::span<const Point> points, std::span<Enclosure> rows)>;

/// Calls work(i) once for each i below `count`, in any order, by several threads.
using Parallel = std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;

struct DeviationSearch {
  SignedDistances to_model;
  /// To each primitive by itself; empty unless the model is a union of several convex ones.
  std::vector<SignedDistances> to_primitives = {};
  /// To each primitive by itself, whatever the model is; empty where it has one and no set operations.
  std::vector<SignedDistances> to_each_primitive = {};
  bool convex = false;                    ///< the model is one convex primitive
  std::function<double(double)> allowed;  ///< how wide an enclosure with this lower end may be; rises with it
  Parallel in_parallel;
  std::function<bool()> ended;             ///< polled; once true it stays so
  std::function<void(double)> progress;    ///< how much is done, from 0 to 1, about
  std::uint64_t most_samples = 1U << 24U;  ///< distances asked for, about
};

// How far the triangles of a mesh lie from the boundary of a solid: at most, in the mean, and percentiles
// (docs/mathematics.md §20).

struct MeshDistances {
  Enclosure largest;  ///< the supremum
  Point where{};      ///< a point of the mesh within rounding of it is `largest.lo` away
  std::optional<Enclosure> mean = {};
  std::vector<Enclosure> percentiles = {};
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: everything is valid, and something wide
};

/// Parts of a mesh that are measured by themselves, too: the region of each triangle, below `count`. None: empty, 0.
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
  ~MeshSearch();
  MeshSearch(const MeshSearch&) = delete;
  MeshSearch& operator=(const MeshSearch&) = delete;

  /// Until the largest distance is narrow.
  void search_largest();
  /// Until mean and percentiles are.
  void search_statistics(std::span<const double> percentiles);

  /// Until of each region the share of its area that is no farther than `distance` is no wider than `width`.
  void search_within(double distance, double width);
  /// Of each region; of one without triangles all are 0.
  [[nodiscard]] std::vector<AreaWithin> within_by_region(double distance) const;
  /// Of all of them.
  [[nodiscard]] AreaWithin within(double distance) const;

  /// Of each region, `largest`, `where` and `mean`: its largest is as narrow as that of all if `search_largest` was not
  /// ended, its mean as it came. Of a region without triangles all are 0.
  [[nodiscard]] std::vector<MeshDistances> found_by_region() const;

  /// What is known by now; mean and percentiles only after the search for them.
  [[nodiscard]] MeshDistances found() const;

 private:
  class Pieces;
  std::unique_ptr<Pieces> pieces_;
};

}  // namespace verisq::verify
