/// Runs a program and captures what it says: for tests of the command line.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace verisq::testing {

struct Outcome {
  int status;  ///< exit status; 128 + the signal when one killed the program, as shells report it
  std::string out;
  std::string err;
};

inline std::string contents(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A started program, its output going to files in `folder`; `wait` must be called.
class Process {
 public:
  /// `arguments[0]` is the path of the program.
  Process(std::vector<std::string> arguments, const std::filesystem::path& folder)
      : out_(folder / "process.out"), err_(folder / "process.err") {
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    // A test in the background of a shell has SIGINT ignored, and would hand that on.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int fresh = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(), fresh, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_.c_str(), fresh, 0600);
    const int error = posix_spawn(&id_, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error("cannot start " + arguments[0]);
  }

  /// Waits until the program catches SIGINT, or has ended: a signal before that would kill it.
  void wait_until_interruptible() const {
    while (!catches_interrupts()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  void interrupt() const { send(SIGINT); }
  void send(int signal) const { kill(id_, signal); }

  [[nodiscard]] Outcome wait() const {
    int status = 0;
    waitpid(id_, &status, 0);
    return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), contents(out_), contents(err_)};
  }

 private:
  /// As the kernel says in hexadecimal, one bit a signal; true when the process has ended.
  [[nodiscard]] bool catches_interrupts() const {
    std::ifstream status("/proc/" + std::to_string(id_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("State:") && line.find('Z') != std::string::npos) return true;
      if (!line.starts_with("SigCgt:")) continue;
      return (std::stoull(line.substr(line.find(':') + 1), nullptr, 16) >> (SIGINT - 1U) & 1U) != 0;
    }
    return true;
  }

  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t id_ = 0;
};

}  // namespace verisq::testing
