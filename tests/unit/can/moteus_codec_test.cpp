#include "drivers/can/moteus_codec.h"

#include <cmath>
#include <map>
#include <random>

#include "tests/unit/can/vectors.h"

namespace hapticd::can::moteus {
namespace {

std::optional<Format> format_of(const std::string& word) {
  if (word == "int8") return Format::int8;
  if (word == "int16") return Format::int16;
  if (word == "int32") return Format::int32;
  if (word == "float") return Format::real;
  return std::nullopt;
}

using Fields = std::vector<std::pair<const char*, Register>>;
const Fields kQuery{{"mode", Register::mode},         {"position", Register::position},
                    {"velocity", Register::velocity}, {"torque", Register::torque},
                    {"voltage", Register::voltage},   {"temperature", Register::temperature},
                    {"fault", Register::fault}};
const Fields kPosition{{"position", Register::command_position},
                       {"velocity", Register::command_velocity},
                       {"feedforward_torque", Register::feedforward_torque},
                       {"kp_scale", Register::kp_scale},
                       {"kd_scale", Register::kd_scale},
                       {"maximum_torque", Register::maximum_torque},
                       {"watchdog_timeout", Register::watchdog_timeout},
                       {"ilimit_scale", Register::ilimit_scale}};
const Fields kWithin{{"lower", Register::within_lower},
                     {"upper", Register::within_upper},
                     {"feedforward_torque", Register::within_feedforward_torque},
                     {"maximum_torque", Register::within_maximum_torque},
                     {"watchdog_timeout", Register::within_watchdog_timeout}};

Address address_of(const Json& vector) {
  return {.servo = vector["servo_id"], .source = vector["source"], .prefix = vector["prefix"]};
}

void write_fields(Writer& writer, const Json& vector, const Fields& fields) {
  for (const auto& [name, which] : fields) {
    const std::string all = vector.value("format_all", "");
    const auto format = format_of(all.empty() ? vector["format"][name].get<std::string>() : all);
    if (format) writer.write(which, *format, number(vector["command"][name]));
  }
}

TEST(MoteusCodec, EncodesEveryVector) {
  int seen = 0;
  for (const Json& vector : vectors()["moteus"]["encode"]) {
    SCOPED_TRACE(vector.dump());
    const std::string op = vector["op"];
    Writer writer(to_servo(address_of(vector), vector["reply"]));
    if (op == "stop") writer.write(Register::mode, Format::int8, 0);
    if (op == "position") {
      writer.write(Register::mode, Format::int8, 10);
      write_fields(writer, vector, kPosition);
    }
    if (op == "stay_within_unbounded") {
      writer.write(Register::mode, Format::int8, 13);
      write_fields(writer, vector, kWithin);
    }
    if (vector["query"].is_object()) {
      for (const auto& [name, which] : kQuery)
        if (const auto format = format_of(vector["query"][name])) writer.read(which, *format);
    }
    const auto frame = writer.finish();
    if (vector.value("must_refuse", false)) {
      EXPECT_FALSE(frame);
      continue;
    }
    ASSERT_TRUE(frame);
    EXPECT_EQ(writer.size(), vector["unpadded_size"].get<std::size_t>());
    expect_frame(*frame, vector);
    ++seen;
  }
  EXPECT_GE(seen, 16);
}

TEST(MoteusCodec, TheDriversOwnFramesAreThoseOfTheVectors) {
  const auto data_of = [](const char* tag, std::size_t skip) {
    for (const Json& vector : vectors()["moteus"]["encode"]) {
      if (vector["tag"] == tag && skip-- == 0) return vector["data"].get<std::string>();
    }
    return std::string();
  };
  const Query all{.motion = true, .supply = true};
  EXPECT_EQ(hex(stop({}, all).payload()), data_of("stop", 1));
  EXPECT_EQ(hex(ask({}, all).payload()), data_of("query", 0));
}

/// By hand from the register table: mode 10, position NaN and velocity 0, torque, no gains, maximum torque, watchdog, no
/// integrator; then the questions.
TEST(MoteusCodec, ATorqueIsAWholeCommandInEachFrame) {
  const TorqueCommand command{.torque_Nm = 0.25, .maximum_torque_Nm = 1, .watchdog_s = 0.1};
  const std::string sets =
      "01000a"
      "02208000"
      "0d220000803e"
      "02230000"
      "0d250000803f"
      "0d27cdcccc3d"
      "012b00";
  const std::string asks =
      "1100"
      "1d01"
      "110f";
  const std::string padding = "50505050505050505050";
  EXPECT_EQ(hex(torque_command({}, command, Query{})->payload()), sets + asks + padding);
  EXPECT_EQ(hex(torque_command({}, command, Query{.tag = 3})->payload()), sets + asks +
                                                                              "1170"
                                                                              "118202"
                                                                              "5050505050");
  TorqueCommand unbounded = command;
  unbounded.ignore_position_bounds = true;
  EXPECT_EQ(hex(torque_command({}, unbounded, Query{.settings = true})->payload()),
            sets + "012d01" + asks +
                "1d25"
                "1d27"
                "505050");
}

TEST(MoteusCodec, CommandsMadeOnceAreThoseMadeEachTime) {
  const Address address{.servo = 9, .source = 1, .prefix = 7};
  TorqueCommand command{
      .torque_Nm = 0, .maximum_torque_Nm = 3, .watchdog_s = 0.02, .ignore_position_bounds = true};
  for (const bool asks : {false, true}) {
    const TorqueCommands commands(address, command, asks);
    for (int i = 0; i < 40; ++i) {
      command.torque_Nm = std::ldexp(1 - i, i - 20);
      const auto query = asks ? std::optional(Query{.tag = i & 3}) : std::nullopt;
      EXPECT_EQ(commands.with(command.torque_Nm, i & 3), torque_command(address, command, query));
    }
    for (const double torque : {std::nan(""), double{INFINITY}, 1e39})
      EXPECT_FALSE(commands.with(torque, 0));
  }
}

TEST(MoteusCodec, AReplySaysWhichQuestionItAnswers) {
  EXPECT_EQ(decode(bytes("2100"
                         "0a"
                         "2d01"
                         "0000803f"))
                .reply.tag(),
            0);
  EXPECT_EQ(decode(bytes("217007")).reply.tag(), 1);
  EXPECT_EQ(decode(bytes("21820205")).reply.tag(), 2);
  EXPECT_EQ(decode(bytes("21700721820205")).reply.tag(), 3);
}

TEST(MoteusCodec, RefusesATorqueThatIsNoNumber) {
  const TorqueCommand good{.torque_Nm = 0, .maximum_torque_Nm = 1, .watchdog_s = 0.1};
  TorqueCommand bad = good;
  for (const double torque : {std::nan(""), double{INFINITY}, -double{INFINITY}, 1e39}) {
    bad.torque_Nm = torque;
    EXPECT_FALSE(torque_command({}, bad, {}));
  }
  // NaN would be "no watchdog", "no limit".
  bad = good;
  bad.watchdog_s = std::nan("");
  EXPECT_FALSE(torque_command({}, bad, {}));
  bad = good;
  bad.maximum_torque_Nm = std::nan("");
  EXPECT_FALSE(torque_command({}, bad, {}));
}

TEST(MoteusCodec, DecodesEveryVector) {
  const std::map<std::string, Status> words{{"ok", Status::ok},
                                            {"truncated", Status::truncated},
                                            {"unknown_subframe", Status::unknown_subframe},
                                            {"error_subframe", Status::error_subframe}};
  int seen = 0;
  for (const Json& vector : vectors()["moteus"]["decode"]) {
    SCOPED_TRACE(vector.dump());
    const auto data = bytes(vector["data"]);
    const Decoded decoded = decode(data);
    EXPECT_EQ(decoded.status, words.at(vector["status"]));
    const Reply& r = decoded.reply;
    const std::map<std::string, std::optional<double>> found{
        {"mode", r.mode},     {"position", r.position}, {"velocity", r.velocity},
        {"torque", r.torque}, {"voltage", r.voltage},   {"temperature", r.temperature},
        {"fault", r.fault}};
    const Json& present = vector["present"];
    for (const auto& [name, value] : found) {
      if (!present.contains(name)) {
        EXPECT_FALSE(value) << name;
        continue;
      }
      const double expected = number(present[name]);
      ASSERT_TRUE(value) << name;
      if (std::isnan(expected)) {
        EXPECT_TRUE(std::isnan(*value)) << name;
      } else {
        EXPECT_NEAR(*value, expected, 1e-9 * std::abs(expected)) << name;
      }
    }
    if (vector.contains("errors")) {
      ASSERT_TRUE(decoded.error);
      EXPECT_EQ(decoded.error->which, vector["errors"][0]["register"].get<std::uint32_t>());
      EXPECT_EQ(decoded.error->code, vector["errors"][0]["code"].get<std::uint32_t>());
      EXPECT_EQ(decoded.error->write, vector["errors"][0]["kind"] == "write");
    }
    ++seen;
  }
  EXPECT_GE(seen, 7);
}

TEST(MoteusCodec, IdsOfEveryVector) {
  for (const Json& vector : vectors()["moteus"]["id"]) {
    SCOPED_TRACE(vector.dump());
    const Address address = address_of(vector);
    const Frame frame = to_servo(address, vector["reply"]);
    EXPECT_EQ(frame.id, vector["can_id"].get<std::uint32_t>());
    EXPECT_EQ(frame.extended, flag(vector, "extended"));
    Frame reply{.id = vector["reply_can_id"], .extended = flag(vector, "reply_extended")};
    EXPECT_TRUE(is_reply(reply, address));
    reply.extended = !reply.extended;
    EXPECT_FALSE(is_reply(reply, address));
  }
}

TEST(MoteusCodec, WhatDoesNotFitIsNotSent) {
  Writer writer(to_servo({}, false));
  for (std::uint16_t i = 0; i < 20; ++i) writer.write(static_cast<Register>(i), Format::real, 1);
  EXPECT_FALSE(writer.finish());
}

// Cut anywhere, a reply never gives a value that the whole one does not have.
TEST(MoteusCodec, ACutReplyHasFewerValuesAndNoOthers) {
  for (const Json& vector : vectors()["moteus"]["decode"]) {
    const auto data = bytes(vector["data"]);
    const Reply whole = decode(data).reply;
    for (std::size_t size = 0; size < data.size(); ++size) {
      const Reply cut = decode(std::span(data).first(size)).reply;
      const auto fewer = [](const std::optional<double>& a, const std::optional<double>& b) {
        return !a || (b && (*a == *b || std::isnan(*a)));
      };
      EXPECT_TRUE(fewer(cut.position, whole.position) && fewer(cut.torque, whole.torque) &&
                  fewer(cut.mode, whole.mode) && fewer(cut.fault, whole.fault));
    }
  }
}

TEST(MoteusCodec, EndsForAnyBytes) {
  std::mt19937 random(11);
  std::array<std::uint8_t, 64> data{};
  for (int i = 0; i < 200'000; ++i) {
    for (auto& byte : data) byte = static_cast<std::uint8_t>(random());
    const std::size_t size = random() % 65;
    const Decoded decoded = decode(std::span(data).first(size));
    EXPECT_LE(static_cast<int>(decoded.status), 3);
  }
}

}  // namespace
}  // namespace hapticd::can::moteus
