#include "daemon/supervisor.h"

#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include "daemon/log.h"
#include "daemon/monotonic.h"

namespace hapticd::daemon {
namespace {

constexpr std::int64_t kLook_ns = 20'000'000;

/// Rings fifty times a second, or as often as the service manager's watchdog wants to be fed four
/// times over.
Result<FileDescriptor> look_timer(const ServiceNotify& notify) {
  std::int64_t every_ns = kLook_ns;
  if (const auto watchdog = notify.watchdog()) {
    every_ns = std::clamp<std::int64_t>(watchdog->count() * 1000 / 4, 1'000'000, every_ns);
  }
  FileDescriptor timer(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  itimerspec spec{};
  spec.it_interval.tv_nsec = every_ns;
  spec.it_value = spec.it_interval;
  if (!timer.valid() || ::timerfd_settime(timer.get(), 0, &spec, nullptr) != 0) {
    return fail(ExitCode::software, std::string("timerfd: ") + std::strerror(errno));
  }
  return timer;
}

TelemetryEvents log_telemetry() {
  return {.flight_written =
              [](const std::string& path, std::uint64_t records) {
                log_warning("flight recording: {} ({} records)", path, records);
              },
          .failed = [](const Error& error) { log_error("{}", error.text); }};
}

void print_now(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace

Supervisor::Supervisor(DaemonOptions options, config::Compiled compiled)
    : options_(std::move(options)),
      compiled_(std::move(compiled)),
      gate_(stability_gate(compiled_)) {}

Supervisor::~Supervisor() = default;

ExitCode Supervisor::run() {
  if (auto started = start(); !started) {
    log_error("{}", started.error().text);
    if (engine_) engine_->stop();
    return started.error().code;
  }
  loop();
  return stop();
}

Result<void> Supervisor::start() {
  auto signals = Signals::block();
  if (!signals) return tl::unexpected(signals.error());
  signals_ = std::move(*signals);
  if (auto opened = open_socket(); !opened) return opened;

  log_info("config {} (digest {})", compiled_.document.path, compiled_.document.digest);
  seen_.starting = true;
  enter(State::connecting);
  engine_ = std::make_unique<Engine>(compiled_, log_telemetry());
  if (auto connected = engine_->connect(); !connected) return connected;

  engine_->start();
  Signals::cpu_time_fault_to(&engine_->shared().host_fault);
  started_ns_ = monotonic_ns();
  heartbeat_.emplace(started_ns_);
  thread_at_start_ = read_thread_use(engine_->shared().thread_id.load());
  seen_.looping = true;
  if (auto rights = check_rights(); !rights) return rights;
  enter(next_state(state_, seen_));

  auto timer = look_timer(notify_);
  if (!timer) return tl::unexpected(timer.error());
  timer_ = std::move(*timer);
  log_text(gate_.permits(false) ? LogLevel::info : LogLevel::warning, gate_.explanation());
  if (compiled_.document.config.start.enable == config::EnableWhen::when_ready &&
      gate_.permits(false)) {
    cause_ = "start.enable: when_ready";
    engine_->shared().enable.store(true);
  }
  notify_.ready(status_sentence());
  return {};
}

/// Without a socket the daemon still runs if nobody asked for this one in particular: a first run
/// by a plain user.
Result<void> Supervisor::open_socket() {
  const std::string path = options_.socket.value_or(compiled_.document.config.control.socket);
  auto socket =
      ControlSocket::open(path, [this](std::string_view message) { return answer(message); });
  if (socket) {
    socket_.emplace(std::move(*socket));
    log_info("control socket {}", path);
    return {};
  }
  if (options_.socket || socket.error().code == ExitCode::try_again)
    return tl::unexpected(socket.error());
  log_warning("no control socket, so no hapticctl: {}", socket.error().text);
  return {};
}

Result<void> Supervisor::check_rights() const {
  const auto& missing = engine_->realtime().missing;
  if (missing.empty()) return {};
  std::string text = "real-time rights are missing, ticks may come late:";
  for (const MissingRight& right : missing) {
    text += fmt::format("\n  {}: {}; grant it by {}", right.right, right.reason, right.grant);
  }
  if (options_.require_realtime)
    return fail(ExitCode::no_permission, text + "\n--require-realtime: not started");
  log_warning("{}", text);
  return {};
}

void Supervisor::loop() {
  const FileDescriptor epoll(::epoll_create1(EPOLL_CLOEXEC));
  const auto watch = [&](int fd) {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = fd;
    ::epoll_ctl(epoll.get(), EPOLL_CTL_ADD, fd, &event);
  };
  watch(signals_.wait_fd());
  watch(timer_.get());
  if (socket_) watch(socket_->wait_fd());

  while (!ended_) {
    std::array<epoll_event, 3> events{};
    const int ready = ::epoll_wait(epoll.get(), events.data(), static_cast<int>(events.size()), -1);
    for (int i = 0; i < ready; ++i) {
      const int fd = events[static_cast<std::size_t>(i)].data.fd;
      if (fd == signals_.wait_fd()) {
        while (const auto signal = signals_.next()) on_signal(*signal);
      } else if (fd == timer_.get()) {
        std::uint64_t rung = 0;
        if (::read(timer_.get(), &rung, sizeof(rung)) == sizeof(rung)) look();
      } else if (socket_) {
        socket_->serve();
      }
    }
  }
}

void Supervisor::on_signal(int signal) {
  switch (signal) {
    case SIGHUP:
      log_info("SIGHUP: reload");
      (void)reload();  // it logs what came of it
      break;
    case SIGUSR1:
      look();
      print_now(to_table(summary()));
      break;
    default:
      log_info("{}: stopping", signal == SIGINT ? "SIGINT" : "SIGTERM");
      cause_ = "signal";
      ended_ = true;
  }
}

/// Ramps out, ends the loop, tells how it went. A run of given length that ends in a fault did not
/// do its work.
ExitCode Supervisor::stop() {
  notify_.stopping();
  look();
  const bool failed = options_.duration_s && state_ == State::fault;
  thread_now_ = read_thread_use(engine_->shared().thread_id.load());
  Signals::hurry_by(&engine_->shared().estop);
  engine_->stop();
  Signals::cpu_time_fault_to(nullptr);
  Signals::hurry_by(nullptr);
  const Summary last = summary();
  seen_ = {};
  enter(State::off);
  socket_.reset();
  print_now(to_table(last));
  return failed ? ExitCode::no : ExitCode::ok;
}

}  // namespace hapticd::daemon
