#include "daemon/hapticctl_emulate.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_emulate_part.h"
#include "daemon/interrupts.h"
#include "daemon/monotonic.h"
#include "daemon/realtime.h"

namespace hapticd::daemon {
namespace {

/// Devices answer within microseconds: no timer slack, and below the daemon's priority but above all else, where that is
/// allowed.
void be_prompt() {
  constexpr int kPriority = 20;
  RealtimeReport rights;
  enter_realtime(kPriority, {}, rights);
  (void)::prctl(PR_SET_TIMERSLACK, 1UL);
}

/// Whole lines of standard input, as they come.
class Lines {
 public:
  void open() { open_ = true; }
  bool is_open() const { return open_; }
  std::vector<std::string> take() {
    std::array<char, 4096> bytes{};
    const ssize_t size = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (size <= 0) open_ = false;
    if (size > 0) rest_.append(bytes.data(), static_cast<std::size_t>(size));
    std::vector<std::string> lines;
    for (std::size_t end; (end = rest_.find('\n')) != std::string::npos; rest_.erase(0, end + 1))
      lines.push_back(rest_.substr(0, end));
    return lines;
  }

 private:
  bool open_ = false;
  std::string rest_;
};

class Emulation {
 public:
  explicit Emulation(const EmulateOptions& options) : options_(options) {
    parts_.push_back(emulated_can(options_));
    parts_.push_back(emulated_usb(options_));
  }

  Result<void> start(const config::Compiled& compiled) {
    start_ns_ = monotonic_ns();
    for (const std::string& text : options_.faults)
      if (text != "-")
        if (auto fault = parse_fault(text); !fault) return tl::unexpected(fault.error());
    for (const auto& part : parts_)
      if (auto started = part->start(compiled, start_ns_); !started) return started;
    if (names().empty())
      return fail(ExitCode::no,
                  options_.bus.empty()
                      ? "no device of this config has a driver for CAN or USB"
                      : "no device of this config has all its drives on " + options_.bus);
    for (const std::string& text : options_.faults) {
      if (text == "-") {
        lines_.open();
        continue;
      }
      if (auto added = add_fault(parse_fault(text)); !added) return added;
    }
    return {};
  }

  Result<void> run() {
    be_prompt();
    const std::atomic<bool>& interrupted = interrupts();
    const std::int64_t end_ns =
        options_.duration_s ? start_ns_ + std::llround(1e9 * *options_.duration_s) : INT64_MAX;
    for (std::int64_t now_ns = monotonic_ns(); !interrupted && now_ns < end_ns;
         now_ns = monotonic_ns()) {
      befall(now_ns);
      for (const auto& part : parts_)
        if (auto advanced = part->advance(now_ns); !advanced) return advanced;
      if (wait(now_ns)) hear(monotonic_ns());
    }
    return {};
  }

  Json json() const {
    Json answer{{"ok", true}};
    for (const auto& part : parts_) part->add_to(answer);
    return answer;
  }
  std::string text() const {
    std::string text;
    for (const auto& part : parts_) text += part->text();
    return text;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& part : parts_) std::ranges::copy(part->names(), std::back_inserter(all));
    return all;
  }

 private:
  struct Due {
    Fault fault;
    EmulatedPart* part = nullptr;
  };

  /// Its seconds count from `after_ns`, since the start.
  Result<void> add_fault(Result<Fault> fault, std::int64_t after_ns = 0) {
    if (!fault) return tl::unexpected(fault.error());
    fault->at_ns += after_ns;
    for (const auto& part : parts_) {
      const auto known = part->names();
      const auto kinds = part->fault_kinds();
      if (std::ranges::find(known, fault->name) == known.end()) continue;
      if (std::ranges::find(kinds, fault->kind) == kinds.end())
        return fail(ExitCode::usage, fmt::format("--fault: {} has no {}; it has: {}", fault->name,
                                                 fault->kind, fmt::join(kinds, ", ")));
      if (fault->percent && !part->has_firmware(fault->name))
        return fail(ExitCode::usage, "--fault: no firmware is loaded into " + fault->name);
      due_.push_back({*fault, part.get()});
      std::ranges::stable_sort(due_, {}, [](const Due& due) { return due.fault.at_ns; });
      return {};
    }
    return fail(ExitCode::usage, fmt::format("--fault: there is no {}; there are: {}", fault->name,
                                             fmt::join(names(), ", ")));
  }

  void befall(std::int64_t now_ns) {
    while (!due_.empty() && due_.front().fault.at_ns <= now_ns - start_ns_) {
      const Due due = due_.front();
      due_.erase(due_.begin());
      due.part->befall(due.fault, now_ns);
      if (due.fault.percent) continue;  // has not befallen yet
      std::fprintf(stderr, "%s %s at %.3f s\n", due.fault.kind.c_str(), due.fault.name.c_str(),
                   1e-9 * static_cast<double>(now_ns - start_ns_));
    }
  }

  /// What was said on standard input; what is wrong there ends nothing.
  void hear(std::int64_t now_ns) {
    for (const std::string& line : lines_.take())
      if (auto added = add_fault(parse_fault(line, true), now_ns - start_ns_); !added)
        std::fprintf(stderr, "%s\n", added.error().text.c_str());
  }

  /// Until a bus has something, or the next step of a device or of the mechanics. True: standard input has something.
  bool wait(std::int64_t now_ns) {
    std::int64_t next_ns = INT64_MAX;
    wait_on_.assign(1,
                    {.fd = lines_.is_open() ? STDIN_FILENO : -1, .events = POLLIN, .revents = 0});
    for (const auto& part : parts_) next_ns = std::min(next_ns, part->next_ns(now_ns, wait_on_));
    const std::int64_t left_ns = std::max<std::int64_t>(0, next_ns - monotonic_ns());
    const timespec timeout{.tv_sec = 0, .tv_nsec = static_cast<long>(left_ns)};
    return ::ppoll(wait_on_.data(), wait_on_.size(), &timeout, nullptr) > 0 &&
           wait_on_[0].revents != 0;
  }

  const EmulateOptions& options_;
  std::int64_t start_ns_ = 0;
  std::vector<std::unique_ptr<EmulatedPart>> parts_;
  std::vector<Due> due_;  ///< in the order of time
  std::vector<pollfd> wait_on_;
  Lines lines_;
};

}  // namespace

ExitCode run_emulate(const EmulateOptions& options, bool json) {
  const auto compiled = config::load(options.config);
  if (!compiled) return print_config_errors(compiled.error(), json);
  Emulation emulation(options);
  if (auto started = emulation.start(*compiled); !started)
    return print_error(started.error(), json);
  std::fprintf(stderr, "emulating %s; end with Ctrl-C\n",
               fmt::format("{}", fmt::join(emulation.names(), ", ")).c_str());
  if (auto ran = emulation.run(); !ran) return print_error(ran.error(), json);
  std::fputs(json ? (to_text(emulation.json()) + "\n").c_str() : emulation.text().c_str(), stdout);
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
