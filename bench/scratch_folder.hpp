/// A folder for what a benchmark writes, which disappears at the end.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace verisq::bench {

class ScratchFolder {
 public:
  /// In the system's temporary folder, named after the benchmark and the process.
  explicit ScratchFolder(std::string_view benchmark)
      : path_(std::filesystem::temp_directory_path() / fmt::format("verisq_{}_{}", benchmark, getpid())) {
    std::filesystem::create_directory(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace verisq::bench
