/// The message that a contradiction leaves behind: all that a report needs.
#include "verify/proof/intersection.hpp"

#include <array>
#include <charconv>

#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

/// The shortest digits that give the same number again.
std::string digits(double x) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x).ptr};
}

std::string text_of(const Enclosure& e) {
  return std::string("[").append(digits(e.lo)).append(", ").append(digits(e.hi)).append("]");
}

}  // namespace

std::string text_of(const Point& x) {
  std::string text("(");
  return text.append(digits(x[0])).append(", ").append(digits(x[1])).append(", ").append(digits(x[2])).append(")");
}

void report_contradiction(const Enclosure& a, const Enclosure& b, const std::string& what) {
  throw Error(ErrorKind::failure, "two proofs contradict each other: " + what + " lies in " + text_of(a) + " and in " +
                                      text_of(b) + "; one of them is wrong, please report it");
}

}  // namespace verisq::verify
