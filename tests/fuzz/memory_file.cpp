/// Memory files by memfd_create, reached through a symbolic link to /proc/self/fd.
#include "tests/fuzz/memory_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace verisq::fuzz {
namespace {

void check_call(bool succeeded, const char* call) {
  if (!succeeded) throw std::system_error(errno, std::generic_category(), call);
}

}  // namespace

MemoryFile::MemoryFile(std::string_view extension)
    : path_(folder_ / ("file" + std::string(extension))), descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
  check_call(descriptor_ >= 0, "memfd_create");
  std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(descriptor_), path_);
}

MemoryFile::~MemoryFile() {
  close(descriptor_);
}

void MemoryFile::write(Bytes bytes) const {
  check_call(ftruncate(descriptor_, 0) == 0, "ftruncate");
  const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), 0);
  check_call(written == static_cast<ssize_t>(bytes.size()), "pwrite");
}

}  // namespace verisq::fuzz
