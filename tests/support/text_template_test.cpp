// SPDX-License-Identifier: MIT
// Placeholders: filled once, and a missing or superfluous one is an error that names it.
#include "generator/support/text_template.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "generator/support/embedded_files.hpp"

namespace contactspline::testing {
namespace {

/// What fill_template() says of a template it refuses, empty where it fills it.
std::string refusal(std::string_view text, const TemplateValues& values) {
  try {
    static_cast<void>(fill_template(text, values));
    return {};
  } catch (const std::logic_error& refused) {
    return refused.what();
  }
}

bool names(const std::string& message, const std::string& key) {
  return message.find(key) != std::string::npos;
}

TEST(Template, IsFilled) {
  EXPECT_EQ(fill_template("k = @STIFFNESS@;", {{"STIFFNESS", "1.5"}}), "k = 1.5;");
}

TEST(Template, WithoutPlaceholdersIsUnchanged) {
  EXPECT_EQ(fill_template("", {}), "");
  EXPECT_EQ(fill_template("plain\ntext\n", {}), "plain\ntext\n");
}

TEST(Template, MayBeginAndEndWithAPlaceholder) {
  EXPECT_EQ(fill_template("@A@", {{"A", "x"}}), "x");
  EXPECT_EQ(fill_template("@A@ and @B_2@", {{"A", "x"}, {"B_2", "y"}}), "x and y");
}

TEST(Template, MayHaveAdjacentAndRepeatedPlaceholders) {
  EXPECT_EQ(fill_template("@A@@B@@A@", {{"A", "x"}, {"B", "y"}}), "xyx");
}

TEST(Template, ValueMayBeEmptyOrHaveSeveralLines) {
  EXPECT_EQ(fill_template("[@A@][@B@]", {{"A", ""}, {"B", "1\n2"}}), "[][1\n2]");
}

TEST(Template, ValueIsNotFilledAgain) {
  EXPECT_EQ(fill_template("@A@ @B@", {{"A", "@B@"}, {"B", "@A@"}}), "@B@ @A@");
}

TEST(Template, UnknownKeyIsNamed) {
  EXPECT_TRUE(names(refusal("a @KNOWN@ b @UNKNOWN@", {{"KNOWN", "x"}}), "@UNKNOWN@"));
  EXPECT_TRUE(names(refusal("@PREFIX_LONG@", {{"PREFIX", "x"}}), "@PREFIX_LONG@"));
  EXPECT_TRUE(names(refusal("ends in @KEY@", {}), "@KEY@"));
}

TEST(Template, UnusedValueIsNamed) {
  EXPECT_TRUE(names(refusal("a @USED@", {{"USED", "x"}, {"UNUSED", "y"}}), "UNUSED"));
  EXPECT_TRUE(names(refusal("", {{"UNUSED", "y"}}), "UNUSED"));
}

// A value mentioned only inside another value is not used.
TEST(Template, PlaceholderInsideAValueDoesNotUseAnother) {
  EXPECT_TRUE(names(refusal("@A@", {{"A", "@HIDDEN@"}, {"HIDDEN", "y"}}), "HIDDEN"));
}

// E-mail addresses, decorators and the like pass through.
TEST(Template, LoneAtSignIsText) {
  for (const std::string text : {"@", "a @ b", "me@example.org", "@@", "@@@", "@ A@", "@A", "trailing @A_1", "@a@",
                                 "@Key@", "@KEY", "@KE Y@", "@KEY-2@", "@\n@"})
    EXPECT_EQ(fill_template(text, {}), text);
}

TEST(Template, LoneAtSignBeforeAPlaceholderIsText) {
  EXPECT_EQ(fill_template("@@A@", {{"A", "x"}}), "@x");
  EXPECT_EQ(fill_template("@A@@", {{"A", "x"}}), "x@");
  EXPECT_EQ(fill_template("@A@B@", {{"A", "x"}}), "xB@");
  EXPECT_EQ(fill_template("me@A@", {{"A", "x"}}), "mex");
}

TEST(Template, EveryEmbeddedTemplateHasPlaceholders) {
  int templates = 0;
  for (const auto& [name, content] : embedded_files(Shipped::kTemplates))
    if (name.ends_with(".in")) {
      ++templates;
      EXPECT_NE(refusal(content, {}), "") << name;
    }
  EXPECT_GE(templates, 3);  // Faust, C++, JSON
}

}  // namespace
}  // namespace contactspline::testing
