// What is wrong with the options of a hand that several devices share.
#pragma once
#include <span>
#include <string>

#include "sim/options.h"

namespace hapticd::sim {

/// The first problem of the hand, or of one of the devices that it holds; empty if there is none.
std::string shared_hand_problem(const SharedHandOptions& hand,
                                std::span<const DeviceOptions> devices);

}  // namespace hapticd::sim
