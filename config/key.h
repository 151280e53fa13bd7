// What can be said of one key of a config, and the words of its enumerations. config/describe.h
// says it of every key.
#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <string_view>

#include "config/schema.h"

namespace hapticd::config {

/// What a text may be.
enum class TextForm {
  any,
  name,        ///< left
  coordinate,  ///< left or left.x
  hex_pair,    ///< 0403:cb48
  usb_port,    ///< 1-2.3
  sha256,      ///< 64 hexadecimal digits
};

/// All about one key but its type, which the field has, and its default, which the struct has.
struct Key {
  const char* about = "";  ///< one line for people
  double min =
      -std::numeric_limits<double>::infinity();  ///< of a number, or of each number of a list
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  ///< `min` itself is out of range
  const char* unit = "";
  TextForm form = TextForm::any;  ///< of a text, or of each text of a list
  std::size_t min_items = 0;
  std::size_t max_items = std::numeric_limits<std::size_t>::max();
};

/// The words of an enumeration in the file, in the order of its values.
template <class E>
struct Words;
template <>
struct Words<EnableWhen> {
  static constexpr std::array<std::string_view, 2> list{"on_command", "when_ready"};
};
template <>
struct Words<AxisKind> {
  static constexpr std::array<std::string_view, 2> list{"linear", "rotary"};
};
template <>
struct Words<Excited> {
  static constexpr std::array<std::string_view, 2> list{"stepped", "chirp"};
};
template <>
struct Words<Estimator> {
  static constexpr std::array<std::string_view, 5> list{
      "backward_difference", "low_pass", "least_squares", "foaw", "alpha_beta_gamma"};
};
template <>
struct Words<ObserverMode> {
  static constexpr std::array<std::string_view, 4> list{"off", "model", "sensor", "classic"};
};
template <>
struct Words<HomingMethod> {
  static constexpr std::array<std::string_view, 4> list{"none", "device", "index", "hard_stop"};
};
template <>
struct Words<InputRole> {
  static constexpr std::array<std::string_view, 2> list{"dead_man", "estop"};
};
template <>
struct Words<Direction> {
  static constexpr std::array<std::string_view, 3> list{"x", "y", "z"};
};
template <>
struct Words<SimFailureKind> {
  static constexpr std::array<std::string_view, 7> list{"nan",    "stuck", "jump", "missing",
                                                        "disarm", "fault", "slow"};
};
template <>
struct Words<Profile> {
  static constexpr std::array<std::string_view, 2> list{"sinusoid", "groove"};
};
template <>
struct Words<FreeSide> {
  static constexpr std::array<std::string_view, 2> list{"outside", "inside"};
};
template <>
struct Words<Driver> {
  static constexpr std::array<std::string_view, 7> list{
      "sim", "odrive", "moteus", "cia402", "falcon", "hid_report", "openffboard"};
};
template <>
struct Words<UsbTransport> {
  static constexpr std::array<std::string_view, 2> list{"hidapi", "libusb"};
};
template <>
struct Words<ByteOrder> {
  static constexpr std::array<std::string_view, 2> list{"little", "big"};
};
template <>
struct Words<CanTiming> {
  static constexpr std::array<std::string_view, 3> list{"in_phase", "free_running",
                                                        "reply_to_command"};
};
template <>
struct Words<Require> {
  static constexpr std::array<std::string_view, 3> list{"passive", "robust", "none"};
};
template <>
struct Words<HoldKind> {
  static constexpr std::array<std::string_view, 7> list{
      "none", "adams_hannaford", "first_order", "second_order", "zero_order", "delay", "average"};
};
template <>
struct Words<check::CertificateKind> {
  static constexpr std::array<std::string_view, 3> list{"passive_closed_form", "passive_lmi",
                                                        "sampled_exact"};
};

/// The word for an enumeration's value.
template <class E>
constexpr std::string_view word_of(E value) {
  return Words<E>::list[static_cast<std::size_t>(value)];
}

/// The one key of a map that holds a T as one of several kinds.
template <class T>
inline constexpr const char* kKindOf = nullptr;
template <>
inline constexpr const char* kKindOf<Plane> = "plane";
template <>
inline constexpr const char* kKindOf<Texture> = "texture";
template <>
inline constexpr const char* kKindOf<Box> = "box";
template <>
inline constexpr const char* kKindOf<Sphere> = "sphere";
template <>
inline constexpr const char* kKindOf<Cylinder> = "cylinder";
template <>
inline constexpr const char* kKindOf<Capsule> = "capsule";
template <>
inline constexpr const char* kKindOf<Mesh> = "mesh";
template <>
inline constexpr const char* kKindOf<PointGuide> = "point";
template <>
inline constexpr const char* kKindOf<LineGuide> = "line";
template <>
inline constexpr const char* kKindOf<CurveGuide> = "curve";
template <>
inline constexpr const char* kKindOf<Viscous> = "viscous";
template <>
inline constexpr const char* kKindOf<Constant> = "constant";
template <>
inline constexpr const char* kKindOf<Detents> = "detents";
template <>
inline constexpr const char* kKindOf<Magnet> = "magnet";
template <>
inline constexpr const char* kKindOf<Vibration> = "vibration";
template <>
inline constexpr const char* kKindOf<Network> = "network";
template <>
inline constexpr const char* kKindOf<Cartesian> = "cartesian";
template <>
inline constexpr const char* kKindOf<FiveBar> = "five_bar";
template <>
inline constexpr const char* kKindOf<Delta> = "delta";
template <>
inline constexpr const char* kKindOf<Serial> = "serial";

}  // namespace hapticd::config
