/// The functions of MPI that are used, with errors as exceptions, and one map that all ranks of an MPI job make.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>

namespace verisq::mpi {

// The functions of MPI for shared maps and cohorts, with errors as exceptions; only shared_map.cpp includes mpi.h.

/// MPI from its first call to its last. One object in a program.
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int ranks() const { return ranks_; }
  /// Among the ranks of this machine.
  [[nodiscard]] int local_rank() const { return local_rank_; }

  void wait_for_all() const;
  /// The largest of all ranks' values.
  [[nodiscard]] std::uint64_t largest(std::uint64_t value) const;
  [[nodiscard]] double sum(double value) const;
  /// The texts of all ranks, in their order, at rank 0; nothing at the others. Precondition: less than 2 GiB in all.
  [[nodiscard]] std::vector<std::string> gathered(const std::string& text) const;
  /// Sends the bytes of rank 0 to all.
  void share(std::span<std::byte> bytes) const;
  /// Ends all ranks: others would wait for this one for ever.
  [[noreturn]] void abort(int status) const;

 private:
  int rank_ = 0;
  int ranks_ = 1;
  int local_rank_ = 0;
};

/// Numbers from 0 on, each given to one rank: a counter in the memory of rank 0, which others reach without its help.
class Counter {
 public:
  Counter();
  ~Counter();
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;

  [[nodiscard]] std::uint64_t next();

 private:
  struct Window;
  std::unique_ptr<Window> window_;
};

/// A file that all ranks opened together; each writes its own part. Throws Error(failure).
class SharedFile {
 public:
  /// Creates the file if it does not exist.
  explicit SharedFile(const std::filesystem::path& path);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  /// Written bytes outlive this process once it returns.
  void write_at(std::uint64_t position, std::span<const std::byte> bytes);
  void set_size(std::uint64_t bytes);  ///< to be called by all ranks

 private:
  struct Handle;
  std::filesystem::path path_;
  std::unique_ptr<Handle> handle_;
};

// One map that all ranks of an MPI job make: blocks by a counter, rows of fixed size into one file. A record of
// finished parts lies beside it, so that a killed job can continue.

/// Maps the rows of a range, in its order, and hands them on in pieces.
using RangeMap = std::function<MapSummary(const RowRange&, const std::function<void(std::span<const MapResult>)>&)>;

struct SharedMapRequest {
  std::filesystem::path output;  ///< `.npy` or `.csv`
  std::uint64_t rows = 0;
  std::uint64_t rows_of_block = rows_per_block;  ///< chunks are of whole blocks, so that no row depends on ranks
  std::vector<std::string> subjects;             ///< files that rows depend on: models, then the input
  std::vector<PartSetting> settings;             ///< all other settings on which they depend
  bool resume = false;                           ///< go on where a job with the same subjects and settings ended
};

struct SharedMapResult {
  MapSummary summary;            ///< of all rows, on every rank
  std::uint64_t taken_over = 0;  ///< rows of earlier jobs
  std::uint64_t chunks = 0;
};

/// Called by all ranks. Throws Error(input) if there is nothing to resume or it has other subjects or settings,
/// Error(failure) if files cannot be written.
[[nodiscard]] SharedMapResult shared_map(const Session& session, const SharedMapRequest& request, const RangeMap& map);

}  // namespace verisq::mpi
