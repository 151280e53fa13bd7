#include "drivers/usb/runner.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <time.h>

#include <thread>
#include <utility>

namespace hapticd::usb {
namespace {

class Thread final : public Runner {
 public:
  explicit Thread(int priority) : priority_(priority) {}
  ~Thread() override { join(); }

  void start(std::function<void()> body) override {
    thread_ = std::thread([this, body = std::move(body)] {
      sigset_t all;
      sigfillset(&all);
      ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
      // Who may not is told so by the servo thread, which asks for more.
      const sched_param wanted{.sched_priority = priority_};
      (void)::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted);
      body();
    });
  }
  void join() override {
    if (thread_.joinable()) thread_.join();
  }
  void pause(std::int64_t duration_ns) override {
    const timespec time{.tv_sec = static_cast<time_t>(duration_ns / 1'000'000'000),
                        .tv_nsec = static_cast<long>(duration_ns % 1'000'000'000)};
    ::nanosleep(&time, nullptr);
  }

 private:
  const int priority_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Runner> thread_runner(int priority) {
  return std::make_unique<Thread>(priority);
}

}  // namespace hapticd::usb
