#include "pipeline/interrupt.hpp"

#include <csignal>

namespace deforma {

namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t interrupt_requested = 0;

void remember(int) { interrupt_requested = 1; }

void install(void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
}

}  // namespace

InterruptWatch::InterruptWatch() {
  interrupt_requested = 0;
  install(remember, static_cast<int>(SA_RESETHAND | SA_RESTART));
}

InterruptWatch::~InterruptWatch() { install(SIG_DFL, 0); }

bool InterruptWatch::requested() const { return interrupt_requested != 0; }

}  // namespace deforma
