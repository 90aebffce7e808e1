/// The exit status of every command: what a script may rely on.
#pragma once

namespace verisq::command_line {

enum class ExitStatus {
  verified = 0,       ///< map: every enclosure is at most the tolerance wide; check: every enclosure is proved
  failed = 1,         ///< the program, a device or the file system failed
  bad_input = 2,      ///< bad usage or input
  unverified = 3,     ///< finished; map: some enclosures are valid but wide; check: some are not proved; octree: ended
                      ///< by its budget; fit: or points are proven deeper inside than the limit;
                      ///< surface: it is not closed, manifold and oriented
  interrupted = 130,  ///< ended early by Ctrl-C: 128 + SIGINT, as shells report it; the program says 143 (SIGTERM) or
                      ///< 129 (SIGHUP) instead where those ended it
};

}  // namespace verisq::command_line
