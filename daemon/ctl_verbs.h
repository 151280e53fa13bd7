// The verbs of hapticctl that talk to a running daemon.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

/// Asks, prints the answer (or the error, to stderr), returns what hapticctl ends with. `enable`
/// waits until forces are on or a fault says why not.
ExitCode run_verb(const Request& request, const std::string& socket_path, bool json);

/// $HAPTICD_SOCKET, or where the service listens.
std::string default_socket();

/// An error for a person or a machine.
ExitCode print_error(const Error& error, bool json);

}  // namespace hapticd::daemon
