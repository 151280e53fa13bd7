// What a device of CAN drives is: filled by config/, plain data.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/can/bus_time.h"
#include "drivers/device.h"

namespace hapticd::can {

enum class Protocol : std::uint8_t { odrive, moteus, cia402 };

struct DriveOptions {
  std::string axis{};        ///< for people: "left.x"
  std::string interface {};  ///< "can0"
  std::uint8_t node = 1;
  /// Encoder counts per m or rad of the axis, negative: reversed; and per turn of the motor. Samples are in counts.
  /// Torque follows, since effort x axis = torque x turns.
  double counts_per_unit = 1;
  double counts_per_turn = 1;
  double max_effort = 1;  ///< N, N m: of the axis
  // odrive: the limits that it is told; without a current it keeps its own
  double max_velocity_turns_s = 0;
  double max_current_A = 0;
};

struct DeviceOptions {
  std::string name{};
  Protocol protocol = Protocol::odrive;
  drivers::Timing timing = drivers::Timing::free_running;
  double period_s = 1e-3;
  BitRates rates{};
  double turnaround_s = 1e-4;   ///< a drive begins to answer so long after a question, at most
  double drive_delay_s = 1e-4;  ///< a torque acts so long after its frame came, at most
  double watchdog_s = 0.02;     ///< without a command for so long, a drive goes off by itself
  int most_unsent_ticks = 3;    ///< in a row, that the bus may not take a torque in
  /// The loop waits so long for answers, from its tick's start; 0: no device of it is sampled in phase.
  double collect_s = 0;
  double worst_sample_age_s = 0;  ///< at collect; an older sample is missing
  std::vector<DriveOptions> drives{};

  double estimates_every_s = 1e-3;      ///< odrive, free running: as set in the drive
  double heartbeat_every_s = 0.1;       ///< odrive: as set in the drive; cia402: what it is told
  std::uint8_t source = 0;              ///< moteus: the host's
  std::uint16_t prefix = 0;             ///< moteus
  bool ignore_position_bounds = false;  ///< moteus
  std::uint8_t host_node = 127;         ///< cia402: whose heartbeat the drives watch
};

}  // namespace hapticd::can
