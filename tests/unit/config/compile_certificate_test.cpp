// A designed coupling file against the config in force.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "config/digest.h"
#include "config/write_yaml.h"
#include "control/design/check/certificate.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

const std::string kCoupled = kSmall + "coupling: {file: c.yaml}\n";
const std::string kBlocks = "blocks: [{contacts: [left], stiffness_N_m: 500}]\n";

class DesignedFile : public ::testing::Test {
 protected:
  DesignedFile() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "hapticd_designed_XXXXXX").string();
    directory_ = ::mkdtemp(pattern.data());
    write("c.yaml", kBlocks);
    const Compiled plain = load_config(kCoupled);
    file_.blocks = plain.document.config.coupling->blocks;
    file_.assumed = assumptions(plain);
    file_.certificate = CouplingCertificate{.P = {{1, 0.5}, {0.5, 2}}};
  }
  ~DesignedFile() override { std::filesystem::remove_all(directory_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return (directory_ / name).string();
  }
  Compiled load_config(const std::string& text) const {
    auto compiled = load(write("world.yaml", text));
    EXPECT_TRUE(compiled) << listed(compiled ? std::vector<ConfigError>{} : compiled.error());
    return compiled ? std::move(*compiled) : Compiled{};
  }
  /// With its digest.
  std::string written() const {
    CouplingFile file = file_;
    file.digest.reset();
    const std::string text = to_yaml(file);
    return text + "digest: \"" + digest_of(text) + "\"\n";
  }
  Compiled compiled(const std::string& config = kCoupled) const {
    write("c.yaml", written());
    return load_config(config);
  }
  void expect_refused(const Compiled& compiled, const std::string& words) const {
    EXPECT_EQ(compiled.certificate, nullptr);
    EXPECT_NE(compiled.certificate_problem.find(words), std::string::npos)
        << compiled.certificate_problem << "\nhas no: " << words;
    EXPECT_NE(compiled.certificate_problem.find("c.yaml"), std::string::npos);
  }

  std::filesystem::path directory_;
  CouplingFile file_;
};

TEST_F(DesignedFile, CountsForTheConfigItWasDesignedFor) {
  const Compiled made = compiled();
  EXPECT_EQ(made.certificate_problem, "");
  ASSERT_NE(made.certificate, nullptr);
  EXPECT_EQ(made.certificate->P(1, 0), 0.5);
  EXPECT_EQ(made.certificate->P(1, 1), 2);
  EXPECT_EQ(made.certificate->Phi_scene.size(), 0);
}

TEST_F(DesignedFile, PlainFileHasNoCertificateAndNoProblem) {
  write("c.yaml", kBlocks);
  const Compiled made = load_config(kCoupled);
  EXPECT_EQ(made.certificate, nullptr);
  EXPECT_EQ(made.certificate_problem, "");
}

TEST_F(DesignedFile, AnyEditByHandIsNamed) {
  const std::string text = written();
  for (std::size_t at = 0; at + 1 < text.size(); at += 7) {
    std::string edited = text;
    if (edited[at] < '0' || edited[at] > '8') continue;
    edited[at] = static_cast<char>(edited[at] + 1);
    write("c.yaml", edited);
    const auto made = load(write("world.yaml", kCoupled));
    if (!made) continue;  // the edit made no sense at all: refused with its place
    expect_refused(*made, "was changed after it was designed");
  }
}

TEST_F(DesignedFile, MissingPartsAreNamed) {
  file_.assumed.reset();
  expect_refused(compiled(), "assumed");
}

TEST_F(DesignedFile, AnotherRateIsRefused) {
  expect_refused(compiled(replaced(kCoupled, "rate_Hz: 1000", "rate_Hz: 999")),
                 "loop.rate_Hz was 1000");
}

TEST_F(DesignedFile, MoreLatencyIsRefusedAndLessIsNot) {
  file_.assumed->devices[0].latency_s = 1e-4;
  EXPECT_NE(compiled().certificate, nullptr);
  expect_refused(compiled(replaced(kCoupled, "latency_s: 0", "latency_s: 0.0002")),
                 "left.latency_s was 0.0001");
}

TEST_F(DesignedFile, LessDampingIsRefusedAndMoreIsNot) {
  EXPECT_NE(compiled(replaced(kCoupled, "damping_Ns_m: 1.37", "damping_Ns_m: 1.38")).certificate,
            nullptr);
  expect_refused(compiled(replaced(kCoupled, "damping_Ns_m: 1.37", "damping_Ns_m: 1.36")),
                 "least damping of axis 0 of left");
}

TEST_F(DesignedFile, AnotherEstimatorOrObserverIsRefused) {
  expect_refused(
      compiled(replaced(
          kCoupled, "actuator: {max_force_N: 8}",
          "actuator: {max_force_N: 8}\n        velocity: {estimator: low_pass, cutoff_Hz: 40}")),
      "velocity estimators of left");
}

TEST_F(DesignedFile, AnotherSceneIsRefusedWhereTheProofIsAboutOneScene) {
  const std::string other = replaced(kCoupled, "stiffness_N_m: 1000", "stiffness_N_m: 1001");
  EXPECT_NE(compiled(other).certificate, nullptr) << "closed forms hold for any scene";
  file_.certificate->kind = check::CertificateKind::sampled_exact;
  expect_refused(compiled(other), "the scene is another");
}

TEST_F(DesignedFile, AnotherDeviceIsRefused) {
  file_.assumed->devices[0].name = "right";
  expect_refused(compiled(), "a device was right");
}

TEST_F(DesignedFile, RaggedMatrixFitsNowhere) {
  file_.certificate->P = {{1, 2}, {3}};
  const Compiled made = compiled();
  ASSERT_NE(made.certificate, nullptr);
  EXPECT_NE(made.certificate->P.rows(), made.certificate->P.cols());
}

}  // namespace
}  // namespace hapticd::config::test
