#include "pipeline/interrupt.hpp"

#include <csignal>

namespace deforma {

namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t received = 0;

void remember(int signal) { received = signal; }

void install(void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  for (int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptWatch::InterruptWatch() {
  received = 0;
  install(remember, static_cast<int>(SA_RESETHAND | SA_RESTART));
}

InterruptWatch::~InterruptWatch() { install(SIG_DFL, 0); }

int InterruptWatch::signal() const { return received; }

}  // namespace deforma
