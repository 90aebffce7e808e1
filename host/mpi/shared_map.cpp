/// This file implements shared_map.hpp.
#include "host/mpi/shared_map.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>
#include <string>
#include <system_error>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>
#include <verisq/version.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/input_file.hpp"
#include "host/files/npy_header.hpp"
#include "host/files/output_file.hpp"

namespace verisq::mpi {
namespace {

void require(int code, const std::string& what) {
  if (code == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(code, text.data(), &length);
  throw Error(ErrorKind::failure,
              fmt::format("{}: {}", what, std::string_view(text.data(), static_cast<std::size_t>(length))));
}

}  // namespace

Session::Session(int& argc, char**& argv) {
  int provided = 0;
  // Threads of a map read files and compute; this one alone calls MPI.
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
  MPI_Comm_rank(machine, &local_rank_);
  MPI_Comm_free(&machine);
}

Session::~Session() {
  MPI_Finalize();
}

void Session::wait_for_all() const {
  MPI_Barrier(MPI_COMM_WORLD);
}

std::uint64_t Session::largest(std::uint64_t value) const {
  std::uint64_t result = 0;
  MPI_Allreduce(&value, &result, 1, MPI_UINT64_T, MPI_MAX, MPI_COMM_WORLD);
  return result;
}

double Session::sum(double value) const {
  double result = 0.0;
  MPI_Allreduce(&value, &result, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return result;
}

std::vector<std::string> Session::gathered(const std::string& text) const {
  const auto size = static_cast<int>(text.size());
  const auto ranks = static_cast<std::size_t>(ranks_);
  std::vector<int> sizes(ranks);
  MPI_Gather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, MPI_COMM_WORLD);
  std::vector<int> starts(ranks);
  std::exclusive_scan(sizes.begin(), sizes.end(), starts.begin(), 0);
  std::string all(static_cast<std::size_t>(starts.back() + sizes.back()), '\0');
  MPI_Gatherv(text.data(), size, MPI_CHAR, all.data(), sizes.data(), starts.data(), MPI_CHAR, 0, MPI_COMM_WORLD);
  std::vector<std::string> texts;
  for (std::size_t i = 0; rank_ == 0 && i < ranks; ++i) {
    texts.push_back(all.substr(static_cast<std::size_t>(starts[i]), static_cast<std::size_t>(sizes[i])));
  }
  return texts;
}

void Session::share(std::span<std::byte> bytes) const {
  MPI_Bcast(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, MPI_COMM_WORLD);
}

void Session::abort(int status) const {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::abort();
}

struct Counter::Window {
  MPI_Win window = MPI_WIN_NULL;
};

Counter::Counter() : window_(std::make_unique<Window>()) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  std::uint64_t* memory = nullptr;
  const MPI_Aint bytes = rank == 0 ? static_cast<MPI_Aint>(sizeof(std::uint64_t)) : 0;
  require(MPI_Win_allocate(bytes, static_cast<int>(sizeof(std::uint64_t)), MPI_INFO_NULL, MPI_COMM_WORLD, &memory,
                           &window_->window),
          "the counter of the ranks");
  if (rank == 0) {
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, window_->window);
    *memory = 0;
    MPI_Win_unlock(0, window_->window);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

Counter::~Counter() {
  MPI_Win_free(&window_->window);
}

std::uint64_t Counter::next() {
  const std::uint64_t one = 1;
  std::uint64_t value = 0;
  MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, window_->window);
  const int code = MPI_Fetch_and_op(&one, &value, MPI_UINT64_T, 0, 0, MPI_SUM, window_->window);
  MPI_Win_unlock(0, window_->window);
  require(code, "the counter of the ranks");
  return value;
}

struct SharedFile::Handle {
  MPI_File file = MPI_FILE_NULL;
};

SharedFile::SharedFile(const std::filesystem::path& path) : path_(path), handle_(std::make_unique<Handle>()) {
  require(MPI_File_open(MPI_COMM_WORLD, path.c_str(), MPI_MODE_RDWR | MPI_MODE_CREATE, MPI_INFO_NULL, &handle_->file),
          path.string() + ": cannot be written");
}

SharedFile::~SharedFile() {
  if (handle_->file != MPI_FILE_NULL) MPI_File_close(&handle_->file);
}

void SharedFile::write_at(std::uint64_t position, std::span<const std::byte> bytes) {
  constexpr std::size_t most = std::size_t{1} << 30U;  // counts are int
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(most, bytes.size()));
    require(MPI_File_write_at(handle_->file, static_cast<MPI_Offset>(position), part.data(),
                              static_cast<int>(part.size()), MPI_BYTE, MPI_STATUS_IGNORE),
            path_.string() + ": cannot be written");
    position += part.size();
    bytes = bytes.subspan(part.size());
  }
}

void SharedFile::set_size(std::uint64_t bytes) {
  require(MPI_File_set_size(handle_->file, static_cast<MPI_Offset>(bytes)), path_.string() + ": cannot be written");
}

namespace {

// The layout in which host/files/table_maps.cpp writes rows of enclosures.
constexpr std::string_view descr = "[('lo', '<f8'), ('hi', '<f8'), ('status', '|u1')]";
constexpr std::size_t row_bytes = 17;

constexpr std::uint64_t most_rows_of_chunk = std::uint64_t{1} << 19U;
constexpr std::uint64_t chunks_of_rank = 32;  // so that none waits long for the last one

/// The record of a finished chunk; all zero for an unfinished one.
struct ChunkRecord {
  std::uint64_t finished;  // rows, and 1
  std::uint64_t device_verified, host_verified, wide, wide_inside;
  double minimum_lo, minimum_hi, largest_width;
};
static_assert(sizeof(ChunkRecord) == 64);

std::filesystem::path beside(const std::filesystem::path& output, std::string_view extension) {
  std::filesystem::path path = output;
  path += extension;
  return path;
}

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Identifies small files by all of their bytes. A digest of a large file would take longer than its map. So it is
/// identified by its size, the time of its last change, and its ends. This shows users who continue their own job that
/// they have changed the file; it does not prove that nobody did. Parts of maps (host/files/map_part.cpp), which come
/// together from many machines, have digests of all bytes.
std::string identity_of(const std::filesystem::path& path) {
  constexpr std::uintmax_t small = std::uintmax_t{1} << 22U;
  constexpr std::size_t end_bytes = std::size_t{1} << 20U;
  const std::uintmax_t size = std::filesystem::file_size(path);
  if (size <= small) return fmt::format("sha256 {}", digest_of_file(path).sha256);
  std::string ends(2 * end_bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(ends.data(), end_bytes);
  file.seekg(-static_cast<std::streamoff>(end_bytes), std::ios::end);
  file.read(ends.data() + end_bytes, end_bytes);
  const auto changed = std::filesystem::last_write_time(path).time_since_epoch().count();
  return fmt::format("size {} changed {} ends sha256 {}", size, changed, sha256(ends));
}

/// All that rows depend on.
std::string identity(const SharedMapRequest& request) {
  std::string text = fmt::format("verisq {}\nrows {}\n", VERISQ_VERSION, request.rows);
  for (const std::string& subject : request.subjects) text += identity_of(subject) + "\n";
  for (const auto& [name, value] : request.settings) text += fmt::format("{} {}\n", name, value);
  return text;
}

std::uint64_t rows_of_new_chunks(const SharedMapRequest& request, int ranks) {
  const std::uint64_t wanted = request.rows / (chunks_of_rank * static_cast<std::uint64_t>(ranks));
  const std::uint64_t limited = std::clamp<std::uint64_t>(wanted, request.rows_of_block, most_rows_of_chunk);
  return limited - limited % request.rows_of_block;
}

/// The size of the chunks of the resumed job; for rank 0. Throws Error(input).
std::uint64_t rows_of_resumed_chunks(const SharedMapRequest& request) {
  const std::string text = text_of_file(beside(request.output, ".job"));
  const std::size_t line = text.find('\n');
  constexpr std::string_view key = "chunk ";
  if (!text.starts_with(key) || line == std::string::npos) {
    refuse(fmt::format("--resume: {}: there is no job to go on with", beside(request.output, ".job").string()));
  }
  if (text.substr(line + 1) != identity(request)) {
    refuse(fmt::format("--resume: {}: is of another model, input, option or version",
                       beside(request.output, ".job").string()));
  }
  const std::uint64_t rows = std::strtoull(text.c_str() + key.size(), nullptr, 10);
  if (rows == 0 || rows % request.rows_of_block != 0) {
    refuse(fmt::format("--resume: {}: no size of chunks", beside(request.output, ".job").string()));
  }
  return rows;
}

class SharedMap {
 public:
  SharedMap(const Session& session, const SharedMapRequest& request, std::uint64_t rows_of_chunk)
      : session_(session),
        request_(request),
        rows_of_chunk_(rows_of_chunk),
        chunks_((request.rows + rows_of_chunk - 1) / rows_of_chunk),
        header_(npy_header(descr, request.rows)),
        rows_(beside(request.output, ".rows")),
        records_(beside(request.output, ".chunks")) {
    rows_.set_size(header_.size() + request.rows * row_bytes);
    records_.set_size(chunks_ * sizeof(ChunkRecord));
    if (session.rank() == 0) rows_.write_at(0, std::as_bytes(std::span(header_)));
    known_ = read_records();
    if (session.rank() == 0 && !request.resume) keep_identity();
    session.wait_for_all();
  }

  void run(const RangeMap& map) {
    Counter counter;
    for (std::uint64_t chunk = counter.next(); chunk < chunks_; chunk = counter.next()) {
      if (known_[chunk].finished != 0) continue;
      map_chunk(chunk, map);
    }
    session_.wait_for_all();
  }

  /// The result is the same on every rank, in the order of the chunks.
  [[nodiscard]] SharedMapResult result() const {
    SharedMapResult result;
    result.chunks = chunks_;
    MapSummary& sum = result.summary;
    sum.minimum_lo = sum.minimum_hi = infinity;
    const std::vector<ChunkRecord> records = read_records();
    for (std::uint64_t chunk = 0; chunk < chunks_; ++chunk) {
      const ChunkRecord& record = records[chunk];
      if (record.finished == 0) throw Error(ErrorKind::failure, fmt::format("chunk {} was not finished", chunk));
      sum.points += record.finished - 1;
      sum.device_verified += record.device_verified;
      sum.host_verified += record.host_verified;
      sum.wide += record.wide;
      sum.wide_inside += record.wide_inside;
      sum.minimum_lo = std::min(sum.minimum_lo, record.minimum_lo);
      sum.minimum_hi = std::min(sum.minimum_hi, record.minimum_hi);
      sum.largest_width = std::max(sum.largest_width, record.largest_width);
      if (known_[chunk].finished != 0) result.taken_over += known_[chunk].finished - 1;
    }
    return result;
  }

 private:
  [[nodiscard]] std::vector<ChunkRecord> read_records() const {
    std::vector<ChunkRecord> records(chunks_);
    const std::string bytes = text_of_file(beside(request_.output, ".chunks"));
    if (bytes.size() != chunks_ * sizeof(ChunkRecord)) {
      throw Error(ErrorKind::failure,
                  fmt::format("{}: {} bytes, and should have {}", beside(request_.output, ".chunks").string(),
                              bytes.size(), chunks_ * sizeof(ChunkRecord)));
    }
    if (!bytes.empty()) std::memcpy(records.data(), bytes.data(), bytes.size());
    return records;
  }

  [[nodiscard]] RowRange range_of(std::uint64_t chunk) const {
    const std::uint64_t first = chunk * rows_of_chunk_;
    return {first, std::min(rows_of_chunk_, request_.rows - first)};
  }

  /// The record after the rows: a process that is killed between leaves a chunk that is made again.
  void map_chunk(std::uint64_t chunk, const RangeMap& map) {
    const RowRange range = range_of(chunk);
    bytes_.clear();
    bytes_.reserve(range.count * row_bytes);
    const MapSummary summary = map(range, [&](std::span<const MapResult> rows) { append(rows); });
    if (bytes_.size() != range.count * row_bytes)
      throw Error(ErrorKind::failure, "the input has fewer rows than before");
    rows_.write_at(header_.size() + range.first * row_bytes, std::as_bytes(std::span(bytes_)));
    const ChunkRecord record{range.count + 1,    summary.device_verified, summary.host_verified,
                             summary.wide,       summary.wide_inside,     summary.minimum_lo,
                             summary.minimum_hi, summary.largest_width};
    records_.write_at(chunk * sizeof record, std::as_bytes(std::span(&record, 1)));
  }

  void append(std::span<const MapResult> rows) {
    const std::size_t start = bytes_.size();
    bytes_.resize(start + rows.size() * row_bytes);
    char* at = bytes_.data() + start;
    for (const MapResult& row : rows) {
      const double lo = in_little_endian(row.distance.lo);
      const double hi = in_little_endian(row.distance.hi);
      std::memcpy(at, &lo, sizeof lo);
      std::memcpy(at + sizeof lo, &hi, sizeof hi);
      at[row_bytes - 1] = static_cast<char>(row.status);
      at += row_bytes;
    }
  }

  void keep_identity() {
    OutputFile file(beside(request_.output, ".job"));
    file.write(fmt::format("chunk {}\n{}", rows_of_chunk_, identity(request_)));
    file.finish();
  }

  const Session& session_;
  const SharedMapRequest& request_;
  std::uint64_t rows_of_chunk_;
  std::uint64_t chunks_;
  std::string header_;
  SharedFile rows_;
  SharedFile records_;
  std::vector<ChunkRecord> known_;
  std::vector<char> bytes_;  // of a chunk
};

/// Writes the rows in order, a few at a time.
void write_csv(const std::filesystem::path& rows_file, const SharedMapRequest& request) {
  constexpr std::size_t at_once = std::size_t{1} << 16U;
  std::ifstream rows(rows_file, std::ios::binary);
  rows.seekg(static_cast<std::streamoff>(npy_header(descr, request.rows).size()));
  // Rows are enclosures alone: the kind of elements does not matter.
  MapWriter writer(request.output, nullptr, MapForm{.elements = MapElements::poses, .format = ".csv"});
  std::vector<char> bytes(at_once * row_bytes);
  std::vector<MapResult> results(at_once);
  for (std::uint64_t done = 0; done < request.rows;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(at_once, request.rows - done));
    if (!rows.read(bytes.data(), static_cast<std::streamsize>(count * row_bytes))) {
      throw Error(ErrorKind::failure, fmt::format("{}: cannot be read", rows_file.string()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const char* const at = bytes.data() + i * row_bytes;
      results[i] = {{number_from<double>(at, std::endian::little), number_from<double>(at + 8, std::endian::little)},
                    static_cast<Status>(at[row_bytes - 1])};
    }
    writer.append(std::span(results).first(count));
    done += count;
  }
  writer.finish();
}

void name_the_whole(const SharedMapRequest& request) {
  const std::filesystem::path rows = beside(request.output, ".rows");
  if (request.output.extension() == ".csv") {
    write_csv(rows, request);
    std::filesystem::remove(rows);
  } else {
    std::filesystem::rename(rows, request.output);
  }
  std::filesystem::remove(beside(request.output, ".chunks"));
  std::filesystem::remove(beside(request.output, ".job"));
}

/// The files of an earlier job are useless to a new one.
void remove_leftovers(const SharedMapRequest& request) {
  for (const char* const extension : {".job", ".chunks", ".rows"}) {
    std::error_code ignored;
    std::filesystem::remove(beside(request.output, extension), ignored);
  }
}

}  // namespace

SharedMapResult shared_map(const Session& session, const SharedMapRequest& request, const RangeMap& map) {
  // 0: nothing to resume, which rank 0 alone says.
  std::uint64_t rows_of_chunk = 0;
  std::exception_ptr refusal;
  if (session.rank() == 0) {
    try {
      if (!request.resume) remove_leftovers(request);
      rows_of_chunk = request.resume ? rows_of_resumed_chunks(request) : rows_of_new_chunks(request, session.ranks());
    } catch (const Error&) {
      refusal = std::current_exception();
    }
  }
  session.share(std::as_writable_bytes(std::span(&rows_of_chunk, 1)));
  if (refusal) std::rethrow_exception(refusal);
  if (rows_of_chunk == 0) throw Error(ErrorKind::input, "");
  SharedMapResult result;
  {
    SharedMap shared(session, request, rows_of_chunk);
    shared.run(map);
    result = shared.result();
  }
  session.wait_for_all();
  if (session.rank() == 0) name_the_whole(request);
  session.wait_for_all();
  return result;
}

}  // namespace verisq::mpi
