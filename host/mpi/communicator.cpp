/// Calls of MPI's interface for C.
#include "host/mpi/communicator.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <string>
#include <verisq/error.hpp>

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

}  // namespace verisq::mpi
