/// A file that lives in memory: readers take paths, and a disk is slower than they are.
#pragma once

#include <filesystem>
#include <string_view>

#include "tests/fixtures/temporary_folder.hpp"
#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {

/// Linux's anonymous memory file, under a name with an extension, by which readers choose the format.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view extension);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Replaces the contents.
  void write(Bytes bytes) const;

 private:
  testing::TemporaryFolder folder_;
  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace verisq::fuzz
