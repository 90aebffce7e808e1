/// Cases as processes of their own: what crashes or runs out of memory takes no other with it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace verisq::command_line {

/// `verisq`, started in a folder. Both of its outputs go to files.
class BatchProcess {
 public:
  /// Throws Error(failure) when it cannot be started. It ends with this one, however that ends (Linux).
  BatchProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder, const std::filesystem::path& out, const std::filesystem::path& err);

  /// Its exit status, or 128 + the signal that ended it; nothing while it runs.
  [[nodiscard]] std::optional<int> status() const;
  void end() const;  ///< asks it to

 private:
  pid_t id_;
};

}  // namespace verisq::command_line
