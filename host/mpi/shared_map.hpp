/// One map that all ranks of an MPI job make: blocks by a counter, rows of fixed size into one file, and what is
/// finished beside it, so that a job that was killed can go on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/map_part.hpp>

#include "host/mpi/communicator.hpp"

namespace verisq::mpi {

/// Maps the rows of a range, in its order, and hands them on in pieces.
using RangeMap = std::function<MapSummary(const RowRange&, const std::function<void(std::span<const MapResult>)>&)>;

struct SharedMapRequest {
  std::filesystem::path output;  ///< `.npy` or `.csv`
  std::uint64_t rows = 0;
  std::uint64_t rows_of_block = rows_per_block;  ///< chunks are of whole blocks, so that no row depends on ranks
  std::vector<std::string> subjects;             ///< files that rows depend on: models, then the input
  std::vector<PartSetting> settings;             ///< whatever else they depend on
  bool resume = false;                           ///< go on where a job with the same subjects and settings ended
};

struct SharedMapResult {
  MapSummary summary;            ///< of all rows, on every rank
  std::uint64_t taken_over = 0;  ///< rows of earlier jobs
  std::uint64_t chunks = 0;
};

/// Called by all ranks. Throws Error(input) where there is nothing to resume or it is of other subjects or settings,
/// Error(failure) where files cannot be written.
[[nodiscard]] SharedMapResult shared_map(const Session& session, const SharedMapRequest& request, const RangeMap& map);

}  // namespace verisq::mpi
