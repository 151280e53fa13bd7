#include "daemon/waiting.h"

#include <gmock/gmock.h>

namespace hapticd::daemon {
namespace {

using control::HomingBy;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

build::ProgramSpec one_axis() {
  build::ProgramSpec spec;
  spec.device_names = {"left"};
  spec.axis_names = {"left.x"};
  return spec;
}

LiveView seen(bool homed, std::uint32_t digital = 0) {
  return {.known = true, .homed = {homed}, .digital = {digital}};
}

std::vector<std::string> unhomed(HomingBy by, double effort) {
  build::ProgramSpec spec = one_axis();
  spec.homings = {{.axis = 0, .by = by, .effort = effort}};
  return waiting_for(spec, seen(false));
}

TEST(WaitingFor, NothingWhenAllIsWell) {
  EXPECT_THAT(waiting_for(one_axis(), seen(true)), IsEmpty());
  EXPECT_THAT(waiting_for(one_axis(), {}), IsEmpty()) << "no record yet";
}

TEST(WaitingFor, NamesTheBitOfADeadManThatIsNotHeld) {
  build::ProgramSpec spec = one_axis();
  spec.enable_inputs = {{.device = 0, .mask = 0b101, .active = 0b001}};
  EXPECT_THAT(waiting_for(spec, seen(true, 0b001)), IsEmpty());
  EXPECT_THAT(waiting_for(spec, seen(true, 0b011)), IsEmpty()) << "bit 1 is not asked about";
  EXPECT_THAT(waiting_for(spec, seen(true, 0b100)),
              ElementsAre(HasSubstr("dead-man: left bit 0 is 0 and has to be 1"),
                          HasSubstr("dead-man: left bit 2 is 1 and has to be 0")));
}

TEST(WaitingFor, AnEmergencyStopIsNamedAsSuch) {
  build::ProgramSpec spec = one_axis();
  spec.enable_inputs = {{.device = 0, .mask = 0b10, .active = 0b10, .estop = true}};
  EXPECT_THAT(waiting_for(spec, seen(true)),
              ElementsAre(AllOf(HasSubstr("e-stop: left bit 1"), HasSubstr("hapticctl enable"))));
}

TEST(WaitingFor, EachWayOfHomingSaysWhatToDo) {
  EXPECT_THAT(unhomed(HomingBy::device, 0), ElementsAre(HasSubstr("its own reference run")));
  EXPECT_THAT(unhomed(HomingBy::index, 0), ElementsAre(HasSubstr("by hand over its index")));
  EXPECT_THAT(unhomed(HomingBy::hard_stop, 0), ElementsAre(HasSubstr("by hand to its stop")));
  EXPECT_THAT(unhomed(HomingBy::index, 1),
              ElementsAre(HasSubstr("`hapticctl enable` moves it slowly to its index")));
  EXPECT_THAT(unhomed(HomingBy::hard_stop, -1),
              ElementsAre(HasSubstr("`hapticctl enable` moves it slowly to its stop")));
  EXPECT_THAT(waiting_for(one_axis(), seen(false)),
              ElementsAre(HasSubstr("left.x is not homed: its encoder has given no value yet")));
}

}  // namespace
}  // namespace hapticd::daemon
