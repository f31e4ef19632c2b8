#include "experiments/report/page_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace duet {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(PageTextTest, NothingInATextIsMarkup) {
  EXPECT_EQ(EscapeHtml(R"(<b a="1" b='2'>&amp;</b>)"),
            "&lt;b a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;amp;&lt;/b&gt;");
  EXPECT_EQ(EscapeHtml("3\xCF\x83 \xE2\x89\xA4 1"), "3\xCF\x83 \xE2\x89\xA4 1");
  EXPECT_EQ(EscapeHtml(""), "");
}

TEST(PageTextTest, BytesThatAreNoTextAreReplaced) {
  EXPECT_EQ(EscapeHtml("a\xFF<"), "a\xEF\xBF\xBD&lt;");
  EXPECT_EQ(EscapeHtml(std::string_view("a\0b", 3)),
            "a\xEF\xBF\xBD"
            "b");
}

TEST(PageTextTest, JsonInAScriptIsTheSameValueAndEndsNothing) {
  const nlohmann::json value = {{"reason", "</script><script>alert(1)</script><!-- ]]>"}};
  const std::string text = EscapeScriptJson(value.dump());
  EXPECT_THAT(text, Not(HasSubstr("<")));
  EXPECT_THAT(text, Not(HasSubstr(">")));
  EXPECT_EQ(nlohmann::json::parse(text), value);
}

// RFC 4648, section 10.
TEST(PageTextTest, Base64OfTheStandard) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

// printf abc | openssl dgst -sha256 -binary | base64
TEST(PageTextTest, ContentHashIsThePolicysForm) {
  EXPECT_EQ(ContentHash("abc"), "'sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0='");
}

}  // namespace
}  // namespace duet
