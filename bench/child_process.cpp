/// Starts a program with posix_spawn, reads its output through a pipe and asks wait4 for its use of memory.
#include "bench/child_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>

namespace verisq::bench {
namespace {

struct Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("cannot make a pipe");
  }
  ~Pipe() {
    close(ends[0]);
    close_writing_end();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void close_writing_end() {
    if (ends[1] >= 0) close(ends[1]);
    ends[1] = -1;
  }

  std::array<int, 2> ends{};
};

// The words are a copy, because posix_spawn takes what it might change.
pid_t start(std::vector<std::string> command, int pipe, Captured captured) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe, STDOUT_FILENO);
  if (captured == Captured::output_and_errors) posix_spawn_file_actions_adddup2(&actions, pipe, STDERR_FILENO);
  pid_t child = 0;
  const int failed = posix_spawn(&child, arguments.front(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start " + command.front());
  return child;
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t got = 0; (got = read(descriptor, block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<std::size_t>(got));
  return text;
}

}  // namespace

ChildReport run_child(const std::vector<std::string>& command, Captured captured) {
  Pipe pipe;
  const auto begin = std::chrono::steady_clock::now();
  const pid_t child = start(command, pipe.ends[1], captured);
  pipe.close_writing_end();
  std::string output = read_all(pipe.ends[0]);
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || !WIFEXITED(status))
    throw std::runtime_error(command.front() + " did not end by itself");
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-union-access): glibc's way to keep the size of the number
  const auto peak_kibibytes = static_cast<double>(usage.ru_maxrss);
  return {WEXITSTATUS(status), elapsed.count(), 1024.0 * peak_kibibytes, std::move(output)};
}

}  // namespace verisq::bench
