// A device on USB: which one it is, how old its samples get, what its bytes are.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hapticd::config {

enum class UsbTransport { hidapi, libusb };
/// Which device is meant, and its times.
struct UsbDevice {
  std::optional<std::string> id{};  ///< "vvvv:pppp"; default: the driver's
  std::optional<std::string> serial{};
  std::optional<std::string> path{};
  std::optional<int> interface {};                ///< HID
  std::optional<std::string> usage{};             ///< HID: "page:usage"
  UsbTransport transport = UsbTransport::hidapi;  ///< HID
  int reads = 2;                                  ///< libusb
  std::optional<double> arrival_age_s{};          ///< default: 1 ms; of an openffboard 3 ms
  std::optional<double> max_age_s{};  ///< default: 2.5 ms; by hidapi 3.5 ms; of an openffboard 8 ms
  std::optional<double> send_s{};  ///< default: 2 ms; of an openffboard 2 ms and 1 ms for each axis
  double drive_delay_s = 1e-4;
  double watchdog_s = 0.02;
  std::optional<double> silence_s{};  ///< default: 0.1; of an openffboard 0.15
  bool operator==(const UsbDevice&) const = default;
};

struct Falcon {
  std::optional<std::string> firmware{};
  std::optional<std::string> sha256{};  ///< of firmware; default: any
  int upload_tries = 10;
  double counts_per_Nm = -10000;
  double max_command = 4096;
  bool flush_on_bracket = false;
  bool operator==(const Falcon&) const = default;
};

enum class ByteOrder { little, big };
/// Where a whole number lies in a report.
struct BitField {
  int offset_bits = 0;
  int width_bits = 0;
  ByteOrder endian = ByteOrder::little;
  bool operator==(const BitField&) const = default;
};
/// A number of which there are two sorts.
struct NumberField : BitField {
  bool is_signed = false;
  bool is_float = false;
  bool operator==(const NumberField&) const = default;
};
struct AnalogueField : NumberField {
  double scale = 1;
  double offset = 0;
  bool operator==(const AnalogueField&) const = default;
};
struct PositionField : AnalogueField {
  bool unwrap = false;
  std::optional<std::int64_t> modulus{};  ///< default: 2^width_bits
  bool operator==(const PositionField&) const = default;
};
struct ButtonField {
  int offset_bits = 0;
  int width_bits = 1;
  bool operator==(const ButtonField&) const = default;
};
struct SequenceField : BitField {
  std::optional<std::int64_t> modulus{};  ///< default: 2^width_bits
  bool operator==(const SequenceField&) const = default;
};
struct ReportIn {
  std::optional<int> id{};  ///< default: reports have none
  int bytes = 0;            ///< with the id
  std::vector<PositionField> positions{};
  std::vector<ButtonField> buttons{};
  std::vector<AnalogueField> analogue{};
  std::optional<SequenceField> sequence{};
  bool operator==(const ReportIn&) const = default;
};

struct EffortField : NumberField {
  double scale = 0;
  double offset = 0;
  std::optional<double> least{}, most{};  ///< default: what the number can hold
  bool operator==(const EffortField&) const = default;
};
struct ConstantByte {
  int byte = 0;
  int value = 0;
  bool operator==(const ConstantByte&) const = default;
};
struct ReportOut {
  std::optional<int> id{};  ///< default: reports have none
  int bytes = 0;            ///< with the id
  std::vector<EffortField> efforts{};
  std::vector<ConstantByte> constants{};
  std::optional<BitField> heartbeat{};
  std::vector<int> safe{};  ///< empty: every effort 0
  double every_s = 0.005;
  std::optional<double> watchdog_s{};  ///< default: the device has none
  bool operator==(const ReportOut&) const = default;
};
struct Report {
  ReportIn in{};
  ReportOut out{};
  bool operator==(const Report&) const = default;
};

struct OpenFfboard {
  double full_torque_Nm = 0;
  double dead_man_s = 0.1;
  bool operator==(const OpenFfboard&) const = default;
};

}  // namespace hapticd::config
