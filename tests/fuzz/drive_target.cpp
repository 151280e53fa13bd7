#include "tests/fuzz/protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hapticd::fuzz::Input input(data, size);
  (void)input.byte();  // which the codec's target chooses by
  hapticd::fuzz::session(input);
  return 0;
}
