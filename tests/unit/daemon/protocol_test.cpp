#include "daemon/protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace hapticd::daemon {
namespace {

using testing::HasSubstr;

std::string refusal(std::string_view message) {
  const auto request = parse_request(message);
  return request ? "accepted" : request.error().text;
}

TEST(Protocol, EveryVerbSurvivesTheWayThere) {
  for (std::size_t i = 0; i < kVerbNames.size(); ++i) {
    const auto verb = static_cast<Verb>(i);
    const auto parsed = parse_request(format_request({verb, verb == Verb::enable}));
    ASSERT_TRUE(parsed) << parsed.error().text;
    EXPECT_EQ(parsed->verb, verb);
    EXPECT_EQ(parsed->unproven, verb == Verb::enable);
  }
}

TEST(Protocol, AnotherVersionIsRefusedNamingBoth) {
  EXPECT_THAT(refusal(R"({"v":2,"verb":"status"})"), HasSubstr("\"v\": 1, found 2"));
  EXPECT_THAT(refusal(R"({"verb":"status"})"), HasSubstr("found none"));
}

TEST(Protocol, AnUnknownVerbIsRefusedNamingTheKnownOnes) {
  const std::string text = refusal(R"({"v":1,"verb":"stop"})");
  EXPECT_THAT(text, HasSubstr("status, enable, disable, estop, reload"));
  EXPECT_THAT(text, HasSubstr("\"stop\""));
  EXPECT_THAT(refusal(R"({"v":1})"), HasSubstr("found none"));
  EXPECT_THAT(refusal(R"({"v":1,"verb":3})"), HasSubstr("found 3"));
}

TEST(Protocol, AMisspeltKeyIsNotAPlainEnable) {
  EXPECT_THAT(refusal(R"({"v":1,"verb":"enable","unprooven":true})"), HasSubstr("unprooven"));
  EXPECT_THAT(refusal(R"({"v":1,"verb":"status","unproven":true})"), HasSubstr("unknown key"));
  EXPECT_THAT(refusal(R"({"v":1,"verb":"enable","unproven":"yes"})"), HasSubstr("true or false"));
}

TEST(Protocol, WhatIsNoJsonObjectIsRefusedWithAnExample) {
  for (const char* text : {"", "status", "[1,2]", "{", "\xff\xfe", "null", "{\"v\":1,}"}) {
    EXPECT_THAT(refusal(text), HasSubstr(R"({"v":1,"verb":"status"})")) << text;
  }
}

TEST(Protocol, AnOversizeMessageIsRefusedUnread) {
  EXPECT_THAT(refusal(std::string(kMaxMessageBytes + 1, '[')), HasSubstr("65536 bytes"));
}

TEST(Protocol, DeepNestingIsRefusedNotFollowed) {
  EXPECT_THAT(refusal(std::string(kMaxMessageBytes, '[')), HasSubstr("not JSON"));
}

TEST(Protocol, ARefusalOfBadUtf8IsItselfGoodJson) {
  const auto request = parse_request("{\"v\":1,\"verb\":\"\\ud800\"}");
  ASSERT_FALSE(request);
  EXPECT_TRUE(Json::accept(to_text(error_reply(request.error()))));
  EXPECT_TRUE(Json::accept(to_text(error_reply({"\xc3\x28", ExitCode::no}))));
}

TEST(Protocol, AnErrorReplyCarriesTheExitCode) {
  const Json json = error_reply({"no", ExitCode::try_again});
  EXPECT_EQ(json["ok"], false);
  EXPECT_EQ(json["code"], 75);
  EXPECT_EQ(json["error"], "no");
}

}  // namespace
}  // namespace hapticd::daemon
