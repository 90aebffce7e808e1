/// A range of items cut into pieces, one for each processor.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace verisq {

struct Piece {
  std::size_t first;
  std::size_t count;
};

/// About equal pieces of `count` items, front to back; fewer than processors where they would be below `smallest`.
[[nodiscard]] inline std::vector<Piece> pieces_of(std::size_t count, std::size_t smallest) {
  const std::size_t most = std::max<std::size_t>(1, count / smallest);
  const std::size_t pieces = std::min<std::size_t>(most, std::max(1U, std::thread::hardware_concurrency()));
  std::vector<Piece> result;
  for (std::size_t k = 0; k < pieces; ++k) {
    const std::size_t first = count * k / pieces;
    result.push_back({first, count * (k + 1) / pieces - first});
  }
  return result;
}

}  // namespace verisq
