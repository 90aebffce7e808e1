/// fork, exec, waitpid.
#include "host/command_line/batch_process.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstring>
#include <verisq/error.hpp>

namespace verisq::command_line {
namespace {

constexpr int not_started = 127;  // as shells have it

/// Between fork and exec nothing but what signal handlers may call.
[[noreturn]] void become(const char* program, char* const* argv, const char* folder, const char* out, const char* err,
                         pid_t parent) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
  if (getppid() != parent) _exit(not_started);  // it has ended before that was said
  constexpr mode_t permissions = 0666;
  const int in = open("/dev/null", O_RDONLY);
  const int to_out = open(out, O_WRONLY | O_CREAT | O_TRUNC, permissions);
  const int to_err = open(err, O_WRONLY | O_CREAT | O_TRUNC, permissions);
  if (in < 0 || to_out < 0 || to_err < 0 || chdir(folder) != 0) _exit(not_started);
  if (dup2(in, STDIN_FILENO) < 0 || dup2(to_out, STDOUT_FILENO) < 0 || dup2(to_err, STDERR_FILENO) < 0) {
    _exit(not_started);
  }
  execv(program, argv);
  _exit(not_started);
}

pid_t started(const std::filesystem::path& program, const std::vector<std::string>& arguments,
              const std::filesystem::path& folder, const std::filesystem::path& out, const std::filesystem::path& err) {
  std::vector<std::string> words{"verisq"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string in_folder = folder.string();
  const pid_t parent = getpid();
  const pid_t id = fork();
  if (id == 0) become(program.c_str(), argv.data(), in_folder.c_str(), out.c_str(), err.c_str(), parent);
  if (id < 0) throw Error(ErrorKind::failure, fmt::format("cannot start a process: {}", std::strerror(errno)));
  return id;
}

}  // namespace

BatchProcess::BatchProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::filesystem::path& folder, const std::filesystem::path& out,
                           const std::filesystem::path& err)
    : id_(started(program, arguments, folder, out, err)) {}

std::optional<int> BatchProcess::status() const {
  int status = 0;
  const pid_t ended = waitpid(id_, &status, WNOHANG);
  if (ended == 0) return std::nullopt;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

void BatchProcess::end() const {
  kill(id_, SIGTERM);
}

}  // namespace verisq::command_line
