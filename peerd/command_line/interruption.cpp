#include "peerd/command_line/interruption.hpp"

namespace peerd {
namespace {

// A signal's handler reaches nothing but globals.
volatile std::sig_atomic_t interruption_requested = 0;

void on_interruption(int) { interruption_requested = 1; }

}  // namespace

Interruption::Interruption() {
  interruption_requested = 0;
  sigaction(SIGINT, nullptr, &before_);
  if (before_.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = on_interruption;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

Interruption::~Interruption() { sigaction(SIGINT, &before_, nullptr); }

bool Interruption::requested() const { return interruption_requested != 0; }

}  // namespace peerd
