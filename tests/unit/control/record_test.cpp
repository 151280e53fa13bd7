#include "control/record.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

template <class T>
T read(const std::vector<std::byte>& record, std::uint32_t offset) {
  T value;
  std::memcpy(&value, record.data() + offset, sizeof value);
  return value;
}

TEST(Record, ArraysFollowTheHeaderWithoutOverlap) {
  const RecordLayout layout = build::Program(test::spec_of(3)).plan().record;
  EXPECT_EQ(layout.raw.offset, sizeof(RecordHeader));
  EXPECT_EQ(layout.age_ns.offset, layout.raw.offset + 3 * 8);
  EXPECT_EQ(layout.drive_faults.offset, layout.aux.offset + sizeof(Aux));
  EXPECT_EQ(layout.drive_limits.offset, layout.drive_faults.offset + 3 * 4);
  EXPECT_EQ(layout.freshness.offset, layout.drive_limits.offset + 3 * 2);
  EXPECT_EQ(layout.bytes % 8, 0u);
  EXPECT_GE(layout.bytes, layout.freshness.offset + 3);
}

TEST(Record, HoldsWhatTheTickSawAndSaid) {
  auto spec = test::spec_of(2);
  spec.planes = {test::wall(1000, 0, 2)};
  test::Rig rig(spec);
  rig.enable_at(-0.002);
  rig.samples[1].age_ns = 77;
  rig.samples[1].drive_faults = 0x01020304;
  rig.samples[1].drive_limits = 0x0506;
  rig.input.unproven = true;
  rig.samples[0].freshness = rig.samples[1].freshness = Freshness::fresh;
  const TickOutput output = control::step(rig.program.plan(), rig.program.state(), rig.input);
  const RecordLayout& at = rig.program.plan().record;
  std::vector<std::byte> record(at.bytes, std::byte{0xAA});
  write_record(rig.program.plan(), rig.program.state(), rig.input, output, 5, {.step_ns = 9}, 42,
               record.data());

  const auto header = read<RecordHeader>(record, 0);
  EXPECT_EQ(header.tick, rig.input.tick);
  EXPECT_EQ(header.time_ns, 5);
  EXPECT_EQ(header.phases.step_ns, 9);
  EXPECT_EQ(header.sequence, 42u);
  EXPECT_EQ(header.mode, Mode::enabled);
  EXPECT_EQ(header.flags, 1 | 4);
  EXPECT_EQ(header.ramp, 1.0);
  EXPECT_EQ(read<double>(record, at.raw.offset), test::Rig::raw(-0.002));
  EXPECT_EQ(read<std::int64_t>(record, at.age_ns.offset + 8), 77);
  EXPECT_EQ(read<std::uint32_t>(record, at.drive_faults.offset + 4), 0x01020304u);
  EXPECT_EQ(read<std::uint16_t>(record, at.drive_limits.offset + 2), 0x0506);
  EXPECT_NEAR(read<double>(record, at.q.offset), -0.002, 1e-15);
  EXPECT_NEAR(read<double>(record, at.effort.offset), 2.0, 1e-12);
  EXPECT_NEAR(read<double>(record, at.scene_force.offset), 2.0, 1e-12);
  EXPECT_EQ(read<Freshness>(record, at.freshness.offset + 1), Freshness::fresh);
  EXPECT_EQ(read<std::uint8_t>(record, at.homed.offset + 1), 1);
  for (std::uint32_t i = at.homed.offset + 2; i < at.bytes; ++i)
    EXPECT_EQ(record[i], std::byte{0}) << "padding";
}

}  // namespace
}  // namespace hapticd::control
