#include "peerd/input/console/stop_signals.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <csignal>
#include <cstring>

#include <unistd.h>

namespace peerd {
namespace {

constexpr std::array kStopSignals{SIGINT, SIGTERM};

// What the handler reads. A handler may only touch lock-free atomics and call write() and _exit(); the line is written
// while the handler's signals are blocked.
std::atomic<bool> signals_are_noted{false};
std::atomic<int> noted_signal{0};
std::array<char, 256> last_line;
std::size_t last_line_size = 0;
std::array<struct sigaction, kStopSignals.size()> former_actions;
bool in_use = false;

static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

void on_stop_signal(int signal) {
  int none = 0;
  if (signals_are_noted && noted_signal.compare_exchange_strong(none, signal)) return;
  (void)!write(STDERR_FILENO, last_line.data(), last_line_size);
  _exit(128 + signal);
}

sigset_t stop_signal_set() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kStopSignals) sigaddset(&set, signal);
  return set;
}

void set_line(const std::string& text) {
  const std::string line = "\n" + text + "\n";  // a line of progress may stand before it
  last_line_size = std::min(line.size(), last_line.size());
  std::memcpy(last_line.data(), line.data(), last_line_size);
}

}  // namespace

StopSignals::StopSignals(const std::string& at_once) {
  assert(!in_use);
  in_use = true;
  signals_are_noted = false;
  noted_signal = 0;
  set_line(at_once);
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  action.sa_mask = stop_signal_set();
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kStopSignals.size(); ++i) {
    sigaction(kStopSignals[i], nullptr, &former_actions[i]);
    if (former_actions[i].sa_handler != SIG_IGN) sigaction(kStopSignals[i], &action, nullptr);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t i = 0; i < kStopSignals.size(); ++i) sigaction(kStopSignals[i], &former_actions[i], nullptr);
  in_use = false;
}

void StopSignals::note_from_now_on(const std::string& at_once) {
  const sigset_t blocked = stop_signal_set();
  sigset_t former;
  pthread_sigmask(SIG_BLOCK, &blocked, &former);
  set_line(at_once);
  signals_are_noted = true;
  pthread_sigmask(SIG_SETMASK, &former, nullptr);
}

int StopSignals::signal() const { return noted_signal; }
std::string StopSignals::signal_name() const { return signal() == SIGTERM ? "SIGTERM" : "SIGINT"; }
int StopSignals::exit_code() const { return 128 + signal(); }

}  // namespace peerd
