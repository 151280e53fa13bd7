#include "tests/fuzz/protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hapticd::fuzz::Input input(data, size);
  if (input.byte() % 3 == 1)
    hapticd::fuzz::encode(input);
  else
    hapticd::fuzz::decode(input);
  return 0;
}
