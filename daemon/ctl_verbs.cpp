#include "daemon/ctl_verbs.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "daemon/ctl_client.h"
#include "daemon/options.h"

namespace hapticd::daemon {
namespace {

using namespace std::chrono_literals;

std::string text_at(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
}

/// What stands between the loop and forces, line by line.
std::vector<std::string> waits(const Json& status) {
  std::vector<std::string> lines;
  if (!status.contains("waiting_for") || !status["waiting_for"].is_array()) return lines;
  for (const Json& line : status["waiting_for"]) {
    if (line.is_string()) lines.push_back(line.get<std::string>());
  }
  return lines;
}

std::string status_text(const Json& status) {
  std::string text = "state           " + text_at(status, "state") + "\n";
  if (status.value("enabling", false)) text += "                forces are asked for, not yet on\n";
  for (const std::string& line : waits(status)) text += "waiting for     " + line + "\n";
  if (status.contains("fault") && status["fault"].is_object()) {
    text += "fault           " + text_at(status["fault"], "text") + "\n";
  }
  if (status.contains("config"))
    text += "config          " + text_at(status["config"], "path") + "\n";
  if (status.contains("stability"))
    text += "stability       " + text_at(status["stability"], "verdict") + "\n";
  return text + text_at(status, "table");
}

std::string not_yet(const Json& status) {
  std::string text =
      "forces are not on yet, hapticd goes on waiting (`hapticctl disable` ends that):";
  const std::vector<std::string> lines = waits(status);
  if (lines.empty()) text += "\n  for the devices' power stages; ask `hapticctl status`";
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

/// Forces are on when the power stages are, which may take a while. A search for references ends by
/// itself, found or in a fault, which ends the wait at once.
Result<Json> await_enabled(CtlClient& client) {
  constexpr auto kPatience = 5s;
  auto end = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    auto status = client.ask({Verb::status, false});
    if (!status) return status;
    Json answer = reply(Verb::enable);
    answer["state"] = text_at(*status, "state");
    if (answer["state"] == "enabled") {
      answer["text"] = "forces are on";
      return answer;
    }
    if (!status->value("enabling", false)) {
      const bool fault = (*status)["fault"].is_object();
      return fail(ExitCode::no,
                  "forces are not on: " + (fault ? text_at((*status)["fault"], "text")
                                                 : "state " + text_at(*status, "state")));
    }
    if (answer["state"] == "homing") end = std::chrono::steady_clock::now() + kPatience;
    if (std::chrono::steady_clock::now() > end) return fail(ExitCode::try_again, not_yet(*status));
    std::this_thread::sleep_for(10ms);
  }
}

void print_answer(const Request& request, const Json& answer, bool json) {
  if (json) {
    Json shown = answer;
    shown.erase("table");
    std::puts(to_text(shown).c_str());
  } else if (request.verb == Verb::status) {
    std::fputs(status_text(answer).c_str(), stdout);
  } else {
    std::puts(text_at(answer, "text").c_str());
  }
}

}  // namespace

std::string default_socket() {
  const char* given = std::getenv("HAPTICD_SOCKET");
  return given != nullptr && *given != '\0' ? given : kDefaultSocket;
}

ExitCode print_error(const Error& error, bool json) {
  if (json) {
    std::puts(to_text(error_reply(error)).c_str());
  } else {
    std::fprintf(stderr, "hapticctl: %s\n", error.text.c_str());
  }
  return error.code;
}

ExitCode run_verb(const Request& request, const std::string& socket_path, bool json) {
  auto client = CtlClient::connect(socket_path);
  if (!client) return print_error(client.error(), json);
  auto answer = client->ask(request);
  if (answer && request.verb == Verb::enable) answer = await_enabled(*client);
  if (!answer) return print_error(answer.error(), json);
  print_answer(request, *answer, json);
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
