#include "daemon/interrupts.h"

#include <signal.h>

namespace hapticd::daemon {
namespace {

std::atomic<bool> interrupted{false};
extern "C" void on_interrupt(int) {
  interrupted.store(true);
}

bool install() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  return true;
}

}  // namespace

const std::atomic<bool>& interrupts() {
  static const bool installed = install();
  static_cast<void>(installed);
  return interrupted;
}

}  // namespace hapticd::daemon
