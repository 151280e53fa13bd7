// hidapi's functions as a test wants them: they stand in this program, so that the library's own are not used.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hapticd::test {

using HidBytes = std::vector<std::uint8_t>;

struct FakeHidapi {
  std::string opened{}, refusal{};  ///< the node; not empty: why it cannot be opened
  std::deque<HidBytes> waiting{};   ///< that the kernel has
  int descriptor = -1;              ///< of a node that is a device, whose reports come from there
  std::vector<HidBytes> written{}, features{};
  HidBytes feature{};                   ///< the answer to get
  int read_error = 0, write_error = 0;  ///< errno; 0: works
  int longest_wait_ms = 0, closed = 0;
  std::function<void()> while_waiting{}, while_writing{};
};
/// The one that is.
FakeHidapi& fake_hidapi();

}  // namespace hapticd::test
