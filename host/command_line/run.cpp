/// This file implements run.hpp.
#include "host/command_line/run.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/version.hpp>

#include "host/command_line/options.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

int status_of(ExitStatus status) {
  return status == ExitStatus::interrupted ? status_of_interruption() : static_cast<int>(status);
}

/// `parse_and_run` returns nothing if --help or --version was the whole request.
int answer(const std::string& name, const std::function<std::optional<ExitStatus>()>& parse_and_run) {
  const auto report = [&](std::string_view message, ExitStatus status) {
    fmt::print(stderr, "{}: {}\n", name, on_one_line(as_typed(message)));
    return static_cast<int>(status);
  };
  try {
    const std::optional<ExitStatus> status = parse_and_run();
    if (std::fflush(stdout) != 0) return report("cannot write to the standard output", ExitStatus::failed);
    return status ? status_of(*status) : 0;
  } catch (const Error& error) {
    return report(error.what(), error.kind() == ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
  } catch (const std::bad_alloc&) {
    return report("out of memory", ExitStatus::failed);
  } catch (const std::exception& error) {
    return report(error.what(), ExitStatus::failed);
  }
}

void refuse_unless_known(const std::string& command, std::span<const Command> commands) {
  std::vector<std::string> names;
  for (const Command& known : commands) names.push_back(known.name);
  if (std::ranges::find(names, command) != names.end()) return;
  const std::optional<std::string> near = nearest_word(command, names);
  refuse(fmt::format("help: there is no command {}{}", command, near ? "; did you mean " + *near + "?" : ""));
}

/// Replaces `help` and `help COMMAND` by `--help` and `COMMAND --help`.
std::vector<char*> without_help(std::vector<char*> words, std::span<const Command> commands, std::string& help_option) {
  if (words.size() < 2 || words[1] != std::string_view("help")) return words;
  if (words.size() > 3) refuse("help: name one command");
  if (words.size() == 3 && !std::string_view(words[2]).starts_with("-")) refuse_unless_known(words[2], commands);
  words.erase(words.begin() + 1);
  words.push_back(help_option.data());
  return words;
}

}  // namespace

int run_program(const Program& program, std::span<const Command> commands, int argc, char** argv) {
  return answer(program.name, [&]() -> std::optional<ExitStatus> {
    Options options(program.name, program.description, VERISQ_VERSION);
    options.explain(program.closing_words);
    std::vector<std::pair<Options, Action>> declared;
    for (const auto& [name, description, declare] : commands) {
      Options of_command = options.command(name, description);
      Action run = declare(of_command);
      declared.emplace_back(std::move(of_command), std::move(run));
    }
    // Only for the list of commands: it never runs.
    static_cast<void>(options.command("help", "Explain a command: help COMMAND"));
    std::string help_option = "--help";
    std::vector<char*> words = without_help({argv, argv + argc}, commands, help_option);
    if (!options.parse(static_cast<int>(words.size()), words.data())) return std::nullopt;
    const auto given = [](const auto& command) { return command.first.given(); };
    const auto asked = std::ranges::find_if(declared, given);
    if (asked == declared.end()) refuse(fmt::format("give a command (see {} --help)", program.name));
    const auto other = std::find_if(asked + 1, declared.end(), given);
    if (other != declared.end())
      refuse(fmt::format("give one command, not both {} and {}", asked->first.name(), other->first.name()));
    return asked->second();
  });
}

int run_program(const Program& program, const Command& command, int argc, char** argv) {
  return answer(program.name, [&]() -> std::optional<ExitStatus> {
    Options options(program.name, program.description, VERISQ_VERSION);
    const Action run = command.declare(options);
    if (!options.parse(argc, argv)) return std::nullopt;
    return run();
  });
}

namespace {

// A signal handler reaches nothing but static storage. Lock-free, hence safe in a handler on any thread.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): for that reason
std::atomic<int> first_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

void note(int signal) {
  int none = 0;
  first_signal.compare_exchange_strong(none, signal);
}

void watch(int signal, int flags) {
  struct sigaction action = {};
  sigaction(signal, nullptr, &action);
  if (action.sa_handler == SIG_IGN) return;
  action = {};
  action.sa_handler = note;
  action.sa_flags = flags;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void watch_for_interruption() {
  // SA_RESTART: reads and writes continue as if nothing happened. SA_RESETHAND: the second signal kills. This is not
  // set for signals that may come twice without a user's impatience: `timeout` sends SIGTERM, a closed terminal SIGHUP.
  watch(SIGTERM, SA_RESTART);
  watch(SIGHUP, SA_RESTART);
  watch(SIGINT, static_cast<int>(SA_RESTART | SA_RESETHAND));
}

bool interrupted() {
  return first_signal != 0;
}

int status_of_interruption() {
  const int signal = first_signal;
  return signal == 0 ? static_cast<int>(ExitStatus::interrupted) : 128 + signal;
}

double parse_time_limit(std::string_view option, const std::string& text) {
  const std::optional<double> seconds = finite_number(text);
  if (!seconds || !(*seconds > 0.0)) {
    refuse(fmt::format("{}: {} is not a finite number of seconds above 0", option, text));
  }
  return *seconds;
}

void add_time_limit(Options& options, std::optional<double>& seconds, std::string_view kept) {
  options.add("--time-limit", seconds, parse_time_limit, "SECONDS",
              fmt::format("Ends the work after so long, as Ctrl-C does, with status 3: {}", kept));
}

ExitStatus status_of_end() {
  return interrupted() ? ExitStatus::interrupted : ExitStatus::unverified;
}

std::string_view reason_of_end() {
  return interrupted() ? "interrupted" : "the time limit is reached";
}

std::string mark_of_end(bool ended_early) {
  return ended_early ? fmt::format(" ({})", reason_of_end()) : "";
}

std::string as_typed(std::string_view message) {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz_";
  std::string result;
  std::size_t from = 0;
  while (true) {
    const std::size_t begin = message.find('`', from);
    const std::size_t end = begin == std::string_view::npos ? begin : message.find('`', begin + 1);
    if (end == std::string_view::npos) return result.append(message.substr(from));
    const std::string_view name = message.substr(begin + 1, end - begin - 1);
    const bool begins_word = begin == 0 || message[begin - 1] == ' ';  // a file may be called a`b`c
    const bool is_name = begins_word && !name.empty() && name.find_first_not_of(letters) == std::string_view::npos;
    result.append(message.substr(from, (is_name ? begin : end + 1) - from));
    if (is_name) {
      result.append("--");
      std::ranges::replace_copy(name, std::back_inserter(result), '_', '-');
    }
    from = end + 1;
  }
}

void tell(std::string_view message) {
  fmt::print(stderr, "verisq: {}\n", on_one_line(as_typed(message)));
}

void tell_notice(const std::string& notice) {
  if (!notice.empty()) tell(notice);
}

namespace {

constexpr int bar_cells = 30;
constexpr auto redraw_interval = std::chrono::milliseconds(100);

/// "2:05" or "1:02:05"; "-:--" before there is anything to extrapolate.
std::string clock_text(double seconds) {
  if (!(seconds < 1e7)) return "-:--";
  const auto whole = static_cast<int>(std::ceil(seconds));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

std::string with_prefix(double number) {
  if (number >= 1e9) return fmt::format("{:.3g}G", number / 1e9);
  if (number >= 1e6) return fmt::format("{:.3g}M", number / 1e6);
  if (number >= 1e3) return fmt::format("{:.3g}k", number / 1e3);
  return fmt::format("{:.3g}", number);
}

ProgressBar::ProgressBar(bool wanted, std::string_view elements)
    : shown_(wanted && isatty(STDERR_FILENO) != 0), elements_(elements) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::update(std::uint64_t done, double fraction) {
  if (!due()) return;
  draw(fmt::format("{} {}/s", with_prefix(static_cast<double>(done) / elapsed()), elements_), fraction);
}

void ProgressBar::update_state(std::string_view state, double fraction) {
  if (due()) draw(state, fraction);
}

void ProgressBar::draw(std::string_view state, double fraction) {
  const double part = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<int>(part * bar_cells);
  fmt::print(stderr, "\r\x1b[K[{:=<{}}{: <{}}] {:3.0f} %  {}  ETA {}", "", filled, "", bar_cells - filled, 100.0 * part,
             on_one_line(state), clock_text(elapsed() * (1.0 - part) / part));
  std::fflush(stderr);
  drawn_ = true;
  next_draw_ = Clock::now() + redraw_interval;
}

}  // namespace verisq::command_line
