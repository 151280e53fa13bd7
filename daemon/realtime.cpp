#include "daemon/realtime.h"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace hapticd::daemon {
namespace {

std::string words(int error) {
  return std::strerror(error);
}

void lock_memory(RealtimeReport& report) {
  // The heap neither gives memory back nor maps big blocks apart: what was touched once stays
  // resident.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    report.memory_locked = true;
    return;
  }
  report.missing.push_back(
      {"locked memory (mlockall)", words(errno),
       "LimitMEMLOCK=infinity in the unit, or `ulimit -l unlimited` in the shell"});
}

int hold_dma_latency(RealtimeReport& report) {
  const char* path = "/dev/cpu_dma_latency";
  const int fd = open(path, O_WRONLY | O_CLOEXEC);
  const std::int32_t none_us = 0;
  if (fd >= 0 && write(fd, &none_us, sizeof none_us) == sizeof none_us) {
    report.dma_latency_held = true;
    return fd;
  }
  report.missing.push_back(
      {"shallow CPU sleep (/dev/cpu_dma_latency)", words(errno),
       "install the udev rule of hapticd and run as a member of group hapticd, or run as root"});
  if (fd >= 0) close(fd);
  return -1;
}

void schedule_fifo(int priority, RealtimeReport& report) {
  const sched_param wanted{.sched_priority = priority};
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
  if (error == 0) {
    report.scheduling = "SCHED_FIFO " + std::to_string(priority);
    return;
  }
  report.missing.push_back({"SCHED_FIFO priority " + std::to_string(priority), words(error),
                            "LimitRTPRIO=95 in the unit, or `ulimit -r 95` in the shell (as root: "
                            "`prlimit --rtprio=95`)"});
}

void pin(int cpu, RealtimeReport& report) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  if (error == 0) {
    report.cpu = cpu;
    return;
  }
  report.missing.push_back({"CPU " + std::to_string(cpu) + " (loop.cpu)", words(error),
                            "name a CPU that exists and that the unit's CPUAffinity allows"});
}

/// Touches the stack that the loop will use, so that no page of it faults later.
void prefault_stack() {
  constexpr std::size_t kBytes = 256 * 1024;
  constexpr std::size_t kPage = 4096;
  volatile char stack[kBytes];
  for (std::size_t i = 0; i < kBytes; i += kPage) stack[i] = 0;
  static_cast<void>(stack[0]);  // a read, so that the writes count as used
}

}  // namespace

ProcessRealtime::ProcessRealtime(RealtimeReport& report) {
  lock_memory(report);
  dma_latency_fd_ = hold_dma_latency(report);
}

ProcessRealtime::~ProcessRealtime() {
  if (dma_latency_fd_ >= 0) close(dma_latency_fd_);
}

void enter_realtime(int priority, std::optional<int> cpu, RealtimeReport& report) {
  prefault_stack();
  if (cpu) pin(*cpu, report);
  schedule_fifo(priority, report);
}

bool kernel_is_preempt_rt() {
  std::ifstream file("/sys/kernel/realtime");
  int value = 0;
  return (file >> value) && value == 1;
}

std::string kernel_description() {
  utsname name{};
  uname(&name);
  return std::string(name.release) + " " + name.machine +
         (kernel_is_preempt_rt() ? ", PREEMPT_RT" : ", not PREEMPT_RT");
}

}  // namespace hapticd::daemon
