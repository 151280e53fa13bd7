// model: {file: ...}: what it stands for, what is refused and where, and that a measured delay counts.
#include <filesystem>

#include "config/write_yaml.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

constexpr const char* kModelInline =
    "model: {mass_kg: 0.05, damping_Ns_m: 1.37, damping_uncertainty: 0.2}";

/// Of an axis, as identify writes it.
ModelFile identified_model() {
  return {.model = {.mass_kg = 0.0512345678901234,
                    .damping_Ns_m = 1.41,
                    .coulomb_N = 0.02,
                    .mass_uncertainty = 0.001,
                    .damping_uncertainty = 0.01},
          .measured = Measurement{.device = "left",
                                  .axis = "x",
                                  .at = "2026-01-02T03:04:05Z",
                                  .method = Excited::chirp,
                                  .rate_Hz = 1000,
                                  .duration_s = 20,
                                  .from_Hz = 2,
                                  .to_Hz = 50,
                                  .least_coherence = 0.99,
                                  .max_force_N = 3,
                                  .delay_s = 0.0003,
                                  .delay_uncertainty_s = 0.00001,
                                  .coulomb_uncertainty = 0.05,
                                  .residual_counts = 0.6}};
}

class ConfigModelFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "hapticd_model_XXXXXX").string();
    directory_ = ::mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
    return (directory_ / name).string();
  }
  /// The small config with this model.
  Checked<Compiled> with_model(const std::string& model, const std::string& latency_s = "0.001") {
    const std::string text = replaced(kSmall, kModelInline, "model: " + model);
    return load(write("config.yaml", replaced(text, "latency_s: 0", "latency_s: " + latency_s)));
  }
  ConfigError only_error(const Checked<Compiled>& compiled) const {
    if (compiled || compiled.error().size() != 1) {
      ADD_FAILURE() << (compiled ? "no error" : listed(compiled.error()));
      return {};
    }
    return compiled.error().front();
  }

  std::filesystem::path directory_;
};

TEST_F(ConfigModelFile, StandsForTheModelItself) {
  write("x.yaml", to_yaml(identified_model()));
  const auto compiled = with_model("{file: x.yaml}");
  ASSERT_TRUE(compiled) << listed(compiled.error());
  EXPECT_EQ(compiled->document.config.devices[0].axes[0].model, identified_model().model);
  EXPECT_EQ(compiled->assumed[0].min_damping[0], 1.41 * (1 - 0.01));
  ASSERT_EQ(compiled->document.models.size(), 1U);
  EXPECT_EQ(compiled->document.models[0].measured, identified_model().measured);
}

// What has been compiled once is compiled again, without the file.
TEST_F(ConfigModelFile, IsReadOnce) {
  const std::string file = write("x.yaml", to_yaml(identified_model()));
  auto compiled = with_model("{file: x.yaml}");
  ASSERT_TRUE(compiled) << listed(compiled.error());
  std::filesystem::remove(file);
  EXPECT_TRUE(compile(std::move(compiled->document)));
}

TEST_F(ConfigModelFile, NeedsNoMeasurement) {
  write("x.yaml", "mass_kg: 0.05\ndamping_Ns_m: 1\n");
  EXPECT_TRUE(with_model("{file: x.yaml}", "0"));
}

TEST_F(ConfigModelFile, ThatIsNotThereIsAnErrorWhereItIsNamed) {
  const ConfigError error = only_error(with_model("{file: none.yaml}"));
  EXPECT_EQ(error.path, "devices[0].axes[0].model.file");
  EXPECT_EQ(error.line, 12);
  EXPECT_NE(error.message.find("none.yaml: "), std::string::npos) << error.message;
}

TEST_F(ConfigModelFile, HasAllFiguresOrNone) {
  write("x.yaml", "mass_kg: 0.05\ndamping_Ns_m: 1\n");
  const ConfigError error = only_error(with_model("{file: x.yaml, mass_kg: 1}"));
  EXPECT_EQ(error.path, "devices[0].axes[0].model.file");
  EXPECT_NE(error.message.find("remove them here, or the file"), std::string::npos);
}

TEST_F(ConfigModelFile, ErrorsInItAreToldInIt) {
  const std::string file = write("x.yaml", "mass_kg: 0.05\ndamping_Ns_m: -1\n");
  const ConfigError range = only_error(with_model("{file: x.yaml}"));
  EXPECT_EQ(range.file, file);
  EXPECT_EQ(range.line, 2);
  EXPECT_EQ(range.path, "damping_Ns_m");
  write("x.yaml", "inertia_kgm2: 0.05\ndamping_Ns_m: 1\n");
  const ConfigError unit = only_error(with_model("{file: x.yaml}"));
  EXPECT_EQ(unit.file, file);
  EXPECT_EQ(unit.line, 1);
  EXPECT_EQ(unit.path, "inertia_kgm2");
  write("x.yaml", "mass_kg: 0.05\ndamping_Ns_m: 1\nfile: y.yaml\n");
  EXPECT_EQ(only_error(with_model("{file: x.yaml}")).file, file);
}

// 0.3 ms +- 0.01 ms: a latency that surely is too short is refused, one within the interval is not.
TEST_F(ConfigModelFile, AMeasuredDelayHasToBeWithinTheLatency) {
  write("x.yaml", to_yaml(identified_model()));
  EXPECT_TRUE(with_model("{file: x.yaml}", "0.0003"));
  EXPECT_TRUE(with_model("{file: x.yaml}", "0.000291"));
  const ConfigError error = only_error(with_model("{file: x.yaml}", "0.0002"));
  EXPECT_EQ(error.path, "devices[0].latency_s");
  EXPECT_EQ(error.line, 7);
  for (const char* words : {"0.0003 +- 1e-05 s", "x.yaml", "found 0.0002 s", "raise it to 0.00031"})
    EXPECT_NE(error.message.find(words), std::string::npos) << error.message;
}

TEST_F(ConfigModelFile, IsReadBackAsWritten) {
  ModelFile file = identified_model();
  write("x.yaml", to_yaml(file));
  const auto compiled = with_model("{file: x.yaml}");
  ASSERT_TRUE(compiled) << listed(compiled.error());
  EXPECT_EQ(to_yaml(ModelFile{compiled->document.config.devices[0].axes[0].model.value(),
                              compiled->document.models[0].measured}),
            to_yaml(file));
}

}  // namespace
}  // namespace hapticd::config::test
