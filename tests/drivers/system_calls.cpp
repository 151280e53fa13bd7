#include "tests/drivers/system_calls.h"

#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

namespace hapticd::test {

SystemCalls& system_calls() noexcept {
  thread_local SystemCalls calls;
  return calls;
}

}  // namespace hapticd::test

extern "C" int sendmmsg(int fd, mmsghdr* messages, unsigned count, int flags) {
  auto& calls = hapticd::test::system_calls();
  ++calls.sends;
  if (calls.queue_full) {
    errno = ENOBUFS;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_sendmmsg, fd, messages, count, flags));
}

extern "C" int recvmmsg(int fd, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  ++hapticd::test::system_calls().receives;
  return static_cast<int>(::syscall(SYS_recvmmsg, fd, messages, count, flags, timeout));
}
