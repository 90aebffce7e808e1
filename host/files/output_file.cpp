/// Symbolic links, temporary file, write errors, rename.
#include "host/files/output_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>
#include <utility>
#include <verisq/error.hpp>

#include "host/files/input_file.hpp"

namespace verisq {
namespace {

/// The buffer for data written in small parts: larger parts bypass it.
constexpr std::size_t buffer_size = std::size_t{1} << 16;

/// A name that no other run uses; "x" in the mode of fopen makes sure of it.
std::filesystem::path temporary_for(const std::filesystem::path& target) {
  std::filesystem::path name = target;
  name += fmt::format(".{:08x}.partial", std::random_device{}());
  return name;
}

/// Gives a new file the permissions of the older one that it will replace, and its owner if that is allowed: only the
/// superuser can give files away.
void take_over_permissions(const std::filesystem::path& older, int file) {
  struct stat status = {};
  if (stat(older.c_str(), &status) != 0) return;
  [[maybe_unused]] const int not_ours_to_give = fchown(file, status.st_uid, status.st_gid);
  constexpr mode_t permissions = 07777;
  fchmod(file, status.st_mode & permissions);
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path name) : name_(std::move(name)), buffer_(buffer_size) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(name_, error);
  // Links in circles; and a folder, where the rename would fail, but only after all the work.
  if (status.type() == std::filesystem::file_type::none) fail(error.message());
  if (std::filesystem::is_directory(status)) fail(std::strerror(EISDIR));
  if (std::filesystem::is_block_file(status)) fail("a block device");  // with somebody's files on it
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    target_ = name_;
    if (access(target_.c_str(), W_OK) != 0) fail_by_errno();
    return;  // opened by the first `write`: whoever reads a pipe sees its end when a file that only tried is gone
  }
  target_ = through_links(name_);
  const std::filesystem::path temporary = temporary_for(target_);
  open(temporary, "wbx");
  temporary_ = temporary;
  take_over_permissions(target_, fileno(file_.get()));
}

OutputFile::OutputFile() : name_("standard output"), buffer_(buffer_size) {
  const int descriptor = dup(STDOUT_FILENO);  // whose end closes no other's
  if (descriptor >= 0) file_.reset(fdopen(descriptor, "wb"));
  if (!file_) fail_by_errno();
  std::setvbuf(file_.get(), buffer_.data(), _IOFBF, buffer_.size());
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  file_.reset();
  std::error_code ignored;  // a destructor can do nothing about it
  std::filesystem::remove(temporary_, ignored);
}

void OutputFile::open(const std::filesystem::path& path, const char* mode) {
  errno = 0;
  file_.reset(std::fopen(path.c_str(), mode));
  if (!file_) fail_by_errno();
  std::setvbuf(file_.get(), buffer_.data(), _IOFBF, buffer_.size());
}

void OutputFile::write(std::string_view bytes) {
  if (bytes.empty()) return;  // fwrite wants a pointer even for nothing
  if (!file_) open(target_, "wb");
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail_by_errno();
}

void OutputFile::flush() {
  if (file_ && std::fflush(file_.get()) != 0) fail_by_errno();
}

void OutputFile::write_at(std::uint64_t position, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = pwrite(fileno(file_.get()), bytes.data(), bytes.size(), static_cast<off_t>(position));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_by_errno();
    bytes.remove_prefix(static_cast<std::size_t>(count));
    position += static_cast<std::uint64_t>(count);
  }
}

void OutputFile::finish() {
  close();
  rename_to(target_);
}

std::filesystem::path OutputFile::finish_as_partial() {
  close();
  if (temporary_.empty()) return name_;
  std::filesystem::path kept = target_;
  kept += ".partial";
  rename_to(kept);
  return kept;
}

void OutputFile::close() {
  // fclose writes the rest of the buffer: a full disk may show only now.
  if (file_ && std::fclose(file_.release()) != 0) fail_by_errno();
}

void OutputFile::rename_to(const std::filesystem::path& path) {
  if (temporary_.empty()) return;
  std::error_code error;
  std::filesystem::rename(temporary_, path, error);
  if (error) fail(error.message());
  temporary_.clear();
}

void OutputFile::fail(std::string_view reason) const {
  throw Error(ErrorKind::failure, fmt::format("{}: cannot be written: {}", name_.string(), reason));
}

void OutputFile::fail_by_errno() const {
  fail(std::strerror(errno));
}

}  // namespace verisq
