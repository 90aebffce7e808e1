/// The one exception type that crosses the library's boundary.
#pragma once

#include <stdexcept>
#include <string>

namespace verisq {

/// Whose fault an error is; the command line turns it into the exit status.
enum class ErrorKind {
  input,    ///< a file, a value or an option that the user can correct (exit status 2)
  failure,  ///< the program, a device or the file system failed (exit status 1)
};

/// Carries one line that a user can act on: it names file, position or key, and the offending value.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace verisq
