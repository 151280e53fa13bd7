// libc's sendmmsg and recvmmsg, in place of which this binary has its own: they count, and can refuse.
#pragma once

namespace hapticd::test {

struct SystemCalls {
  long sends = 0, receives = 0;
  bool queue_full = false;  ///< sendmmsg takes nothing: ENOBUFS
};
/// Of this thread.
SystemCalls& system_calls() noexcept;

}  // namespace hapticd::test
