/// `verisq check --map`: every row of a map proved again.
#pragma once

#include <cstdint>
#include <functional>
#include <verisq/map_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/check_summary.hpp"

namespace verisq::command_line {

/// Told of each row what is proven of it, by one thread at a time, in any order.
using Proven = std::function<void(std::uint64_t row, const Enclosure& proven)>;

/// `map` is `arguments.map`. Throws Error(input) for what the user can correct.
[[nodiscard]] CheckReport checked_map(const CheckArguments& arguments, MapReader& map, const Proven& proven);

}  // namespace verisq::command_line
