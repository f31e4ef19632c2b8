#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"
#include "common/support/random.h"
#include "common/support/sha256.h"

namespace duet {
namespace {

TEST(NumericText, TakesOnlyWholeNumbers) {
  EXPECT_EQ(ParseDouble("-1.5e3"), -1500.0);
  EXPECT_EQ(ParseInt64("-42"), -42);
  EXPECT_EQ(ParseUint64("18446744073709551615"), 18446744073709551615ULL);
  for (const char* text : {"", " 1", "1 ", "+1", "1,5", "1.5x", "0x10", "--1", "1e", "1e999"}) {
    EXPECT_FALSE(ParseDouble(text).has_value()) << "'" << text << "'";
  }
  for (const char* text : {"", "1.0", "9223372036854775808", "1e3", " 1"}) {
    EXPECT_FALSE(ParseInt64(text).has_value()) << "'" << text << "'";
  }
  EXPECT_FALSE(ParseUint64("-1").has_value());
}

TEST(NumericText, ShortestTextReadsBackToTheSameNumber) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const double value = random.Normal() * std::pow(10.0, random.UniformInt(40) - 20);
    EXPECT_EQ(ParseDouble(FormatNumber(value)), value);
    const auto single = static_cast<float>(value);
    std::string text;
    AppendNumber(single, &text);
    EXPECT_EQ(ParseFloat(text), single);
  }
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatFixed(2.0 / 3, 3), "0.667");
}

TEST(NumericText, AFloatIsRoundedOnceFromItsText) {
  // Just above the middle between two floats, by less than a double resolves: through a double
  // this would round to the even neighbour below.
  const std::string text = "1.00000005960464477539062500000001";
  EXPECT_EQ(ParseFloat(text), std::nextafter(1.0F, 2.0F));
  EXPECT_EQ(static_cast<float>(*ParseDouble(text)), 1.0F);
}

TEST(NumericText, SecondsBecomeExactNanoseconds) {
  EXPECT_EQ(ParseSeconds("1403636583.763555584"), 1403636583763555584);
  EXPECT_EQ(ParseSeconds("1.403636583763555584e+09"), 1403636583763555584);
  EXPECT_EQ(ParseSeconds("1403636583763555584E-9"), 1403636583763555584);
  EXPECT_EQ(ParseSeconds("-0.5"), -500000000);
  EXPECT_EQ(ParseSeconds("0"), 0);
  EXPECT_EQ(ParseSeconds("000.000"), 0);
  EXPECT_EQ(ParseSeconds(".5"), 500000000);
  EXPECT_EQ(ParseSeconds("12."), 12000000000);
  EXPECT_EQ(ParseSeconds("0.0000000014"), 1);
  EXPECT_EQ(ParseSeconds("0.0000000015"), 2);
  EXPECT_EQ(ParseSeconds("0.0000000005"), 1);
  EXPECT_EQ(ParseSeconds("0.00000000049"), 0);
  EXPECT_EQ(ParseSeconds("1e-30"), 0);
  EXPECT_EQ(ParseSeconds("9223372036.854775807"), std::numeric_limits<Timestamp>::max());
  for (const char* text : {"", ".", "-", "nan", "inf", "1e", "1e+-3", "1.2.3", " 1", "1 ", "+1",
                           "9223372036.854775808", "1e12", "1e99999999999999999999"}) {
    EXPECT_FALSE(ParseSeconds(text).has_value()) << "'" << text << "'";
  }
}

TEST(NumericText, SecondsArePrintedFromTheInteger) {
  EXPECT_EQ(FormatSeconds(1403636583763555584), "1403636583.763555584");
  EXPECT_EQ(FormatSeconds(5), "0.000000005");
  EXPECT_EQ(FormatSeconds(-1500000000), "-1.500000000");
  EXPECT_EQ(FormatSeconds(std::numeric_limits<Timestamp>::min()), "-9223372036.854775808");
  EXPECT_EQ(FormatDuration(120000000), "0.12");
  EXPECT_EQ(FormatDuration(3000000000), "3");
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto t = static_cast<Timestamp>(random.Next() >> 1);
    EXPECT_EQ(ParseSeconds(FormatSeconds(t)), t);
  }
}

TEST(Sha256, GivesTheStandardsDigests) {
  // FIPS 180-2, appendix B.
  EXPECT_EQ(Sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, PiecesGiveTheDigestOfTheWhole) {
  Sha256 sha256;
  sha256.Update("a");
  sha256.Update("bc", 2);
  EXPECT_EQ(sha256.Finish(), Sha256Hex("abc"));
  sha256.Update("abc");
  EXPECT_EQ(sha256.Finish(), Sha256Hex("abc")) << "starts anew after Finish";
}

TEST(NearestName, FindsWhatAMisspellingWasMeantToBe) {
  const std::vector<std::string> names = {"window", "pixel_noise_px", "max_tracks", "gate"};
  EXPECT_EQ(NearestName("windwo", names), "window");
  EXPECT_EQ(NearestName("pixelnoise_px", names), "pixel_noise_px");
  EXPECT_EQ(NearestName("MAX_TRACKS", names), "max_tracks");
  EXPECT_EQ(NearestName("gat", names), "gate");
  EXPECT_EQ(NearestName("something_else", names), "");
  EXPECT_EQ(NearestName("", names), "");
  // The unit is missing, and another name is a letter away.
  const std::vector<std::string> errors = {"T_g", "p_CB_m", "R_CB_rad", "t_d_ms_old", "t_d_s"};
  EXPECT_EQ(NearestName("t_d", errors), "t_d_s");
  EXPECT_EQ(NearestName("r_cb", errors), "R_CB_rad");
  EXPECT_EQ(NearestName("t_gg", errors), "T_g");
  EXPECT_EQ(DidYouMean("gaet", names), "; did you mean 'gate'?");
  EXPECT_EQ(DidYouMean("zzzzzz", names), "");
}

}  // namespace
}  // namespace duet
