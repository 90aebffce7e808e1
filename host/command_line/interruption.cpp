/// The signal handler.
#include "host/command_line/interruption.hpp"

#include <atomic>
#include <csignal>

#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {
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
  // SA_RESTART: reads and writes go on as if nothing happened. SA_RESETHAND: the second signal kills; not so for those
  // that come twice without anybody's impatience, as `timeout` sends SIGTERM and a closed terminal SIGHUP.
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

}  // namespace verisq::command_line
