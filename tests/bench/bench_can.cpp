// The codecs of drivers/can: one frame of each kind, ns per frame. A tick has a few frames per axis; the aim is 100 ns for
// each.
#include <benchmark/benchmark.h>

#include <cstdint>

#include "drivers/can/cia402_codec.h"
#include "drivers/can/moteus_codec.h"
#include "drivers/can/odrive_codec.h"

namespace {

using namespace hapticd::can;

constexpr std::uint8_t kNode = 3;

/// Values that differ from frame to frame, so that nothing is worked out beforehand.
class Torques {
 public:
  double next() { return torque_Nm_ = torque_Nm_ < 1 ? torque_Nm_ + 1e-3 : -1; }

 private:
  double torque_Nm_ = 0;
};

template <class Encode>
void encode(benchmark::State& state, const Encode& encode) {
  Torques torques;
  for (auto _ : state) {
    auto frame = encode(torques.next());
    benchmark::DoNotOptimize(frame);
  }
}

template <class Decode>
void decode(benchmark::State& state, Frame frame, const Decode& decode) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(frame);
    auto decoded = decode(frame);
    benchmark::DoNotOptimize(decoded);
  }
}

template <class Number>
Frame with(std::uint32_t id, std::uint8_t size, std::initializer_list<Number> numbers) {
  Frame frame{.id = id, .size = size};
  std::size_t at = 0;
  for (const Number number : numbers) {
    put(frame, at, number);
    at += sizeof number;
  }
  return frame;
}

Frame odrive_frame(odrive::Command command) {
  return with((std::uint32_t{kNode} << 5) | static_cast<std::uint32_t>(command), 8, {1.25F, -0.5F});
}

/// As a moteus answers: state, and what of it is asked for beside.
Frame moteus_reply(bool settings) {
  // mode 10, position 1, no fault; maximum torque 1, watchdog 0.1
  constexpr std::uint8_t kState[] = {0x21, 0, 10, 0x2d, 1, 0, 0, 0x80, 0x3f, 0x21, 0x0f, 0};
  constexpr std::uint8_t kSettings[] = {0x2d, 0x25, 0,    0,    0x80, 0x3f,
                                        0x2d, 0x27, 0xcd, 0xcc, 0xcc, 0x3d};
  constexpr std::uint8_t kTag[] = {0x21, 0x70, 7, 0x21, 0x82, 2, 5};
  Frame frame = moteus::to_servo({.servo = kNode}, false);
  const auto add = [&](const auto& bytes) {
    for (const std::uint8_t byte : bytes) frame.data[frame.size++] = byte;
  };
  add(kState);
  if (settings) add(kSettings);
  add(kTag);
  while (frame.size < fd_length(frame.size)) frame.data[frame.size++] = 0x50;
  return frame;
}

void run(const char* name, const auto& work) {
  benchmark::RegisterBenchmark(name, work)->Repetitions(15)->ReportAggregatesOnly();
}

void add_odrive() {
  using odrive::Command;
  run("odrive/encode/torque", [](auto& state) {
    encode(state, [](double torque) { return odrive::set_input_torque(kNode, torque); });
  });
  run("odrive/encode/position", [](auto& state) {
    encode(state, [](double turns) { return odrive::set_input_pos(kNode, turns, 0.5, 0.1); });
  });
  run("odrive/encode/velocity", [](auto& state) {
    encode(state, [](double velocity) { return odrive::set_input_vel(kNode, velocity, 0.1); });
  });
  run("odrive/encode/limits", [](auto& state) {
    encode(state, [](double velocity) { return odrive::set_limits(kNode, velocity, 10); });
  });
  run("odrive/encode/mode", [](auto& state) {
    encode(state, [](double) {
      return odrive::set_controller_mode(kNode, odrive::ControlMode::torque,
                                         odrive::InputMode::passthrough);
    });
  });
  run("odrive/encode/request", [](auto& state) {
    encode(state, [](double) { return odrive::request(kNode, Command::get_encoder_estimates); });
  });
  const auto one = [](const char* name, Command command) {
    run(name, [command](auto& state) {
      decode(state, odrive_frame(command),
             [](const Frame& frame) { return odrive::decode(frame, kNode); });
    });
  };
  one("odrive/decode/version", Command::get_version);
  one("odrive/decode/heartbeat", Command::heartbeat);
  one("odrive/decode/errors", Command::get_error);
  one("odrive/decode/estimates", Command::get_encoder_estimates);
  one("odrive/decode/currents", Command::get_iq);
  one("odrive/decode/temperatures", Command::get_temperature);
  one("odrive/decode/supply", Command::get_bus_voltage_current);
  one("odrive/decode/torques", Command::get_torques);
}

constexpr moteus::Address kAddress{.servo = kNode};

void add_moteus() {
  // In every tick; the second only while a servo is being armed.
  run("moteus/encode/torque", [](auto& state) {
    const moteus::TorqueCommands commands(kAddress, {.maximum_torque_Nm = 1, .watchdog_s = 0.1},
                                          true);
    encode(state, [&](double torque) { return commands.with(torque, 3); });
  });
  run("moteus/encode/start", [](auto& state) {
    encode(state, [](double torque) {
      return moteus::torque_command(
          kAddress, {.torque_Nm = torque, .maximum_torque_Nm = 1, .watchdog_s = 0.1},
          moteus::Query{.settings = true, .tag = 3});
    });
  });
  run("moteus/encode/stop", [](auto& state) {
    encode(state, [](double) { return moteus::stop(kAddress, std::nullopt); });
  });
  run("moteus/encode/ask",
      [](auto& state) { encode(state, [](double) { return moteus::ask(kAddress, {.tag = 3}); }); });
  run("moteus/encode/ask_identity",
      [](auto& state) { encode(state, [](double) { return moteus::ask_identity(kAddress); }); });
  const auto read = [](const Frame& frame) { return moteus::decode(frame.payload()); };
  run("moteus/decode/reply", [read](auto& state) { decode(state, moteus_reply(false), read); });
  run("moteus/decode/reply_and_settings",
      [read](auto& state) { decode(state, moteus_reply(true), read); });
}

constexpr cia402::Object kTorque{0x6071, 0};

void add_cia402() {
  run("cia402/encode/rpdo1", [](auto& state) {
    encode(state, [](double torque) {
      return cia402::rpdo1(kNode, 0x0f, cia402::torque_raw(torque, 0.5).value_or(0));
    });
  });
  run("cia402/encode/sync",
      [](auto& state) { encode(state, [](double) { return cia402::sync(); }); });
  run("cia402/encode/heartbeat", [](auto& state) {
    encode(state, [](double) { return cia402::heartbeat(127, cia402::NodeState::operational); });
  });
  run("cia402/encode/nmt", [](auto& state) {
    encode(state, [](double) { return cia402::nmt(cia402::Nmt::start, kNode); });
  });
  run("cia402/encode/sdo_write", [](auto& state) {
    encode(state, [](double torque) {
      return cia402::sdo_write(kNode, kTorque, static_cast<int>(1000 * torque), 2);
    });
  });
  run("cia402/encode/sdo_read",
      [](auto& state) { encode(state, [](double) { return cia402::sdo_read(kNode, kTorque); }); });
  const auto one = [](const char* name, std::uint32_t code, std::uint8_t size,
                      std::uint32_t first) {
    run(name, [=](auto& state) {
      decode(state, with(code + kNode, size, {first, 0x01020304u}), [](const Frame& frame) {
        const cia402::Decoded decoded = cia402::decode(frame, kNode);
        if (decoded.tpdo1) benchmark::DoNotOptimize(cia402::state_of(decoded.tpdo1->status));
        return decoded;
      });
    });
  };
  one("cia402/decode/tpdo1", 0x180, 8, 0x1237);
  one("cia402/decode/tpdo2", 0x280, 7, 1000);
  one("cia402/decode/emergency", 0x080, 8, 0x3220);
  one("cia402/decode/heartbeat", 0x700, 1, 5);
  one("cia402/decode/sdo_reply", 0x580, 8, 0x0060764f);
}

}  // namespace

int main(int argc, char** argv) {
  add_odrive();
  add_moteus();
  add_cia402();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 64;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
