/// The signal handler.
#include "host/command_line/interruption.hpp"

#include <atomic>
#include <csignal>

namespace verisq::command_line {
namespace {

// A signal handler reaches nothing but static storage. Lock-free, hence safe in a handler on any thread.
std::atomic<bool> sigint_received{false};
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void watch_for_interruption() {
  struct sigaction action = {};
  action.sa_handler = [](int) { sigint_received = true; };
  // SA_RESTART: reads and writes go on as if nothing happened. SA_RESETHAND: the second signal kills.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() {
  return sigint_received;
}

}  // namespace verisq::command_line
