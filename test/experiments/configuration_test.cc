#include "experiments/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/support/input_error.h"

namespace duet {
namespace {

using testing::HasSubstr;

TEST(ConfigurationTest, WhatIsDocumentedReadsBackToTheSameSettings) {
  ConfigSources changed;
  changed.AddOverride("shared.pixel_noise_px=0.7");
  changed.AddOverride("evaluation.relative_lengths_m=[1, 2.5]");
  changed.AddOverride("window.robust_loss=cauchy");
  Configuration configuration;
  configuration.Read(&changed);
  EXPECT_EQ(configuration.shared.pixel_noise_px, 0.7);

  ConfigSources again;
  again.AddText(DocumentedYaml(changed.values()), "documented.yaml");
  Configuration read_back;
  read_back.Read(&again);
  EXPECT_EQ(again.SettingsSha256(), changed.SettingsSha256());
}

TEST(ConfigurationTest, EveryKeyHasItsMeaningAboveIt) {
  ConfigSources sources;
  Configuration configuration;
  configuration.Read(&sources);
  const std::string text = DocumentedYaml(sources.values());
  EXPECT_THAT(text, HasSubstr("  # Standard deviation of a tracked pixel, per axis. (a number from "
                              "0.001 to 50; px)\n  pixel_noise_px: 1\n"));
  for (const ResolvedValue& value : sources.values()) EXPECT_FALSE(value.doc.empty()) << value.key;
}

TEST(ConfigurationTest, UnknownGroupsAndKeysAreRefused) {
  for (const char* assignment : {"colour.red=1", "msckf.max_clone=3"}) {
    ConfigSources sources;
    sources.AddOverride(assignment);
    Configuration configuration;
    EXPECT_THROW(configuration.Read(&sources), InputError) << assignment;
  }
}

}  // namespace
}  // namespace duet
