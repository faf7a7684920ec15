// SPDX-License-Identifier: Apache-2.0
// TOML from outside: keys nested so deeply that the parser would exhaust the stack are refused,
// wherever they stand, and dots that are no keys are left alone.
#include "hosted/files/toml_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;

std::string dotted(std::size_t parts) {
  std::string key = "a";
  for (std::size_t i = 1; i < parts; ++i) key += ".a";
  return key;
}

std::string refusal(const std::string& text) {
  try {
    const TomlReader reader("file.toml", text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Each form in which a key of `parts` can hide behind what a careless scan takes for a string.
std::vector<std::string> with_key(std::size_t parts) {
  const std::string key = dotted(parts);
  return {"[" + key + "]",
          "[[" + key + "]]",
          key + " = 1",
          "x = 1\n\n[" + key + "]\ny = 2",
          "x = {" + key + " = 1}",
          "x = [1, {" + key + " = 1}]",
          "x = [\"\", {" + key + " = 1}]",
          "x = [\"\\\"\", {" + key + " = 1}]",
          "x = [\"\\\\\", {" + key + " = 1}]",
          "x = ['\\', {" + key + " = 1}]",
          "x = [\"\"\"\"\"\", {" + key + " = 1}]",
          "x = [\"\"\"a\"\"\"\", {" + key + " = 1}]",
          "x = [\"\"\"a\"\"\"\"\", {" + key + " = 1}]",
          "x = [\"\"\"\"a\"\"\", {" + key + " = 1}]",
          "x = [\"\"\"\n\"b\"\n\"\"\", {" + key + " = 1}]",
          "x = ['''a''''', {" + key + " = 1}]",
          "x = ['''a\"''', {" + key + " = 1}]",
          "x = 1 # \"\n[" + key + "]",
          "\"a.b\"." + key + " = 1",
          "a . " + key + " = 1"};
}

TEST(TomlReader, RefusesKeysThatAreNestedTooDeeply) {
  for (const std::size_t parts : {40U, 260'000U}) {
    const auto texts = with_key(parts);
    for (std::size_t i = 0; i < texts.size(); ++i) {
      EXPECT_THAT(refusal(texts[i]), HasSubstr("a key is nested too deeply")) << parts << ' ' << i;
    }
  }
  EXPECT_THAT(refusal("x = 1\n\n[" + dotted(40) + "]"), HasSubstr("file.toml:3"));
}

TEST(TomlReader, TakesKeysOfSomePartsAndDotsElsewhere) {
  for (const std::string& text : with_key(30)) EXPECT_EQ(refusal(text), "") << text;
  const std::string dots(100, '.');
  for (const std::string& text :
       {"x = \"" + dots + "\"", "x = '" + dots + "'", "x = \"\"\"\n" + dots + "\"\"\"",
        "x = 1 # " + dots, "\"" + dots + "\" = 1", "x = '''" + dots + "\n" + dots + "'''"}) {
    EXPECT_EQ(refusal(text), "") << text;
  }
  std::string numbers = "x = [0.5";
  for (int i = 0; i < 100; ++i) numbers += ", 1.5";
  EXPECT_EQ(refusal(numbers + "]"), "");
}

TEST(TomlReader, EndsAtAnyBrokenString) {
  for (const char* text : {"x = \"", "x = \"\\", "x = '''", "x = \"\"\"a\"\"", "\"\"\"\"\"\"\"",
                           "x = \"\"\"\"\"\"\"\"\"\""}) {
    EXPECT_NE(refusal(text), "") << text;
  }
}

}  // namespace
}  // namespace condyle::host
