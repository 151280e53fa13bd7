// What is said over the control socket: one JSON request, one JSON reply, each a message of its
// own.
//
//   {"v": 1, "verb": "enable", "unproven": true}
//   {"v": 1, "ok": true, "verb": "enable", "text": "...", ...}
//   {"v": 1, "ok": false, "code": 64, "error": "..."}        code: an ExitCode, for hapticctl to
//   end with
//
// Pure: text in, text out.
#pragma once
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "control/core/result.h"

namespace hapticd::daemon {

using Json = nlohmann::ordered_json;

inline constexpr int kProtocolVersion = 1;
inline constexpr std::size_t kMaxMessageBytes = 64 * 1024;

enum class Verb { status, enable, disable, estop, reload };
inline constexpr std::array<std::string_view, 5> kVerbNames = {"status", "enable", "disable",
                                                               "estop", "reload"};

struct Request {
  Verb verb = Verb::status;
  bool unproven = false;  ///< enable only
};

/// The request, or an error that says what was expected.
Result<Request> parse_request(std::string_view message);
std::string format_request(const Request& request);

/// `{"v", "ok": true, "verb"}` for the verb to add to.
Json reply(Verb verb);
Json error_reply(const Error& error);
/// One line; text that is not UTF-8 is replaced, never thrown about.
std::string to_text(const Json& message);

}  // namespace hapticd::daemon
