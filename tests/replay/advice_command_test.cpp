// SPDX-License-Identifier: Apache-2.0
// What an error advises can be done: each command that reads recordings is given some that it
// cannot use as they are, has the options that its errors name, and gets on once they are followed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::condyle_has;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::source_path;
using testing_support::TemporaryFolder;
using Words = std::vector<std::string>;

// A command; the recordings stand at "R".
struct RecordingCommand {
  Words name, arguments;
  bool follows_jaw_points = true;
};

Words with_recording(const RecordingCommand& command, const std::string& recording) {
  Words words = command.name;
  for (const std::string& word : command.arguments) words.push_back(word == "R" ? recording : word);
  return words;
}

Words options_named_in(const std::string& text) {
  static const std::regex option("--[a-z][A-Za-z0-9-]*");
  Words options;
  for (std::sregex_iterator found(text.begin(), text.end(), option), end; found != end; ++found) {
    options.push_back(found->str());
  }
  return options;
}

// Without the option and what follows it up to the next.
Words without(Words words, const std::string& option) {
  const auto begin = std::find(words.begin(), words.end(), option);
  if (begin == words.end()) return words;
  words.erase(begin, std::find_if(begin + 1, words.end(),
                                  [](const std::string& word) { return word.starts_with("--"); }));
  return words;
}

class AdviceTest : public testing::Test {
 protected:
  AdviceTest() {
    std::string header = "time_s", row = "0";
    const std::string muscles = read_file(muscles_);
    static const std::regex section("(^|\n)\\[muscles\\.([a-z_]+)\\]");
    for (std::sregex_iterator found(muscles.begin(), muscles.end(), section), end; found != end;
         ++found) {
      header += "," + found->str(2) + "_envelope";
      row += ",0.1";
    }
    std::string emg = header + "\n", drive = "time_s,drive_N\n",
                acceleration = "time_s,acceleration_m_s2\n";
    for (int i = 0; i < 50; ++i) {
      const std::string time = "0." + std::to_string(10 + i);
      emg += time + row.substr(1) + "\n";
      drive += time + ",1\n";
      acceleration += time + ",1\n";
    }
    folder_.write("e.csv", emg);
    folder_.write("d.csv", drive);
    folder_.write("a.csv", acceleration);
    good_ = csv("good.csv", "time_s,position_m\n", "");
  }
  // Fifty rows of a motion, and `last`.
  std::string csv(const std::string& name, const std::string& header, const std::string& more,
                  const std::string& last = "") const {
    std::string text = header;
    for (int i = 0; i < 50; ++i) {
      text += "0." + std::to_string(10 + i) + "," + std::to_string(i % 7) + "e-3" + more + "\n";
    }
    return folder_.write(name, text + last);
  }
  std::vector<RecordingCommand> commands() const {
    return {{{"replay"}, {"R"}},
            {{"compare"}, {"R", "--with", "recommended"}},
            {{"tune"}, {"R", "--out", folder_ / "tuned.toml"}},
            {{"changes"},
             {"R", "--false-alarm-interval-h", "8", "--drive", folder_ / "d.csv", "--drive-missing",
              "0"}},
            {{"protocol", "release"}, {"R"}},
            {{"protocol", "combine"}, {"R", good_, "--added-mass-kg", "0.1"}},
            {{"protocol", "head-motion"}, {"R", "--acceleration", folder_ / "a.csv"}},
            {{"protocol", "emg"}, {"R", "--emg", folder_ / "e.csv", "--muscles", muscles_}},
            {{"bridge"}, {"R", "--port", "/nowhere"}, false}};
  }
  // What `errors` advises, done to the arguments.
  Words follow(Words words, const std::string& errors) const {
    std::smatch found;
    if (std::regex_search(errors, found,
                          std::regex("leave it out with --ignore-column '([^']*)'"))) {
      words.insert(words.end(), {"--ignore-column", found[1]});
    } else if (std::regex_search(errors, found,
                                 std::regex("for example with --ignore-column '([^']*)'"))) {
      words.insert(words.end(), {"--ignore-column", found[1]});
    } else if (errors.find("--faults event") != std::string::npos) {
      words.insert(words.end(), {"--faults", "event"});
    } else if (errors.find("give the device's profile with --profile") != std::string::npos) {
      words.insert(words.end(), {"--profile", profile_});
    } else if (errors.find("give --unit mm") != std::string::npos) {
      words.insert(words.end(), {"--unit", "mm"});
    } else if (std::regex_search(errors, found, std::regex("choose (--movement) (1) to"))) {
      words = without(words, found[1]);
      words.insert(words.end(), {found[1], found[2]});
    } else if (std::regex_search(errors, found, std::regex("leave out (--[a-z-]+)")) ||
               std::regex_search(errors, found,
                                 std::regex("(--[a-z-]+) applies only to [^;]*; leave it out"))) {
      words = without(words, found[1]);
    } else {
      ADD_FAILURE() << "no advice that this test can follow in: " << errors;
    }
    return words;
  }
  // The message without its place and advice.
  static std::string problem_in(const std::string& errors) {
    const std::string all = errors.substr(0, errors.find(';'));
    return all.substr(all.rfind(": ") + 2);
  }
  void expect_advice_that_works(const RecordingCommand& command, Words words,
                                const std::string& problem) const {
    const CommandResult first = run_condyle(words);
    EXPECT_EQ(first.exit_code, 2) << testing::PrintToString(words);
    ASSERT_THAT(first.errors, HasSubstr(problem)) << testing::PrintToString(words);
    Words help = command.name;
    help.emplace_back("--help");
    const std::string known = run_condyle(help).output;
    for (const std::string& option : options_named_in(first.errors)) {
      EXPECT_THAT(known, testing::ContainsRegex(option + "[ =,\n]"))
          << testing::PrintToString(words) << first.errors;
    }
    const CommandResult second = run_condyle(follow(words, first.errors));
    EXPECT_THAT(second.errors, Not(HasSubstr(problem))) << testing::PrintToString(words);
    EXPECT_THAT(second.errors, Not(HasSubstr(problem_in(first.errors))));
    EXPECT_THAT(second.errors, Not(HasSubstr("Run condyle"))) << second.errors;
  }
  void expect_of_all(const std::string& recording, const Words& more,
                     const std::string& problem) const {
    for (const RecordingCommand& command : commands()) {
      Words words = with_recording(command, recording);
      words.insert(words.end(), more.begin(), more.end());
      expect_advice_that_works(command, words, problem);
    }
  }

  TemporaryFolder folder_;
  std::string muscles_ = source_path("/host_sim/muscles/artisynth.toml");
  std::string profile_ = source_path("/hal/profiles/condyle_facebow.toml");
  std::string good_;
};

TEST_F(AdviceTest, OfRowsThatCannotBeUsed) {
  const std::string header = "time_s,position_m\n";
  expect_of_all(csv("r.csv", header, "", ",0.001\n"), {}, "the value is missing");
  expect_of_all(csv("r.csv", header, "", "nan,0.001\n"), {}, "the value is missing");
}

// They count missing values without being asked to, and have no --faults.
TEST_F(AdviceTest, NamesNoOptionThatReadingsLack) {
  const std::string recording =
      folder_.write("r.csv", "time_s,a_x_m,a_y_m,a_z_m\n0,0,0,0\n0.01,0,0,seven\n0.02,0,0,0\n");
  for (const char* command : {"analyse", "report"}) {
    if (!condyle_has(command)) GTEST_SKIP() << "built without " << command;
    const CommandResult ran = run_condyle({command, recording, "--out", folder_ / "out"});
    EXPECT_EQ(ran.exit_code, 2);
    for (const std::string& option : options_named_in(ran.errors)) {
      EXPECT_THAT(run_condyle({command, "--help"}).output, HasSubstr(option)) << ran.errors;
    }
  }
}

TEST_F(AdviceTest, OfColumns) {
  expect_of_all(csv("r.csv", "time_s,position_m,note\n", ",3"), {}, "the column is not known");
  expect_of_all(csv("r.csv", "time_s,position_m,position_mm\n", ",3"), {},
                "another column contains the same quantity");
}

TEST_F(AdviceTest, OfWhatIsFollowed) {
  expect_of_all(good_, {"--point", "2"}, "has one point, not point 2");
  expect_of_all(good_, {"--axis", "y"}, "has one axis");
  for (const RecordingCommand& command : commands()) {
    Words words = with_recording(command, good_);
    if (!command.follows_jaw_points) continue;
    words.insert(words.end(), {"--jaw-point-mm", "1", "2", "3"});
    expect_advice_that_works(command, words, "has no three points");
  }
}

TEST_F(AdviceTest, OfOtherFormats) {
  const std::string capture = folder_.write("r.pcap", "\xd4\xc3\xb2\xa1 and no more");
  expect_of_all(capture, {}, "is a capture of USB traffic");
  const std::string track =
      "<track><frequency>50</frequency><quants><quant><x>1</x><y>2</y><z>3</z></quant>"
      "<quant><x>4</x><y>5</y><z>6</z></quant></quants></track>\n";
  const std::string zebris =
      folder_.write("r.xml",
                    "<?xml version=\"1.0\"?>\n<dental_measurement><movements><movement>"
                    "<tracks>\n" +
                        track + "</tracks></movement></movements></dental_measurement>\n");
  expect_of_all(zebris, {}, "does not state the unit");
  expect_of_all(zebris, {"--unit", "mm", "--movement", "3"}, "choose --movement 1");
  expect_of_all(good_, {"--movement", "2"}, "--movement applies only to");
  expect_of_all(good_, {"--profile", profile_}, "--profile applies only to");
  expect_of_all(zebris, {"--unit", "mm", "--ignore-column", "note"},
                "--ignore-column applies only to");
}

TEST_F(AdviceTest, OfMorePointsThanThree) {
  std::string header = "time_s";
  for (const char* point : {"a", "b", "c", "d"}) {
    for (const char* axis : {"_x_mm", "_y_mm", "_z_mm"}) header += std::string(",") + point + axis;
  }
  expect_of_all(csv("r.csv", header + "\n", ",1,2,3,4,5,6,7,8,9,10,11"), {}, "has 4 points");
}

// Of several recordings, one has a column that is left out.
TEST_F(AdviceTest, OfColumnsOfOneRecording) {
  const std::string more = csv("r.csv", "time_s,position_m,note\n", ",3");
  const std::vector<RecordingCommand> several = {
      {{"compare"}, {"R", good_, "--with", "recommended"}},
      {{"tune"}, {"R", good_, "--out", folder_ / "tuned.toml"}},
      {{"protocol", "combine"}, {"R", good_, "--added-mass-kg", "0.1"}}};
  for (const RecordingCommand& command : several) {
    const Words words = with_recording(command, more);
    expect_advice_that_works(command, words, "the column is not known");
    EXPECT_THAT(run_condyle(follow(words, run_condyle(words).errors)).errors,
                Not(HasSubstr("to ignore")));
  }
}

// The drive is a file of its own: options of RECORDING do not reach it.
TEST_F(AdviceTest, OfADriveThatWasRecordedApart) {
  for (const auto& [name, option, column] :
       {std::tuple{Words{"replay"}, "--drive", "drive_N"},
        std::tuple{Words{"protocol", "head-motion"}, "--acceleration", "acceleration_m_s2"}}) {
    Words words = name;
    words.insert(words.end(), {good_, option,
                               folder_.write("apart.csv", std::string("time_s,note,") + column +
                                                              "\n0.1,1,1\n")});
    const CommandResult result = run_condyle(words);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, HasSubstr("column 'note': the column is not known; take it out of "
                                         "the file"));
  }
}

TEST_F(AdviceTest, OfTheOtherEstimator) {
  const std::vector<std::pair<Words, std::string>> cases = {
      {{"replay", good_, "--lag", "3", "--estimator", "published"}, "--estimator"},
      {{"bridge", good_, "--port", "/nowhere", "--lag", "3", "--estimator", "published"},
       "--estimator"},
      {{"compare", good_, "--lag", "3", "--with", "published"}, "--with"},
      {{"compare", good_, "--jaw-point-mm", "1", "2", "3", "--with", "published"}, "--with"}};
  for (const auto& [words, option] : cases) {
    EXPECT_THAT(run_condyle(words).errors, HasSubstr("give " + option + " recommended"));
    Words followed = words;
    followed.back() = "recommended";
    EXPECT_THAT(run_condyle(followed).errors, Not(HasSubstr("give " + option)));
  }
  for (const char* estimator : {"recommended", "published"}) {
    const std::string wrong = folder_.write(
        "p.toml", estimator == std::string("published") ? "noise = {}\n" : "motion = {}\n");
    EXPECT_THAT(run_condyle({"compare", good_, "--with", estimator + (":" + wrong)}).errors,
                Not(HasSubstr("--estimator")));
  }
}

// A number that may be a place or stand for a missing one.
TEST_F(AdviceTest, OfANumberOnAllAxes) {
  std::string text = "time_s,x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 400; ++i) {
    const bool is_filled = i >= 100 && i < 120;
    text += std::to_string(0.01 * i) + (is_filled ? ",-1,-1,-1\n" : ",0.5,-1.25,") +
            (is_filled ? "" : std::to_string(3 + (i % 7) * 0.1) + "\n");
  }
  const std::string recording = folder_.write("filled.csv", text);
  const CommandResult refused = run_condyle({"replay", recording});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr(":102: -1 on all three axes"));
  EXPECT_THAT(refused.errors, HasSubstr("give --missing -1 if it is missing, or --missing none"));
  const CommandResult missing = run_condyle({"replay", recording, "--missing", "-1"});
  EXPECT_EQ(missing.exit_code, 0) << missing.errors;
  EXPECT_THAT(missing.output, HasSubstr("20 position_missing"));
  const CommandResult places = run_condyle({"replay", recording, "--missing", "none"});
  EXPECT_EQ(places.exit_code, 0) << places.errors;
  EXPECT_THAT(places.output, Not(HasSubstr("position_missing")));
}

}  // namespace
}  // namespace condyle
