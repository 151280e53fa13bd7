// tick_loop TICKS [DEVICES AXES PLANES OBSERVED]: so many ticks without a clock, for valgrind to count.
#include <cstdio>
#include <cstdlib>

#include "tests/bench/tick_rig.h"

int main(int argc, char** argv) {
  const auto number = [&](int i, std::size_t otherwise) {
    return argc > i ? static_cast<std::size_t>(std::strtoul(argv[i], nullptr, 10)) : otherwise;
  };
  if (argc < 2) {
    std::fprintf(stderr, "usage: tick_loop TICKS [DEVICES AXES PLANES OBSERVED]\n");
    return 64;
  }
  hapticd::bench::TickRig rig(
      hapticd::bench::tick_spec(number(2, 1), number(3, 3), number(4, 0), number(5, 0) != 0));
  for (std::size_t i = number(1, 0); i > 0; --i)
    rig.tick([]() noexcept -> std::int64_t { return 0; });
  return rig.enabled() ? 0 : 1;
}
