#include "app/interrupt.h"

#include <csignal>

namespace sonoband {

namespace {

// A signal handler can reach nothing but this.
volatile std::sig_atomic_t noted = 0;

void note(int signal) {
  noted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Interruptible::Interruptible() {
  noted = 0;
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

Interruptible::~Interruptible() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool Interruptible::asked_to_stop() const {
  return noted != 0;
}

}  // namespace sonoband
