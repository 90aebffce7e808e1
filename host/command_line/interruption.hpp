/// Signals that ask a program to end (Ctrl-C, `kill`, a closed terminal) as a question that the work asks between its
/// steps, so that what is finished is not lost.
#pragma once

namespace verisq::command_line {

/// From here on SIGINT, SIGTERM and SIGHUP only set the answer of `interrupted`; a second SIGINT kills, as usual. A
/// signal that is ignored stays so: `nohup` means it.
void watch_for_interruption();
[[nodiscard]] bool interrupted();

/// 128 + the first signal that came, as shells report it; without one that of Ctrl-C.
[[nodiscard]] int status_of_interruption();

}  // namespace verisq::command_line
