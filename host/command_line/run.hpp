/// Programs and their commands as they run: the table, exit status, interruption, time limits, messages, progress.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "host/command_line/options.hpp"
#include "verisq/device.hpp"

namespace verisq::command_line {

// The exit status of every command: scripts may rely on it.

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

// A command of a program, as a row of its table.

/// Runs a command whose options are parsed.
using Action = std::function<ExitStatus()>;

struct Command {
  std::string name;
  std::string description;  ///< one line
  /// Declares the options, whose values live in the action that it returns.
  std::function<Action(Options&)> declare;
};

/// `declare` binds the options to fields of `Arguments`, which `run` reads.
template <class Arguments>
[[nodiscard]] Command command(const std::string& name, const std::string& description,
                              void (*declare)(Options&, Arguments&), ExitStatus (*run)(const Arguments&)) {
  return {name, description, [declare, run](Options& options) -> Action {
            const auto arguments = std::make_shared<Arguments>();
            declare(options, *arguments);
            return [arguments, run] { return run(*arguments); };
          }};
}

// The commands of `verisq`, a function each, which makes the row of the table.

[[nodiscard]] Command batch_command();
[[nodiscard]] Command check_command();
[[nodiscard]] Command deviation_command();
[[nodiscard]] Command distance_command();
[[nodiscard]] Command features_command();
[[nodiscard]] Command fit_command();
[[nodiscard]] Command insert_command();
[[nodiscard]] Command map_command();
[[nodiscard]] Command merge_command();
[[nodiscard]] Command mesh_command();
[[nodiscard]] Command octree_command();
[[nodiscard]] Command path_command();
[[nodiscard]] Command recover_command();
[[nodiscard]] Command stance_command();

inline constexpr const char* surface_description =
    "Closed oriented surface from points, a damaged mesh or a labelled volume; canals";

/// The name by which `verisq surface` starts `verisq-surface`, which then answers as that command.
inline constexpr const char* name_of_caller = "verisq";

// The common frame of every program: the command line is parsed, errors become one line and an exit status.

/// The description of a program.
struct Program {
  std::string name;
  std::string description;
  std::string closing_words = {};  ///< at the end of its help
};

/// Parses, then runs the requested command; returns the exit status. An error is one line on the standard error that
/// begins with the program's name.
[[nodiscard]] int run_program(const Program& program, std::span<const Command> commands, int argc, char** argv);

/// A program that is one command, whose name and description are those of the program.
[[nodiscard]] int run_program(const Program& program, const Command& command, int argc, char** argv);

// Signals that ask a program to end (Ctrl-C, `kill`, a closed terminal). The work polls for them between its steps, so
// that finished results are not lost.

/// From here on SIGINT, SIGTERM and SIGHUP only set the answer of `interrupted`; a second SIGINT kills, as usual. An
/// ignored signal stays ignored: `nohup` relies on that.
void watch_for_interruption();
[[nodiscard]] bool interrupted();

/// 128 + the first signal that came, as shells report it; without one, the status for Ctrl-C.
[[nodiscard]] int status_of_interruption();

// --time-limit: how long a command may work, and its messages if the limit, or a signal, ended it.

/// Seconds. Throws Error(input) that begins with `option` unless it is a finite number above 0.
[[nodiscard]] double parse_time_limit(std::string_view option, const std::string& text);

/// Adds --time-limit, which ends the command like Ctrl-C; `kept` describes what is kept.
void add_time_limit(Options& options, std::optional<double>& seconds, std::string_view kept);

// Work ended early: by a signal if one came, else by the time limit.

[[nodiscard]] ExitStatus status_of_end();
/// "interrupted".
[[nodiscard]] std::string_view reason_of_end();
/// The same behind a word, in brackets; empty unless `ended_early`.
[[nodiscard]] std::string mark_of_end(bool ended_early);

// The messages of a running command on the standard error.

/// A message of the library, which names parameters as in C++ and Python, `any_side`, with the names of options
/// instead, --any-side. Other texts between backticks, such as a command and its options, stay unchanged.
[[nodiscard]] std::string as_typed(std::string_view message);

/// Prints one line, as typed.
void tell(std::string_view message);

/// The reason why another device, or none, did the work; empty: prints nothing.
void tell_notice(const std::string& notice);

// A bar with rate and remaining time on a terminal's standard error; nothing at all elsewhere.

/// "13.2M", "850k", "12": three significant digits with an SI prefix.
[[nodiscard]] std::string with_prefix(double number);

/// Redraws one line at most ten times a second; the destructor clears it.
class ProgressBar {
 public:
  /// A bar of `elements`, in the plural, which must be a literal. If `wanted` is false, or the standard error is no
  /// terminal, every call does nothing.
  ProgressBar(bool wanted, std::string_view elements);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done` elements so far; `fraction` of the whole in [0, 1].
  void update(std::uint64_t done, double fraction);
  /// Shows `state` in place of a rate.
  void update_state(std::string_view state, double fraction);

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool due() const { return shown_ && Clock::now() >= next_draw_; }
  [[nodiscard]] double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  void draw(std::string_view state, double fraction);

  bool shown_;
  std::string_view elements_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_draw_ = start_;
};

// Wall time since a moment.

/// Starts when it is made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point start_ = Clock::now();
};

}  // namespace verisq::command_line
