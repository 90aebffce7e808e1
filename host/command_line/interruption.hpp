/// Ctrl-C as a question that the map asks between chunks, so that finished rows are not lost.
#pragma once

namespace verisq::command_line {

/// From here on the first SIGINT only sets the answer of `interrupted`; the second one kills, as usual.
void watch_for_interruption();
[[nodiscard]] bool interrupted();

}  // namespace verisq::command_line
