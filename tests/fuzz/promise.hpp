/// What every reader promises: to refuse in one line, and to break nothing.
#pragma once

#include <stdexcept>
#include <string>
#include <verisq/error.hpp>

namespace verisq::fuzz {

class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws BrokenPromise with `promise`, which says what should have held.
inline void check(bool held, const char* promise) {
  if (!held) throw BrokenPromise(promise);
}

/// A user must be able to act on the message, and a terminal must survive it.
inline void check_refusal(const Error& error, const std::string& name) {
  constexpr std::size_t longest = 8000;  // a JSON path of 100 levels, each key shortened to 60 characters
  const std::string message = error.what();
  check(error.kind() == ErrorKind::input, "a bad file is the user's to correct: Error(input)");
  check(message.starts_with(name + ": "), "a refusal starts with the name of the file");
  check(message.find_first_of("\r\n") == std::string::npos, "a refusal is one line");
  check(message.size() - name.size() <= longest, "a refusal is not as long as the file");
  for (const char c : message) check(0x20 <= c && c < 0x7f, "a refusal is printable ASCII");
}

/// Runs `read`, which may refuse; `name` is that of the file it reads.
template <class Read>
void read_or_refuse(const std::string& name, Read read) {
  try {
    read();
  } catch (const Error& error) {
    check_refusal(error, name);
  }
}

}  // namespace verisq::fuzz
