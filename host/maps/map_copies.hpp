/// A map of what lies in memory by one that reads from a source and writes to a sink.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "verisq/columns.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Delivers `queries`, which must outlive it, from the number `next` on.
template <class Query>
[[nodiscard]] Source<Query> source_of(const typename QueriesInMemory<Query>::type& queries, std::size_t next = 0) {
  return [&queries, next](std::span<Query> chunk) mutable {
    const std::size_t count = std::min(chunk.size(), queries.size() - next);
    for (std::size_t i = 0; i < count; ++i) chunk[i] = queries[next + i];
    next += count;
    return count;
  };
}

/// Fills `columns` from the row `next` on; drops certificates.
template <class Query>
[[nodiscard]] Sink<Query> sink_of(const ResultColumns& columns, std::size_t next = 0) {
  return
      [columns, next](std::span<const Query>, std::span<const MapResult> rows, std::span<const Certificate>) mutable {
        for (const MapResult& row : rows) columns.set(next++, row);
      };
}

/// `map(source, sink)` of all queries. Precondition: as many rows.
template <class Query, class Map>
[[nodiscard]] MapSummary map_copies(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows,
                                    const Map& map) {
  return map(source_of<Query>(queries), sink_of<Query>(rows));
}

}  // namespace verisq
