/// Queries from memory through a map, once or again and again.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ranges>
#include <span>
#include <vector>
#include <verisq/map.hpp>

#include "bench/uniform_numbers.hpp"

namespace verisq::bench {

/// `count` queries: all of `queries` in turn, which must outlive the source.
template <class Query>
[[nodiscard]] Source<Query> repeated(std::span<const Query> queries, std::size_t count) {
  return [queries, count, done = std::size_t{0}](std::span<Query> chunk) mutable {
    const std::size_t size = std::min(chunk.size(), count - done);
    for (std::size_t n = 0; n < size; ++n) chunk[n] = queries[(done + n) % queries.size()];
    done += size;
    return size;
  };
}

/// The rows of all queries.
template <class Query, class Queries>
[[nodiscard]] std::vector<MapResult> rows_of(Mapper<Query>& mapper, const Queries& queries) {
  std::vector<MapResult> all;
  mapper.map(repeated(std::span<const Query>(queries), std::ranges::size(queries)),
             [&](std::span<const Query>, std::span<const MapResult> rows, std::span<const Certificate>) {
               all.insert(all.end(), rows.begin(), rows.end());
             });
  return all;
}

/// About all primitives in turn, within twice their size of their centres; the sequence depends on the arguments alone.
[[nodiscard]] inline std::vector<Point> points_about(const Model& model, std::size_t count) {
  UniformNumbers uniform(20'110'508);
  std::vector<Point> points(count);
  for (std::size_t n = 0; n < count; ++n) {
    const Primitive& primitive = model.primitives[n % model.primitives.size()];
    const double size = 2.0 * std::ranges::max(primitive.superquadric.semi_axes);
    for (std::size_t axis = 0; axis < 3; ++axis)
      points[n][axis] = primitive.pose.translation[axis] + uniform.within(size);
  }
  return points;
}

}  // namespace verisq::bench
