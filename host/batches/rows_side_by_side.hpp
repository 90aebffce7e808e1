/// Queries of a chunk that a processor's device may work on side by side, so that what one needs the others get, too.
#pragma once

#include <cstddef>

namespace verisq::device {

/// Chunks begin at multiples of it. rows_per_block in include/verisq/map.hpp is the same.
inline constexpr std::size_t rows_side_by_side = 2048;

}  // namespace verisq::device
