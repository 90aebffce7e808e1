/// What the user can correct ends a command in one line.
#pragma once

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

using verisq::refuse;

}  // namespace verisq::command_line
