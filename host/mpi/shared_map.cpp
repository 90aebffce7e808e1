/// Three files while it runs: OUT.rows, what becomes the map; OUT.chunks, a record for each finished chunk; OUT.job,
/// what the job is about.
#include "host/mpi/shared_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>
#include <verisq/version.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/byte_order.hpp"
#include "host/files/npy_header.hpp"
#include "host/files/output_file.hpp"
#include "host/files/sha256.hpp"

namespace verisq::mpi {
namespace {

// As host/files/npy_map.cpp writes rows of enclosures.
constexpr std::string_view descr = "[('lo', '<f8'), ('hi', '<f8'), ('status', '|u1')]";
constexpr std::size_t row_bytes = 17;

constexpr std::uint64_t most_rows_of_chunk = std::uint64_t{1} << 19U;
constexpr std::uint64_t chunks_of_rank = 32;  // so that none waits long for the last one

/// What is known of a finished chunk; all zero of one that is not.
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

/// Small files by all of their bytes. A digest of a large one would take longer than its map: by its size, when it was
/// last changed, and its ends, which tells whoever goes on with his own job when he has changed it; it is no proof that
/// nobody did. Parts of maps (host/files/map_part.cpp), which meet from many machines, have digests of all bytes.
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

/// Of rank 0: the size of the chunks that the job to be resumed had. Throws Error(input).
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

  /// The same on every rank, in the order of the chunks.
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

/// In order, a little at a time.
void write_csv(const std::filesystem::path& rows_file, const SharedMapRequest& request) {
  constexpr std::size_t at_once = std::size_t{1} << 16U;
  std::ifstream rows(rows_file, std::ios::binary);
  rows.seekg(static_cast<std::streamoff>(npy_header(descr, request.rows).size()));
  // Enclosures alone: of which elements they are makes no difference.
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

/// What an earlier job left is of no use to a new one.
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
