// Couplings, inline and from a file; networks; the hand that several devices share.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/unit/config/world_text.h"

namespace hapticd::config::test {
namespace {

build::ProgramSpec spec_of(const std::string& text) {
  const Compiled compiled = compiled_of(text);
  return compiled.program ? compiled.program->spec() : build::ProgramSpec{};
}

TEST(CompileCoupling, NumberIsForAllCoordinatesOfTheBlock) {
  const auto spec = spec_of(with_block("{contacts: [ball], stiffness_N_m: 7, damping_Ns_m: 0.5}"));
  ASSERT_EQ(spec.coupling.size(), 1U);
  EXPECT_EQ(spec.coupling[0].coordinates, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(spec.coupling[0].stiffness.values, (std::vector<double>{7, 0, 0, 0, 7, 0, 0, 0, 7}));
  EXPECT_EQ(spec.coupling[0].damping(1, 1), 0.5);
  EXPECT_EQ(spec.max_sweeps, 50);
  EXPECT_EQ(spec.solver_tolerance, 1e-10);
  EXPECT_EQ(spec.contacts.size(), 2U);
}

TEST(CompileCoupling, MatrixIsInTheOrderOfItsContacts) {
  const auto spec =
      spec_of(with_block("{contacts: [rod, ball.y], stiffness_N_m: [[5, 1], [1, 9]]}"));
  const build::CouplingBlock& block = spec.coupling.at(0);
  EXPECT_EQ(block.coordinates, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_EQ(block.stiffness.values, (std::vector<double>{9, 1, 1, 5}));
}

TEST(CompileCoupling, StateSpaceIsSortedWithItsContacts) {
  const auto spec = spec_of(with_block(
      "{contacts: [rod, ball.y], state_space: {A: [[0.5]], B: [[1, 2]], C: [[3], [4]], D: [[5, 0], "
      "[0, 6]]}}"));
  const auto& v = *spec.coupling.at(0).state_space;
  EXPECT_EQ(v.A.values, (std::vector<double>{0.5}));
  EXPECT_EQ(v.B.values, (std::vector<double>{2, 1}));
  EXPECT_EQ(v.C.values, (std::vector<double>{4, 3}));
  EXPECT_EQ(v.D.values, (std::vector<double>{6, 0, 0, 5}));
}

TEST(CompileCoupling, SlightlyNegativeDampingIsTaken) {
  // K + 2 B / T = 7 - 2 * 0.003 / 0.001 = 1 > 0
  const Compiled compiled =
      compiled_of(with_block("{contacts: [rod], stiffness_N_m: 7, damping_Ns_m: -0.003}"));
  ASSERT_EQ(compiled.assumed.size(), 2U);
  EXPECT_EQ(compiled.program->spec().coupling.at(0).damping.values, (std::vector<double>{-0.003}));
  expect_error(with_block("{contacts: [rod], stiffness_N_m: 7, damping_Ns_m: -0.004}"), "14:71",
               "coupling.blocks[0].damping_Ns_m", {"2 damping / period", "eigenvalue to be -1"});
}

TEST(CompileCoupling, BlocksAreSound) {
  expect_error(with_block("{contacts: [bal], stiffness_N_m: 7}"), "14:33",
               "coupling.blocks[0].contacts[0]", {"no device 'bal'", "did you mean 'ball'"});
  expect_error(with_block("{contacts: [rod.y], stiffness_N_m: 7}"), "14:33",
               "coupling.blocks[0].contacts[0]", {"no coordinate 'rod.y'"});
  expect_error(with_block("{contacts: [ball, ball.x], stiffness_N_m: 7}"), "14:39",
               "coupling.blocks[0].contacts[1]", {"ball.x is named twice"});
  expect_error(with_block("{contacts: [ball.x], stiffness_N_m: 7}, {contacts: [ball], "
                          "stiffness_N_m: 7}"),
               "14:72", "coupling.blocks[1].contacts", {"ball.x", "block 0"});
  expect_error(with_block("{contacts: [ball], stiffness_N_m: [1, 2]}"), "14:55",
               "coupling.blocks[0].stiffness_N_m", {"each of the 3", "found 2"});
  expect_error(with_block("{contacts: [ball.x, rod], stiffness_N_m: [[1, 2], [3, 4]]}"), "14:62",
               "coupling.blocks[0].stiffness_N_m", {"symmetric"});
  expect_error(with_block("{contacts: [ball.x, rod], stiffness_N_m: [[1, 2], [2, 1]]}"), "14:62",
               "coupling.blocks[0].stiffness_N_m", {"positive definite", "-1"});
  expect_error(with_block("{contacts: [rod]}"), "14:21", "coupling.blocks[0]", {"neither"});
  expect_error(kWorld + "coupling: {}\n", "14:11", "coupling", {"expected blocks"});
  expect_error(
      with_block("{contacts: [rod], state_space: {A: [[1]], B: [[1]], C: [[1]], D: [[1]]}}"),
      "14:56", "coupling.blocks[0].state_space.A", {"unit circle", "size 1"});
  expect_error(
      with_block("{contacts: [rod], state_space: {A: [[0]], B: [[1]], C: [[1, 2]], D: [[1]]}}"),
      "14:76", "coupling.blocks[0].state_space.C", {"1 x 1", "2 entries"});
}

TEST(CompileCoupling, LatencySharpensTheDescentCheckByTheFormula) {
  // tau = 0.4 ms, T = 1 ms; K = diag(500, 800) on damping 2: lambda = 400 1/s.
  // g = 0.4 + 0.4 * 0.0006 * 400 = 0.496
  const auto late = [](const std::string& block) {
    return spec_of(replaced(with_block(block), "]}}, latency_s: 0,", "]}}, latency_s: 0.0004,"));
  };
  const auto spring = late("{contacts: [ball.x, ball.y, rod], stiffness_N_m: [500, 800, 100]}");
  ASSERT_EQ(spring.sharpen.size(), 2U);
  EXPECT_NEAR(spring.sharpen[0], 0.496, 1e-12);
  EXPECT_EQ(spring.sharpen[1], 0) << "this device is in time";
  EXPECT_EQ(late("{contacts: [ball], stiffness_N_m: 500, damping_Ns_m: 0.1}").sharpen.at(0), 0)
      << "beyond the theorem";
}

// Coupling files.

class CouplingFiles : public ::testing::Test {
 protected:
  CouplingFiles() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "hapticd_coupling_XXXXXX").string();
    directory_ = ::mkdtemp(pattern.data());
  }
  ~CouplingFiles() override { std::filesystem::remove_all(directory_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return (directory_ / name).string();
  }
  std::vector<ConfigError> errors(const std::string& coupling) const {
    write("c.yaml", coupling);
    const auto compiled = load(write("world.yaml", kWorld + "coupling: {file: c.yaml}\n"));
    return compiled ? std::vector<ConfigError>{} : compiled.error();
  }
  std::filesystem::path directory_;
};

TEST_F(CouplingFiles, FileSaysTheSameAsTheMap) {
  write("c.yaml", "blocks: [{contacts: [rod], stiffness_N_m: 7}]\nsolver: {max_sweeps: 9}\n");
  const auto compiled = load(write("world.yaml", kWorld + "coupling: {file: c.yaml}\n"));
  ASSERT_TRUE(compiled) << listed(compiled.error());
  EXPECT_EQ(compiled->program->spec().coupling.at(0).stiffness.values, (std::vector<double>{7}));
  EXPECT_EQ(compiled->program->spec().max_sweeps, 9);
}

TEST_F(CouplingFiles, ErrorsNameTheFileAndItsLines) {
  struct Case {
    std::string text, path, words;
    int line, column;
  };
  for (const Case& wrong : {Case{"blocks:\n  - {contacts: [rot], stiffness_N_m: 7}\n",
                                 "blocks[0].contacts[0]", "did you mean 'rod'", 2, 17},
                            Case{"blocks:\n  - {contacts: [rod], stiffness_N_m: x}\n",
                                 "blocks[0].stiffness_N_m", "expected a number from", 2, 0},
                            Case{"blocks: []\nfile: d.yaml\n", "'file'", "unknown key", 2, 1},
                            Case{"solver: {}\n", "blocks", "missing", 1, 1}}) {
    const auto found = errors(wrong.text);
    ASSERT_EQ(found.size(), 1U) << wrong.text << listed(found);
    EXPECT_EQ(found[0].file, (directory_ / "c.yaml").string());
    EXPECT_EQ(found[0].line, wrong.line) << to_string(found[0]);
    if (wrong.column > 0) {
      EXPECT_EQ(found[0].column, wrong.column) << to_string(found[0]);
    }
    EXPECT_EQ(found[0].path, wrong.path);
    EXPECT_NE(found[0].message.find(wrong.words), std::string::npos) << to_string(found[0]);
  }
}

TEST_F(CouplingFiles, MissingFileIsNamedInTheConfig) {
  expect_error(kWorld + "coupling: {file: none.yaml}\n", "14:18", "coupling.file",
               {"none.yaml", "No such file"});
  expect_error(kWorld + "coupling: {file: none.yaml, solver: {max_sweeps: 1}}\n", "14:18",
               "coupling.file", {"remove them here"});
}

// Networks.

std::string with_network(const std::string& nodes, const std::string& elements) {
  return with_object("network: {name: n, nodes: [" + nodes + "], elements: [" + elements + "]}");
}

TEST(CompileNetwork, EndsAreCoordinatesNodesAndGround) {
  const auto spec = spec_of(with_network(
      "{name: m, mass_kg: 3, position_m: 0.1, load_N: -2}",
      "{between: [m, ground], stiffness_N_m: 5, damping_Ns_m: 6, rest_m: 0.2}, "
      "{between: [ball.z, m], stiffness_N_m: 4}, {between: [rod, m], damping_Ns_m: 1}"));
  const build::Network& network = spec.networks.at(0);
  using At = build::NetworkEnd::At;
  EXPECT_EQ(network.nodes.at(0).mass, 3);
  EXPECT_EQ(network.nodes[0].position, 0.1);
  EXPECT_EQ(network.nodes[0].load, -2);
  EXPECT_EQ(network.elements.at(0).a.at, At::node);
  EXPECT_EQ(network.elements[0].b.at, At::ground);
  EXPECT_EQ(network.elements[0].rest, 0.2);
  EXPECT_EQ(network.elements.at(1).a.at, At::coordinate);
  EXPECT_EQ(network.elements[1].a.index, 2U);
  EXPECT_EQ(network.elements.at(2).a.index, 3U);
  EXPECT_EQ(spec.contacts.size(), 2U);
}

TEST(CompileNetwork, NetworksAreSound) {
  const std::string m = "{name: m, mass_kg: 1}";
  const std::string felt = "{between: [rod, m], stiffness_N_m: 1}";
  expect_error(with_network(m, "{between: [rod, k], stiffness_N_m: 1}"), "15:83",
               "scene[0].network.elements[0].between[1]", {"no coordinate or node 'k'", "ground"});
  expect_error(with_network(m, "{between: [ball, m], stiffness_N_m: 1}"), "15:78",
               "scene[0].network.elements[0].between[0]", {"3 coordinates", "ball.x"});
  expect_error(with_network(m, "{between: [rod, m]}"), "15:67", "scene[0].network.elements[0]",
               {"above 0"});
  expect_error(with_network(m, "{between: [m, ground], stiffness_N_m: 1}"), "15:66",
               "scene[0].network.elements", {"nobody would feel"});
  expect_error(with_network(m, felt + ", {between: [m, m], stiffness_N_m: 1}"), "15:116",
               "scene[0].network.elements[1].between", {"the same"});
  expect_error(with_network(m + ", {name: ground}", felt), "15:62",
               "scene[0].network.nodes[1].name", {"another name"});
  expect_error(
      with_network(m + ", {name: j}, {name: k}", felt + ", {between: [j, k], stiffness_N_m: 1}"),
      "15:55", "scene[0].network.nodes[1]", {"nowhere"});
}

TEST(CompileNetwork, JointsInAChainAreHeldByTheirEnds) {
  EXPECT_TRUE(errors_of(with_network("{name: j}, {name: k}",
                                     "{between: [k, j], stiffness_N_m: 1}, {between: [rod, j], "
                                     "damping_Ns_m: 1}"))
                  .empty());
}

// The shared hand.

const std::string kHand =
    "sim: {hand: {contacts: [rod, ball.y], velocity_m_s: [1, 2], state_space: {A: [[-1]], B: [[1, "
    "2]], C: [[3], [4]], D: [[5, 6], [7, 8]]}}}\n";

TEST(CompileSharedHand, HoldsAxesInTheOrderOfItsContacts) {
  const Compiled compiled = compiled_of(kWorld + kHand);
  ASSERT_TRUE(compiled.shared_hand);
  const sim::SharedHandOptions& hand = *compiled.shared_hand;
  ASSERT_EQ(hand.axes.size(), 2U);
  EXPECT_EQ(hand.axes[0].device, 1U);
  EXPECT_EQ(hand.axes[0].axis, 0U);
  EXPECT_EQ(hand.axes[1].device, 0U);
  EXPECT_EQ(hand.axes[1].axis, 1U);
  EXPECT_EQ(hand.axes[1].velocity_m_s, 2);
  EXPECT_EQ(hand.states, 1U);
  EXPECT_EQ(hand.B, (std::vector<double>{1, 2}));
  EXPECT_EQ(hand.D, (std::vector<double>{5, 6, 7, 8}));
}

TEST(CompileSharedHand, ScaleOfADeviceKeepsTheWork) {
  const Compiled compiled =
      compiled_of(replaced(kWorld, "    pose:", "    workspace_scale: 10\n    pose:") + kHand);
  const sim::SharedHandOptions& hand = *compiled.shared_hand;
  EXPECT_DOUBLE_EQ(hand.axes[0].velocity_m_s, 0.1);
  EXPECT_EQ(hand.B, (std::vector<double>{10, 2}));
  EXPECT_EQ(hand.C, (std::vector<double>{30, 4}));
  EXPECT_EQ(hand.D, (std::vector<double>{500, 60, 70, 8}));
}

TEST(CompileSharedHand, RefusesWhatTheSimulatorDoesNotJoin) {
  expect_error(replaced(kWorld, "    pose:", "    sim: {hand: {mass_kg: 1}}\n    pose:") + kHand,
               "15:24", "sim.hand.contacts", {"'rod'", "hand of its own"});
  expect_error(
      replaced(kWorld, "    pose:", "    sim: {axes: [{coulomb_N: 1}]}\n    pose:") + kHand,
      "15:24", "sim.hand.contacts", {"dry friction"});
  expect_error(kWorld + replaced(kHand, "[1, 2],", "[1],"), "14:53", "sim.hand.velocity_m_s",
               {"each of the 2"});
  expect_error(kWorld + replaced(kHand, "[[1, 2]]", "[[1]]"), "14:89", "sim.hand.state_space.B",
               {"1 x 2"});
}

}  // namespace
}  // namespace hapticd::config::test
