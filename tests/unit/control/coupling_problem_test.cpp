// What cannot be folded, and what people are told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/couplings.h"

namespace hapticd::test {
namespace {

using build::CouplingBlock;
using build::GroupsSpec;
using testing::HasSubstr;

TEST(CouplingProblem, SaysWhatIsWrongAndWhere) {
  const auto says = [](std::vector<CouplingBlock> blocks) {
    return build::problem(spec_of(std::move(blocks)));
  };
  const auto zero = matrix({{0, 0}, {0, 0}}), one = matrix({{1, 0}, {0, 1}});
  EXPECT_EQ(says({springs({0, 1}, matrix({{5, 1}, {2, 5}}), zero)}),
            "block 0: the stiffness is not symmetric: entry (1, 0) is 2, its mirror 1");
  EXPECT_THAT(says({springs({0, 1}, one, matrix({{5, 1}, {2, 5}}))}),
              HasSubstr("block 0: the damping is not symmetric"));
  EXPECT_THAT(
      says({spring(2, 9), springs({0, 1}, matrix({{1, 2}, {2, 1}}), zero)}),
      HasSubstr(
          "block 1: the stiffness [N/m] is not positive definite: its smallest eigenvalue is -1"));
  EXPECT_THAT(says({spring(0, 0)}), HasSubstr("not positive definite"));
  EXPECT_EQ(says({spring(0, 1000, -0.49)}), "");
  EXPECT_THAT(says({spring(0, 1000, -0.51)}), HasSubstr("make the damping less negative"));
  EXPECT_EQ(says({spring(0, 9), spring(0, 9)}),
            "block 1: coordinate 0 is in block 0 too; a coordinate has one coupling");
  EXPECT_EQ(says({springs({1, 1}, one, zero)}), "block 0: coordinate 1 is named twice");
  EXPECT_EQ(says({spring(3, 9)}), "block 0: coordinate 3 belongs to no contact");
  EXPECT_EQ(says({springs({}, {}, {})}), "block 0: it names no coordinate");
  EXPECT_EQ(says({springs({0}, one, zero)}), "block 0: the stiffness is 2 x 2; expected 1 x 1");
  EXPECT_EQ(says({spring(0, 9, NAN)}), "block 0: the damping has an entry that is not finite");
}

TEST(CouplingProblem, SaysWhatIsWrongWithAGeneralV) {
  const auto says = [](const CouplingBlock::StateSpace& v) {
    return build::problem(spec_of({general({0}, v)}));
  };
  const auto row = [](double value) { return matrix({{value}}); };
  EXPECT_EQ(says({row(0.9), row(1), row(1), row(1)}), "");
  EXPECT_EQ(says({{},
                  {.rows = 0, .columns = 1, .values = {}},
                  {.rows = 1, .columns = 0, .values = {}},
                  row(1)}),
            "");
  EXPECT_THAT(says({row(-1), row(1), row(1), row(1)}),
              HasSubstr("A is not stable: the largest eigenvalue has the size 1;"));
  EXPECT_THAT(says({row(0), row(1), row(1), row(0)}),
              HasSubstr("D [m/N] is not positive definite"));
  EXPECT_THAT(says({row(0), matrix({{1, 2}}), row(1), row(1)}),
              HasSubstr("B is 1 x 2; expected 1 x 1"));
  EXPECT_THAT(says({row(0), row(1), row(INFINITY), row(1)}),
              HasSubstr("C has an entry that is not finite"));
  EXPECT_THAT(build::problem(spec_of({general({0, 1}, {.A = {},
                                                       .B = {.rows = 0, .columns = 2, .values = {}},
                                                       .C = {.rows = 2, .columns = 0, .values = {}},
                                                       .D = matrix({{1, 0.5}, {0, 1}})})})),
              HasSubstr("D is not symmetric"));
}

TEST(CouplingProblem, SaysWhatIsWrongWithTheWhole) {
  GroupsSpec spec = spec_of({spring(0, 9)}, {lively(0, 1)});
  ASSERT_EQ(build::problem(spec), "");
  const auto says = [&](const auto& spoil) {
    GroupsSpec bad = spec;
    spoil(bad);
    return build::problem(bad);
  };
  EXPECT_EQ(says([](GroupsSpec& s) { s.period_s = 0; }), "the period is 0 s; expected more than 0");
  EXPECT_THAT(says([](GroupsSpec& s) { s.substeps = 0; }), HasSubstr("at least 1 step"));
  EXPECT_EQ(says([](GroupsSpec& s) { s.sharpen = {1}; }),
            "there are 1 latency shares for 3 contacts");
  EXPECT_THAT(says([](GroupsSpec& s) { s.networks[0].nodes[0].mass = -1; }),
              HasSubstr("network 0: node 0"));
  EXPECT_EQ(says([](GroupsSpec& s) {
              s.contacts = {{0, 1}, {2, 1}};
            }),
            "network 0: coordinate 1 belongs to no contact");
  EXPECT_THAT(says([](GroupsSpec& s) {
                for (int i = 0; i < 40; ++i) s.networks.push_back(lively(0, 1));
              }),
              HasSubstr("the contacts that are tied to contact 0: their networks have"));
}

// Exact: a mass on a spring that swings more than half a round in a tick answers a push backwards.
TEST(CouplingProblem, RefusesANetworkTooFastForItsIntegrator) {
  GroupsSpec spec =
      spec_of({spring(0, 1)},
              {{.nodes = {{.mass = 0.01}}, .elements = {element(coordinate(0), node(0), 400)}}});
  spec.period_s = 0.02;  // omega T = 4
  EXPECT_EQ(build::problem(spec), "");
  spec.integrator = build::Integrator::exact;
  EXPECT_THAT(build::problem(spec), HasSubstr("swings faster than a tick"));
}

}  // namespace
}  // namespace hapticd::test
