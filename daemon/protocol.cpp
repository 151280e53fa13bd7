#include "daemon/protocol.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

namespace hapticd::daemon {
namespace {

constexpr std::string_view kExample = R"({"v":1,"verb":"status"})";

tl::unexpected<Error> refuse(std::string text) {
  return fail(ExitCode::usage, std::move(text));
}

/// A value as it stood in the request, short enough for an error message.
std::string shown(const Json& value) {
  std::string text = to_text(value);
  constexpr std::size_t kLongest = 60;
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

std::optional<Verb> find_verb(const std::string& name) {
  const auto found = std::find(kVerbNames.begin(), kVerbNames.end(), name);
  if (found == kVerbNames.end()) return std::nullopt;
  return static_cast<Verb>(found - kVerbNames.begin());
}

/// Nothing but what the verb knows: a misspelt "unproven" must not pass for a plain enable.
Result<void> check_keys(const Json& message, Verb verb) {
  for (const auto& item : message.items()) {
    const bool known = item.key() == "v" || item.key() == "verb" ||
                       (item.key() == "unproven" && verb == Verb::enable);
    if (!known) {
      return refuse(fmt::format("expected no keys but v, verb{} with verb {}, found unknown key {}",
                                verb == Verb::enable ? ", unproven" : "",
                                kVerbNames[static_cast<std::size_t>(verb)], shown(item.key())));
    }
  }
  return {};
}

}  // namespace

Result<Request> parse_request(std::string_view message) {
  if (message.size() > kMaxMessageBytes) {
    return refuse(fmt::format("the message is longer than {} bytes; a request looks like {}",
                              kMaxMessageBytes, kExample));
  }
  const Json json = Json::parse(message, nullptr, false);
  if (!json.is_object()) {
    return refuse(fmt::format("expected one JSON object like {}, found {}", kExample,
                              json.is_discarded() ? "what is not JSON" : shown(json)));
  }
  if (!json.contains("v") || json["v"] != kProtocolVersion) {
    return refuse(fmt::format(
        "expected protocol version \"v\": {}, found {}; hapticd and hapticctl must be of the "
        "same release",
        kProtocolVersion, json.contains("v") ? shown(json["v"]) : "none"));
  }
  const auto verb = json.contains("verb") && json["verb"].is_string()
                        ? find_verb(json["verb"].get<std::string>())
                        : std::nullopt;
  if (!verb) {
    return refuse(fmt::format("expected a \"verb\" out of {}, found {}",
                              fmt::join(kVerbNames, ", "),
                              json.contains("verb") ? shown(json["verb"]) : "none"));
  }
  if (auto keys = check_keys(json, *verb); !keys) return tl::unexpected(keys.error());
  Request request{*verb, false};
  if (json.contains("unproven")) {
    if (!json["unproven"].is_boolean()) {
      return refuse("expected \"unproven\" to be true or false, found " + shown(json["unproven"]));
    }
    request.unproven = json["unproven"].get<bool>();
  }
  return request;
}

std::string format_request(const Request& request) {
  Json json = {{"v", kProtocolVersion},
               {"verb", kVerbNames[static_cast<std::size_t>(request.verb)]}};
  if (request.unproven) json["unproven"] = true;
  return to_text(json);
}

Json reply(Verb verb) {
  return {
      {"v", kProtocolVersion}, {"ok", true}, {"verb", kVerbNames[static_cast<std::size_t>(verb)]}};
}

Json error_reply(const Error& error) {
  return {{"v", kProtocolVersion},
          {"ok", false},
          {"code", static_cast<int>(error.code)},
          {"error", error.text}};
}

std::string to_text(const Json& message) {
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace hapticd::daemon
