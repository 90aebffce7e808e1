/// What `verisq check --certificate` of a fit says of the sides on which the implant's parts lie.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/checker.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/json_value.hpp"

namespace verisq::command_line {

struct SideCheckReport {
  std::vector<Verdict> verdicts = {};   ///< one a claim; none of an interrupted check
  std::vector<std::string> names = {};  ///< of all primitives
  std::size_t rims = 0;                 ///< over which the mesh was closed
  std::optional<bool> outward = {};     ///< its normals point there
  bool interrupted = false;

  [[nodiscard]] bool all_proved() const;
};

/// Reads model and mesh where something is claimed. Throws Error(input).
[[nodiscard]] SideCheckReport checked_sides(const FitAnswer& answer, const CheckArguments& arguments);

/// A line a claim, and one of the primitives of which nothing is claimed.
[[nodiscard]] std::string sides_in_words(const FitAnswer& answer, const SideCheckReport& report);
[[nodiscard]] JsonValue sides_of(const FitAnswer& answer, const SideCheckReport& report);

}  // namespace verisq::command_line
