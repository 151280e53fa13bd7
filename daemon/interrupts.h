// SIGINT and SIGTERM for verbs that take long: they end early with whole files.
#pragma once
#include <atomic>

namespace hapticd::daemon {

/// Becomes true at the first signal; a second one ends the program there and then. The first call
/// installs the handlers.
const std::atomic<bool>& interrupts();

}  // namespace hapticd::daemon
