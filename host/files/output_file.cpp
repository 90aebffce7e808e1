/// Temporary file, write errors, rename.
#include "host/files/output_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>
#include <utility>
#include <verisq/error.hpp>

namespace verisq {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 20;

/// A name that no other run uses; "x" in the mode of fopen makes sure of it.
std::filesystem::path temporary_for(const std::filesystem::path& target) {
  std::filesystem::path name = target;
  name += fmt::format(".{:08x}.partial", std::random_device{}());
  return name;
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path target)
    : target_(std::move(target)), temporary_(temporary_for(target_)), buffer_(buffer_size) {
  std::error_code ignored;                                // whatever it is, opening the file says it again
  if (std::filesystem::is_directory(target_, ignored)) {  // the rename would fail, but only after all the work
    errno = EISDIR;
    fail_by_errno();
  }
  errno = 0;
  file_.reset(std::fopen(temporary_.c_str(), "wbx"));
  if (!file_) fail_by_errno();
  std::setvbuf(file_.get(), buffer_.data(), _IOFBF, buffer_.size());
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  file_.reset();
  std::error_code ignored;  // a destructor can do nothing about it
  std::filesystem::remove(temporary_, ignored);
}

void OutputFile::write(std::string_view bytes) {
  if (bytes.empty()) return;  // fwrite wants a pointer even for nothing
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail_by_errno();
}

void OutputFile::finish_as(const std::filesystem::path& name) {
  // fclose writes the rest of the buffer: a full disk may show only now.
  if (std::fclose(file_.release()) != 0) fail_by_errno();
  std::error_code error;
  std::filesystem::rename(temporary_, name, error);
  if (error) {
    errno = error.value();
    fail_by_errno();
  }
  temporary_.clear();
}

void OutputFile::fail(std::string_view reason) const {
  throw Error(ErrorKind::failure, fmt::format("{}: cannot be written: {}", target_.string(), reason));
}

void OutputFile::fail_by_errno() const {
  fail(std::strerror(errno));
}

}  // namespace verisq
