#include "tests/fuzz/protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hapticd::fuzz::Input input(data, size);
  hapticd::fuzz::drive(input);
  return 0;
}
