#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/config/config_sources.h"
#include "common/measurement/calibration.h"
#include "common/measurement/standstill.h"
#include "common/support/input_error.h"

namespace duet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StrEq;
using testing::ThrowsMessage;

enum class Solver { kDense, kSparse };

struct InnerOptions {
  bool enabled = true;
  std::vector<double> weights = {1.0, 0.5};

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("enabled", &enabled, {.doc = "Use it."});
    v.Field("weights", &weights, {.doc = "Weights.", .min = 0});
  }
};

struct TestOptions {
  int window = 11;
  double noise_px = 1.0;
  std::string name = "a b";
  std::vector<int> cameras = {0};
  Solver solver = Solver::kDense;
  InnerOptions inner;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("window", &window, {.doc = "Frames in the window.", .min = 2, .max = 100});
    v.Field("noise_px", &noise_px, {.doc = "Noise.", .unit = "px", .min = 1e-3});
    v.Field("name", &name, {.doc = "A name."});
    v.Field("cameras", &cameras, {.doc = "Cameras.", .min = 0});
    v.Choice("solver", &solver, {{"dense", Solver::kDense}, {"sparse", Solver::kSparse}},
             {.doc = "The solver."});
    v.Group("inner", &inner, "What is inside.");
  }
};

struct NoOptions {
  template <class Visitor>
  void Visit(Visitor&) {}
};

TestOptions ReadFrom(ConfigSources* sources) {
  TestOptions options;
  sources->Read("msckf", &options);
  sources->CheckAllKeysUsed();
  return options;
}

TestOptions ReadText(const std::string& yaml) {
  ConfigSources sources;
  sources.AddText(yaml, "f.yaml");
  return ReadFrom(&sources);
}

TestOptions ReadOverride(const std::string& assignment) {
  ConfigSources sources;
  sources.AddOverride(assignment);
  return ReadFrom(&sources);
}

TEST(Config, DefaultsThenFilesThenCommandLine) {
  ConfigSources sources;
  sources.AddOverride("msckf.window=15");
  sources.AddText("msckf:\n  window: 12\n  noise_px: 2\n  solver: sparse\n", "first.yaml");
  sources.AddOverride("msckf.inner.weights=[3, 4.5]");
  sources.AddText("msckf:\n  noise_px: 1.5\n", "second.yaml");
  const TestOptions options = ReadFrom(&sources);
  EXPECT_EQ(options.window, 15);
  EXPECT_EQ(options.noise_px, 1.5);
  EXPECT_EQ(options.solver, Solver::kSparse);
  EXPECT_EQ(options.name, "a b");
  EXPECT_THAT(options.inner.weights, ElementsAre(3, 4.5));
  ASSERT_EQ(sources.values().size(), 7U);
  EXPECT_EQ(sources.values()[0].origin, "command line");
  EXPECT_EQ(sources.values()[1].origin, "second.yaml:2");
  EXPECT_EQ(sources.values()[2].origin, "default");
  EXPECT_EQ(sources.values()[4].origin, "first.yaml:4");
}

TEST(Config, ReadsEveryType) {
  const TestOptions options = ReadText(
      "msckf: {window: 2, noise_px: 1e-3, name: 'true', cameras: [1, 0], solver: sparse,\n"
      "  inner: {enabled: false, weights: []}}\n");
  EXPECT_EQ(options.window, 2);
  EXPECT_EQ(options.noise_px, 1e-3);
  EXPECT_EQ(options.name, "true");
  EXPECT_THAT(options.cameras, ElementsAre(1, 0));
  EXPECT_FALSE(options.inner.enabled);
  EXPECT_TRUE(options.inner.weights.empty());
}

struct BadConfig {
  std::string yaml;
  std::string message;
};
class RefusedConfig : public testing::TestWithParam<BadConfig> {};

TEST_P(RefusedConfig, NamesFileLineKeyAndWhatWasExpected) {
  EXPECT_THAT([] { (void)ReadText(GetParam().yaml); },
              ThrowsMessage<InputError>(StrEq(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Config, RefusedConfig,
    testing::Values(
        BadConfig{"msckf:\n  windwo: 3\n",
                  "f.yaml:2: msckf.windwo: unknown key; did you mean 'window'?"},
        BadConfig{"mskf:\n  window: 3\n", "f.yaml:1: mskf: unknown key; did you mean 'msckf'?"},
        BadConfig{"window: 3\n", "f.yaml:1: window: unknown key; did you mean 'msckf.window'?"},
        BadConfig{"msckf:\n  zzzzzzzz: 3\n", "f.yaml:2: msckf.zzzzzzzz: unknown key"},
        BadConfig{"msckf:\n  window: 3\n  window: 4\n",
                  "f.yaml:3: window: repeated key; it stands in line 2 too"},
        BadConfig{"msckf:\n  window: 3.5\n",
                  "f.yaml:2: msckf.window: expected an integer from 2 to 100, got '3.5'"},
        BadConfig{"msckf:\n  window: 101\n",
                  "f.yaml:2: msckf.window: expected an integer from 2 to 100, got '101'"},
        BadConfig{"msckf:\n  window:\n",
                  "f.yaml:2: msckf.window: expected an integer from 2 to 100, got nothing"},
        BadConfig{"msckf:\n  noise_px: 0\n",
                  "f.yaml:2: msckf.noise_px: expected a number of at least 0.001 [px], got '0'"},
        BadConfig{"msckf:\n  noise_px: .nan\n",
                  "f.yaml:2: msckf.noise_px: expected a number of at "
                  "least 0.001 [px], got '.nan'"},
        BadConfig{"msckf:\n  inner:\n    enabled: yes\n",
                  "f.yaml:3: msckf.inner.enabled: expected true or false, got 'yes'"},
        BadConfig{"msckf:\n  inner:\n    weights: [1, -1]\n",
                  "f.yaml:3: msckf.inner.weights: expected a list of numbers, each of at least 0, "
                  "got a list of 2"},
        BadConfig{"msckf:\n  solver: densse\n",
                  "f.yaml:2: msckf.solver: expected one of dense, sparse, got 'densse'"},
        BadConfig{"msckf: 5\n", "f.yaml:1: msckf: expected keys with values, got '5'"},
        BadConfig{"msckf:\n  inner: [1]\n",
                  "f.yaml:2: msckf.inner: expected keys with values, got a list of 1"},
        BadConfig{"- a\n", "f.yaml:1: expected keys with values, got a list of 1"}));

TEST(Config, RefusedOverridesNameTheOverride) {
  EXPECT_THAT([] { (void)ReadOverride("msckf.windwo=3"); },
              ThrowsMessage<InputError>(StrEq("--set msckf.windwo=3: msckf.windwo: unknown key; "
                                              "did you mean 'window'?")));
  EXPECT_THAT([] { (void)ReadOverride("msckf.window=x"); },
              ThrowsMessage<InputError>(StrEq("--set msckf.window=x: msckf.window: expected an "
                                              "integer from 2 to 100, got 'x'")));
  EXPECT_THAT([] { (void)ReadOverride("msckf.window"); },
              ThrowsMessage<InputError>(HasSubstr("expected KEY=VALUE")));
  EXPECT_THAT([] { (void)ReadOverride("msckf..window=3"); },
              ThrowsMessage<InputError>(HasSubstr("empty key")));
  EXPECT_THAT([] { (void)ReadOverride("=3"); }, ThrowsMessage<InputError>(HasSubstr("empty key")));
}

TEST(Config, AnEmptyFileAndAnEmptySectionChangeNothing) {
  EXPECT_EQ(ReadText("").window, 11);
  EXPECT_EQ(ReadText("msckf:\n").window, 11);
  EXPECT_EQ(ReadText("msckf:\n  inner:\n").window, 11);
}

TEST(Config, AWrongValueIsRefusedThoughALaterSourceOverridesIt) {
  ConfigSources sources;
  sources.AddText("msckf:\n  window: many\n", "f.yaml");
  sources.AddOverride("msckf.window=3");
  EXPECT_THROW((void)ReadFrom(&sources), InputError);
}

TEST(Config, TheResolvedConfigurationReadsBackToTheSame) {
  ConfigSources sources;
  sources.AddText("msckf: {noise_px: 0.1, name: \"a \\\"#: b\\n\", solver: sparse}\n", "f.yaml");
  NoOptions none;
  sources.Read("window", &none);
  const TestOptions options = ReadFrom(&sources);
  const std::string yaml = sources.ResolvedYaml();
  EXPECT_THAT(yaml, HasSubstr("  noise_px: 0.1  # f.yaml:1 [px]\n"));
  EXPECT_THAT(yaml, HasSubstr("  window: 11  # default\n"));
  EXPECT_THAT(yaml, HasSubstr("    weights: [1, 0.5]  # default\n"));

  ConfigSources again;
  again.AddText(yaml, "config.yaml");
  again.Read("window", &none);
  const TestOptions same = ReadFrom(&again);
  EXPECT_EQ(same.name, options.name);
  EXPECT_EQ(same.noise_px, options.noise_px);
  EXPECT_EQ(again.SettingsSha256(), sources.SettingsSha256());
}

TEST(Config, TheHashIsOfTheValuesNotOfTheirOrigin) {
  ConfigSources defaults;
  (void)ReadFrom(&defaults);
  ConfigSources written_out;
  written_out.AddText("msckf: {window: 11, noise_px: 1.0}\n", "f.yaml");
  (void)ReadFrom(&written_out);
  ConfigSources other;
  other.AddOverride("msckf.window=12");
  (void)ReadFrom(&other);
  EXPECT_EQ(defaults.SettingsSha256(), written_out.SettingsSha256());
  EXPECT_NE(defaults.SettingsSha256(), other.SettingsSha256());
}

TEST(Config, ExplainsAKeyASectionAndWhatIsUnknown) {
  ConfigSources sources;
  sources.AddOverride("msckf.noise_px=2");
  (void)ReadFrom(&sources);
  EXPECT_EQ(sources.Explain("msckf.window"),
            "msckf.window: Frames in the window.\n    an integer from 2 to 100, default 11\n");
  EXPECT_EQ(sources.Explain("msckf.noise_px"),
            "msckf.noise_px: Noise.\n    a number of at least 0.001 [px], default 1, in force 2 "
            "(command line)\n");
  EXPECT_THAT(sources.Explain("msckf.inner"),
              testing::AllOf(HasSubstr("msckf.inner: What is inside."), HasSubstr("weights"),
                             Not(HasSubstr("window"))));
  EXPECT_THAT(sources.Explain(""), HasSubstr("msckf.solver"));
  EXPECT_THAT([&] { (void)sources.Explain("msckf.windwo"); },
              ThrowsMessage<InputError>(HasSubstr("did you mean 'msckf.window'?")));
  EXPECT_THAT([&] { (void)sources.Explain("window"); },
              ThrowsMessage<InputError>(HasSubstr("did you mean 'msckf.window'?")));
}

struct RequiredOptions {
  double density = 0.0;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("density", &density, {.doc = "Noise.", .min = 0, .required = true});
  }
};

TEST(Config, AMissingKeyWithoutDefaultIsRefused) {
  ConfigSources sources;
  sources.AddText("imu:\n", "f.yaml");
  RequiredOptions options;
  EXPECT_THAT([&] { sources.Read("imu", &options); },
              ThrowsMessage<InputError>(StrEq("f.yaml: imu.density: is missing and has no default; "
                                              "expected a number of at least 0")));
}

TEST(Config, TheOptionsOfTheMeasurementModelReadAndDump) {
  ConfigSources sources;
  sources.AddText("shared:\n  calibration:\n    t_d: {state: estimated, sigma: 0.003}\n", "f.yaml");
  CalibrationPriors priors;
  sources.Read("shared.calibration", &priors);
  StandstillOptions standstill;
  sources.Read("shared.standstill", &standstill);
  sources.CheckAllKeysUsed();
  EXPECT_TRUE(priors.t_d.estimated);
  EXPECT_EQ(priors.t_d.sigma, 0.003);
  EXPECT_FALSE(priors.t_r.estimated);
  for (const ResolvedValue& value : sources.values()) EXPECT_FALSE(value.doc.empty()) << value.key;
}

}  // namespace
}  // namespace duet
