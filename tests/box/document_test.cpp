// SPDX-License-Identifier: Apache-2.0
// Answers that come piece by piece.
#include "box/outlets/document.h"

#include <gmock/gmock.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

#include "box/recording/session_files.h"
#include "support/wait_for.h"

namespace condyle::box {
namespace {

using testing_support::wait_for;

// All bytes of it, taken in pieces of random sizes, and how it ended.
std::pair<std::string, Document::Taken> read_all(Document& document, std::minstd_rand& random) {
  std::string text;
  char buffer[4096];
  Document::Taken taken = Document::Taken::none_yet;
  const bool has_ended = wait_for([&] {
    std::size_t size = 0;
    do {
      taken = document.take(buffer, 1 + random() % sizeof buffer, size);
      text.append(buffer, size);
    } while (taken == Document::Taken::some);
    return taken != Document::Taken::none_yet;
  });
  EXPECT_TRUE(has_ended);
  return {text, taken};
}

TEST(Document, GivesEveryByteInOrder) {
  std::minstd_rand random(1);
  for (int i = 0; i < 50; ++i) {
    std::vector<std::string> pieces(random() % 20);
    std::string whole;
    for (std::string& piece : pieces) {
      piece.resize(random() % 9000);
      for (char& byte : piece) byte = static_cast<char>(random());
      whole += piece;
    }
    const auto document = std::make_shared<Document>();
    document->start(
        [pieces](Document& made) {
          made.begin({200, "text/plain", "", Document::Head::kUnknown});
          for (const std::string& piece : pieces) EXPECT_TRUE(made.give(piece));
        },
        [] {});
    const auto [text, end] = read_all(*document, random);
    EXPECT_TRUE(text == whole);
    EXPECT_EQ(end, Document::Taken::all);
  }
}

TEST(Document, SaysWhyItCannotBeMade) {
  std::minstd_rand random(1);
  const auto fails = std::make_shared<Document>();
  fails->start([](Document&) { throw std::runtime_error("the disk is gone"); }, [] {});
  const auto [text, end] = read_all(*fails, random);
  Document::Head head;
  ASSERT_TRUE(fails->has_begun(head));
  EXPECT_EQ(head.status, 500);
  EXPECT_EQ(nlohmann::json::parse(text)["problem"], "the disk is gone");
  EXPECT_EQ(end, Document::Taken::all);

  // An answer that has begun can only break off.
  const auto breaks = std::make_shared<Document>();
  breaks->start(
      [](Document& made) {
        made.begin({200, "text/plain", "", 100});
        made.give("half");
        throw std::runtime_error("the disk is gone");
      },
      [] {});
  EXPECT_EQ(read_all(*breaks, random), (std::pair{std::string("half"), Document::Taken::broken}));
}

TEST(Document, LetsItsMakerGoWhenNobodyReads) {
  const auto document = std::make_shared<Document>();
  std::atomic<bool> has_ended = false;
  std::atomic<int> given = 0;
  document->start(
      [&](Document& made) {
        made.begin({200, "text/plain", "", Document::Head::kUnknown});
        while (made.give("x")) ++given;
        has_ended = true;
      },
      [] {});
  ASSERT_TRUE(wait_for([&] { return given >= 4; }));
  document->abandon();
  EXPECT_TRUE(wait_for([&] { return has_ended.load(); }));
  EXPECT_EQ(given, 4);
}

// Whatever a browser asks for, no name leads out of the folder.
TEST(SessionFiles, HaveNamesOfLettersAndDigitsOnly) {
  for (const char* name : {"20261125T105053Z.mcap", "20261125T105053Z-P_07-2.mcap", "a.mcap"}) {
    EXPECT_TRUE(is_session_file(name)) << name;
  }
  std::minstd_rand random(1);
  constexpr std::string_view letters = "aZ0-_./\\%\0 \n\xc3\xa9";
  for (int i = 0; i < 20'000; ++i) {
    std::string name(random() % 12, ' ');
    for (char& letter : name) letter = letters[random() % letters.size()];
    name += random() % 4 == 0 ? "" : ".mcap";
    const std::size_t end = name.size() - std::min<std::size_t>(5, name.size());
    const bool is_good =
        end > 0 && name.substr(end) == ".mcap" && name.find_first_not_of("aZ0-_") == end;
    EXPECT_EQ(is_session_file(name), is_good) << name;
  }
  EXPECT_FALSE(is_session_file(std::string(200, 'a') + ".mcap"));
}

}  // namespace
}  // namespace condyle::box
