#include "daemon/signals.h"

#include <pthread.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <initializer_list>

#include "control/core/fault.h"

namespace hapticd::daemon {
namespace {

// Handlers can be given nothing but globals. Lock-free atomics are all that they touch.
std::atomic<std::atomic<std::uint8_t>*> cpu_time_target{nullptr};
std::atomic<std::atomic<bool>*> hurry_target{nullptr};
std::atomic<bool> hurried{false};
static_assert(std::atomic<std::uint8_t>::is_always_lock_free &&
              std::atomic<void*>::is_always_lock_free);

extern "C" void on_cpu_time(int) {
  if (auto* target = cpu_time_target.load(std::memory_order_acquire)) {
    target->store(static_cast<std::uint8_t>(Fault::cpu_time), std::memory_order_release);
  }
}

extern "C" void on_hurry(int) {
  if (hurried.exchange(true)) ::_exit(static_cast<int>(ExitCode::no));
  if (auto* target = hurry_target.load(std::memory_order_acquire)) target->store(true);
}

sigset_t set_of(std::initializer_list<int> signals) {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int signal : signals) ::sigaddset(&set, signal);
  return set;
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

}  // namespace

Result<Signals> Signals::block() {
  ::signal(SIGPIPE, SIG_IGN);
  const sigset_t read = set_of({SIGINT, SIGTERM, SIGHUP, SIGUSR1});
  const sigset_t blocked = set_of({SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGXCPU});
  ::pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
  Signals signals;
  signals.fd_ = FileDescriptor(::signalfd(-1, &read, SFD_CLOEXEC | SFD_NONBLOCK));
  if (!signals.fd_.valid()) {
    return fail(ExitCode::software, std::string("signalfd: ") + std::strerror(errno));
  }
  return signals;
}

std::optional<int> Signals::next() const {
  signalfd_siginfo info{};
  if (::read(fd_.get(), &info, sizeof(info)) != sizeof(info)) return std::nullopt;
  return static_cast<int>(info.ssi_signo);
}

void Signals::cpu_time_fault_to(std::atomic<std::uint8_t>* host_fault) {
  cpu_time_target.store(host_fault, std::memory_order_release);
  handle(SIGXCPU, on_cpu_time);
  const sigset_t cpu_time = set_of({SIGXCPU});
  ::pthread_sigmask(SIG_UNBLOCK, &cpu_time, nullptr);
}

void Signals::hurry_by(std::atomic<bool>* estop) {
  hurry_target.store(estop, std::memory_order_release);
  handle(SIGINT, on_hurry);
  handle(SIGTERM, on_hurry);
  const sigset_t ends = set_of({SIGINT, SIGTERM});
  ::pthread_sigmask(SIG_UNBLOCK, &ends, nullptr);
}

}  // namespace hapticd::daemon
