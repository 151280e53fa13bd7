#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/stability_gate.h"

namespace hapticd::daemon {
namespace {

using config::Require;
using testing::HasSubstr;
using Answer = Gate::Answer;

Gate gate(Require require, bool only_simulated, bool second_proved) {
  return decide(require, only_simulated,
                {{.proved = true, .why = "0.6 < 1.1 N s/m"},
                 {.proved = second_proved, .why = "no model given"}},
                {"left", "right"});
}

TEST(StabilityGate, IsOpenWhereEveryDeviceIsProved) {
  for (const Require require : {Require::passive, Require::none}) {
    for (const bool simulated : {false, true})
      EXPECT_EQ(gate(require, simulated, true).answer, Answer::open);
  }
}

TEST(StabilityGate, PassiveIsClosedToAnythingUnproved) {
  for (const bool simulated : {false, true}) {
    const Gate closed = gate(Require::passive, simulated, false);
    EXPECT_EQ(closed.answer, Answer::closed);
    EXPECT_FALSE(closed.permits(false));
    EXPECT_FALSE(closed.permits(true));
  }
}

TEST(StabilityGate, NoneIsSilentOnlyForSimulatedDevices) {
  EXPECT_EQ(gate(Require::none, true, false).answer, Answer::open);
  const Gate real = gate(Require::none, false, false);
  EXPECT_EQ(real.answer, Answer::needs_unproven);
  EXPECT_FALSE(real.permits(false));
  EXPECT_TRUE(real.permits(true));
}

TEST(StabilityGate, RobustIsOpenWhereEveryDeviceIsPassiveOrRobust) {
  const auto robust = [](bool left, bool right, bool second_passive) {
    return decide(Require::robust, true,
                  {{.proved = true, .why = ""}, {.proved = second_passive, .why = ""}},
                  {"left", "right"}, {{left, "a"}, {right, "b"}});
  };
  EXPECT_EQ(robust(false, true, false).answer, Answer::open);
  EXPECT_EQ(robust(false, false, true).answer, Answer::open);
  const Gate closed = robust(true, false, false);
  EXPECT_EQ(closed.answer, Answer::closed);
  EXPECT_FALSE(closed.permits(true));
  EXPECT_THAT(closed.explanation(), HasSubstr("right: robust: b"));
  // Nothing was looked at: nothing is proved.
  EXPECT_FALSE(gate(Require::robust, true, false).permits(true));
}

TEST(StabilityGate, SaysWhyDeviceByDevice) {
  const std::string text = gate(Require::passive, true, false).explanation();
  EXPECT_THAT(text, HasSubstr("forces stay off"));
  EXPECT_THAT(text, HasSubstr("left: passive, proved: 0.6 < 1.1 N s/m"));
  EXPECT_THAT(text, HasSubstr("right: not proved: no model given"));
}

TEST(StabilityGate, AnOpenGateWithoutAProofDoesNotClaimOne) {
  const Gate open = gate(Require::none, true, false);
  EXPECT_FALSE(open.proved());
  EXPECT_THAT(open.verdict, HasSubstr("nothing is proved"));
}

}  // namespace
}  // namespace hapticd::daemon
