// Which contacts are solved together, and what ties them.
#pragma once
#include <cstdint>
#include <vector>

#include "control/build/coupling.h"

namespace hapticd::build {

struct TiedContacts {
  std::vector<std::uint16_t> contacts;  ///< ascending
  std::vector<CouplingBlock> blocks;
  std::vector<Network> networks;
};

/// Blocks and networks are taken apart first: a diagonal stiffness over two contacts ties neither
/// to the other. `problem(spec)` finds nothing.
std::vector<TiedContacts> tied_contacts(const GroupsSpec& spec);

}  // namespace hapticd::build
