/// Reads test vectors of interval arithmetic: the ITL files of the interval test framework ITF1788.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace verisq::testing {

/// An operand or a result as it is written.
struct Literal {
  enum class Kind {
    interval,         ///< also the empty one
    not_an_interval,  ///< [nai]
    number,
    other  ///< a truth value, a decoration, a relation, a text in quotes or a list in braces
  };
  Kind kind;
  double lower, upper;  ///< of intervals and, both, of numbers; NaN for the empty interval. Rounded to nearest
  bool decorated;

  [[nodiscard]] bool is_empty() const;
};

/// One line of a test case: `operation operand... = result... [signal name];`
struct IntervalVector {
  std::string place;  ///< file and line
  std::string operation;
  std::vector<Literal> operands;
  std::vector<Literal> results;
};

/// In the order of the file. Throws std::runtime_error with file and line for what is not ITL.
[[nodiscard]] std::vector<IntervalVector> read_interval_vectors(const std::filesystem::path& file);

}  // namespace verisq::testing
