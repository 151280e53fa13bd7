// step() calls neither the heap nor the kernel, shown by two traps that do close: each has a test
// that it catches.
#include <gtest/gtest.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "tests/support/full_program.h"
#include "tests/support/heap_guard.h"

namespace hapticd::control {
namespace {

/// Every path of the tick: rest, contact, limits, missed samples, a fault and back.
void eventful_run(test::Rig& rig) {
  for (Aux& aux : rig.aux) aux.digital = 1;
  for (AxisSample& sample : rig.samples) sample.homed = true;
  rig.enable_at(-0.002);
  for (int i = 0; i < 200; ++i) rig.at(-0.02 + 1e-4 * i);
  rig.samples[0].freshness = Freshness::missing;
  for (int i = 0; i < 5; ++i) rig.run();
  rig.input.clear_fault = true;
  rig.at(0);
  rig.samples[0].raw = 0.0 / 0.0;
  rig.again();
  rig.input.missed_ticks = 3;
  rig.at(0.001);
}

build::ProgramSpec busy_spec() {
  auto spec = test::full_spec();
  spec.planes.push_back(test::wall(1e6, 0, 3));
  spec.stuck_watches = {{.axis = 0, .ticks = 2, .min_effort = 0.1}};
  return spec;
}

/// What becomes of a child that may only read, write and exit while it runs `body`.
int status_under_seccomp(const std::function<void()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT);
    body();
    syscall(SYS_exit, 0);  // strict mode knows no exit_group
  }
  int status = -1;
  waitpid(child, &status, 0);
  return status;
}

TEST(StepRealTime, MakesNoSystemCall) {
#ifdef HAPTICD_SANITIZED
  GTEST_SKIP() << "sanitizers make system calls of their own";
#endif
  test::Rig rig(busy_spec());
  const int status = status_under_seccomp([&] { eventful_run(rig); });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
      << "killed by the trap: status " << status;
}

TEST(StepRealTime, SystemCallTrapCloses) {
#ifdef HAPTICD_SANITIZED
  GTEST_SKIP() << "sanitizers make system calls of their own";
#endif
  const int status = status_under_seccomp([] { syscall(SYS_getpid); });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

TEST(StepRealTime, MakesNoHeapCall) {  // that the guard catches one: heap_guard_test.cpp
  if (!test::HeapGuard::available())
    GTEST_SKIP() << "the heap is the sanitizer's: nothing can be counted";
  test::Rig rig(busy_spec());
  const test::HeapGuard guard;
  eventful_run(rig);
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace hapticd::control
