// What every USB device answers on endpoint 0 (USB 2.0, chapter 9).
#include <algorithm>
#include <cstring>

#include "sim/usb/wire.h"

namespace hapticd::sim::usb {
namespace {

enum StandardRequest : std::uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kSetFeature = 3,
  kSetAddress = 5,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kSetConfiguration = 9,
  kGetInterface = 10,
  kSetInterface = 11,
};

enum Descriptor : std::uint8_t {
  kOfDevice = 1,
  kOfConfiguration = 2,
  kOfString = 3,
  kOfInterface = 4,
  kOfHid = 0x21,
  kOfReport = 0x22,
};

enum Recipient : std::uint8_t { kToDevice = 0, kToInterface = 1, kToEndpoint = 2 };

Answer refused() {
  return {.kind = Answer::Kind::stall};
}

Answer shortened(std::vector<std::uint8_t> bytes, std::size_t most) {
  if (bytes.size() > most) bytes.resize(most);
  return {.bytes = std::move(bytes)};
}

/// UTF-8 of the basic plane as UTF-16LE.
std::vector<std::uint8_t> wide(const char* text) {
  std::vector<std::uint8_t> bytes;
  for (const auto* c = reinterpret_cast<const unsigned char*>(text); *c != 0;) {
    unsigned code = *c++;
    int more = code >= 0xe0 ? 2 : code >= 0xc0 ? 1 : 0;
    if (more > 0) code &= more == 2 ? 0x0fu : 0x1fu;
    for (; more > 0 && *c != 0; --more) code = code << 6 | (*c++ & 0x3fu);
    bytes.push_back(static_cast<std::uint8_t>(code & 0xff));
    bytes.push_back(static_cast<std::uint8_t>(code >> 8 & 0xff));
  }
  return bytes;
}

}  // namespace

Answer Wire::control(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns) {
  if (!plugged_) return refused();
  if (now_ns < hangs_until_ns_) return {.kind = Answer::Kind::nak};
  device_.advance(now_ns);
  if ((setup.request_type >> 5 & 3) == 0) return standard(setup);
  Answer answer = device_.control(setup, data, now_ns);
  if (answer.bytes.size() > setup.length) answer.bytes.resize(setup.length);
  return answer;
}

Answer Wire::standard(const Setup& setup) {
  switch (setup.request) {
    case kGetStatus:
      return status(setup);
    case kClearFeature:
    case kSetFeature:
      return halt(setup, setup.request == kSetFeature) ? Answer{} : refused();
    case kSetAddress:
      return {};
    case kGetDescriptor:
      return descriptor(setup);
    case kGetConfiguration:
      return {.bytes = {configured_}};
    case kSetConfiguration:
      if (setup.value > 1) return refused();
      configured_ = static_cast<std::uint8_t>(setup.value);
      for (Endpoint& endpoint : endpoints_) endpoint.halted = false;
      return {};
    case kGetInterface:
      return interface_is_there(setup) ? Answer{.bytes = {0}} : refused();
    case kSetInterface:
      return interface_is_there(setup) && setup.value == 0 ? Answer{} : refused();
    default:
      return refused();
  }
}

Answer Wire::descriptor(const Setup& setup) const {
  const int index = setup.value & 0xff;
  switch (setup.value >> 8) {
    case kOfDevice:
      return shortened(device_.device_descriptor(), setup.length);
    case kOfConfiguration:
      return index == 0 ? shortened(configuration_, setup.length) : refused();
    case kOfString: {
      Answer answer = string(index);
      if (answer.bytes.size() > setup.length) answer.bytes.resize(setup.length);
      return answer;
    }
    case kOfHid:
      return hid_descriptor(setup);
    case kOfReport: {
      auto report = device_.report_descriptor(setup.index & 0xff);
      return report.empty() ? refused() : shortened(std::move(report), setup.length);
    }
    default:
      return refused();
  }
}

/// It stands in the configuration, behind its interface.
Answer Wire::hid_descriptor(const Setup& setup) const {
  int interface = -1;
  for (std::size_t i = 0; i + 2 < configuration_.size(); i += configuration_[i]) {
    if (configuration_[i] == 0) break;
    if (configuration_[i + 1] == kOfInterface) interface = configuration_[i + 2];
    if (configuration_[i + 1] != kOfHid || interface != (setup.index & 0xff)) continue;
    const auto from = configuration_.begin() + static_cast<std::ptrdiff_t>(i);
    return shortened({from, from + configuration_[i]}, setup.length);
  }
  return refused();
}

Answer Wire::string(int index) const {
  if (index == 0) return {.bytes = {4, kOfString, 0x09, 0x04}};  // English, United States
  const Names names = device_.names();
  const std::string text = index == 1   ? names.manufacturer
                           : index == 2 ? names.product
                           : index == 3 ? names.serial
                                        : std::string();
  if (text.empty()) return refused();
  std::vector<std::uint8_t> bytes = wide(text.c_str());
  if (bytes.size() > 252) bytes.resize(252);
  const std::uint8_t head[] = {static_cast<std::uint8_t>(bytes.size() + 2), kOfString};
  bytes.insert(bytes.begin(), head, head + 2);
  return {.bytes = std::move(bytes)};
}

Answer Wire::status(const Setup& setup) const {
  std::uint8_t bits = 0;
  switch (setup.request_type & 31) {
    case kToDevice:
      bits = configuration_.size() > 7 && configuration_[7] & 0x40 ? 1 : 0;  // powers itself
      break;
    case kToInterface:
      if (!interface_is_there(setup)) return refused();
      break;
    case kToEndpoint: {
      const Endpoint* endpoint = find(static_cast<std::uint8_t>(setup.index));
      if (endpoint == nullptr) return refused();
      bits = endpoint->halted;
      break;
    }
    default:
      return refused();
  }
  return shortened({bits, 0}, setup.length);
}

bool Wire::halt(const Setup& setup, bool halted) {
  if ((setup.request_type & 31) != kToEndpoint) return setup.value == 1;  // remote wake-up
  Endpoint* endpoint = find(static_cast<std::uint8_t>(setup.index));
  if (endpoint == nullptr || setup.value != 0) return false;
  endpoint->halted = halted;
  return true;
}

bool Wire::interface_is_there(const Setup& setup) const {
  for (std::size_t i = 0; i + 2 < configuration_.size(); i += configuration_[i]) {
    if (configuration_[i] == 0) return false;
    if (configuration_[i + 1] == kOfInterface && configuration_[i + 2] == (setup.index & 0xff))
      return true;
  }
  return false;
}

}  // namespace hapticd::sim::usb
