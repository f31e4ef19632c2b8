#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/config/yaml_map.h"
#include "common/config/yaml_node.h"
#include "common/support/input_error.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::StrEq;
using testing::ThrowsMessage;

TEST(Yaml, KeepsStructureAndLines) {
  const YamlNode root = ParseYaml("# comment\na: 1\nb:\n  c: [1, 2.5]\n  d: 'x y'\ne:\n", "f.yaml");
  ASSERT_EQ(root.kind, YamlNode::Kind::kMap);
  ASSERT_EQ(root.entries.size(), 3U);
  EXPECT_EQ(root.Find("a")->line, 2);
  const YamlNode* b = root.Find("b");
  ASSERT_NE(b, nullptr);
  EXPECT_EQ(b->Find("c")->items.at(1).scalar, "2.5");
  EXPECT_EQ(b->Find("d")->scalar, "x y");
  EXPECT_EQ(b->Find("d")->line, 5);
  EXPECT_EQ(root.Find("e")->kind, YamlNode::Kind::kNull);
  EXPECT_EQ(root.Find("f"), nullptr);
}

TEST(Yaml, AcceptsOpenCvsFirstLineAndMatrixTag) {
  const YamlNode root = ParseYaml("%YAML:1.0\n---\na: !!opencv-matrix\n  rows: 4\n", "f.yaml");
  EXPECT_EQ(root.Find("a")->Find("rows")->scalar, "4");
  EXPECT_EQ(root.Find("a")->Find("rows")->line, 4);
  EXPECT_EQ(ParseYaml("%YAML:1.0\na: 3\n", "f.yaml").Find("a")->scalar, "3");
}

TEST(Yaml, AQuotedTextReadsBackWhateverIsInIt) {
  std::string text = "\"a\\ \xc3\xa9";
  for (char c = '\x01'; c < ' '; ++c) text += c;
  text += "\x7f end\n";
  EXPECT_EQ(ParseYaml("k: " + QuotedYaml(text) + "\n", "f").Find("k")->scalar, text);
}

TEST(Yaml, AnEmptyDocumentIsNothing) {
  EXPECT_EQ(ParseYaml("", "f.yaml").kind, YamlNode::Kind::kNull);
  EXPECT_EQ(ParseYaml("# only a comment\n", "f.yaml").kind, YamlNode::Kind::kNull);
}

struct BadYaml {
  std::string text;
  std::string message;
};

class RefusedYaml : public testing::TestWithParam<BadYaml> {};

TEST_P(RefusedYaml, IsAnErrorThatNamesFileAndLine) {
  EXPECT_THAT([] { (void)ParseYaml(GetParam().text, "f.yaml"); },
              ThrowsMessage<InputError>(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Yaml, RefusedYaml,
    testing::Values(BadYaml{"a: 1\nb: 2\na: 3\n", "f.yaml:3: a: repeated key; it stands in line 1"},
                    BadYaml{"a:\n  b: 1\n  b: 1\n", "f.yaml:3: b: repeated key"},
                    BadYaml{"a: [1, 2\nb: 3\n", "f.yaml:"},
                    BadYaml{"a: &x 1\n", "f.yaml:1: anchors are not accepted"},
                    BadYaml{"a: *x\n", "f.yaml:1"}, BadYaml{"a: !!str 1\n", "the tag"},
                    BadYaml{"[1, 2]: 3\n", "f.yaml:1: a key has to be a word"},
                    BadYaml{"a: 1\n---\nb: 2\n", "a second document"},
                    BadYaml{std::string("a: \0b", 5), "zero byte"},
                    BadYaml{std::string(2000, '['), "f.yaml"},
                    BadYaml{std::string(3 << 20, 'a'), "longer than a megabyte"}));

TEST(YamlMap, GivesWhatIsAskedForAndNothingElse) {
  const YamlNode root = ParseYaml(
      "n: 2.5\ni: 7\nt: word\nlist: [1, 2, 3]\nm: {x: 1}\nquoted: '3'\nnan: .nan\n", "f.yaml");
  YamlMap map(root, "f.yaml");
  EXPECT_EQ(map.Number("n"), 2.5);
  EXPECT_EQ(map.Number("i"), 7.0);
  EXPECT_EQ(map.Integer("i"), 7);
  EXPECT_EQ(map.Text("t"), "word");
  EXPECT_THAT(map.Numbers("list", 3), testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(map.Map("m").Number("x"), 1.0);
  EXPECT_EQ(map.NumberOr("absent", 9.81), 9.81);
  EXPECT_THAT([&] { (void)map.Integer("n"); },
              ThrowsMessage<InputError>(StrEq("f.yaml:1: n: expected an integer, got '2.5'")));
  EXPECT_THAT([&] { (void)map.Number("n", {.min = 3, .max = 4}); },
              ThrowsMessage<InputError>(HasSubstr("expected a number from 3 to 4, got '2.5'")));
  EXPECT_THAT([&] { (void)map.Number("quoted"); },
              ThrowsMessage<InputError>(HasSubstr("expected a number")));
  EXPECT_THAT([&] { (void)map.Number("nan"); },
              ThrowsMessage<InputError>(HasSubstr("expected a number")));
  EXPECT_THAT(
      [&] { (void)map.Numbers("list", 4); },
      ThrowsMessage<InputError>(StrEq("f.yaml:4: list: expected a list of 4 numbers, got a list "
                                      "of 3")));
  EXPECT_THAT([&] { (void)map.Map("m").Number("y"); },
              ThrowsMessage<InputError>(StrEq("f.yaml:5: m.y: is missing; expected a number")));
}

TEST(YamlMap, TellsMisspellingsFromKeysOfOthers) {
  const YamlNode root = ParseYaml("rate_hz: 20\ncomment: x\ntime_ofset_s: 0.1\n", "f.yaml");
  YamlMap map(root, "f.yaml");
  EXPECT_EQ(map.Number("rate_hz"), 20);
  EXPECT_THAT(map.UnknownKeys(), testing::ElementsAre("comment", "time_ofset_s"));
  EXPECT_EQ(map.NumberOr("time_offset_s", 0), 0);
  EXPECT_THAT([&] { (void)map.UnknownKeys(); },
              ThrowsMessage<InputError>(
                  StrEq("f.yaml:3: time_ofset_s: unknown key; did you mean 'time_offset_s'?")));
  EXPECT_THAT([&] { (void)map.Number("time_offset_s"); },
              ThrowsMessage<InputError>(HasSubstr("is 'time_ofset_s' meant to be it?")));
}

}  // namespace
}  // namespace duet
