// SPDX-License-Identifier: Apache-2.0
// Linked into every test program of the mutated build. Writes to the file CONDYLE_REACHED a line
// for each test: its name, its CPU time in ms, the numbers of the mutants that it reached. What a
// whole suite or the program's start reached has a line of its own, with * for the name.
#include <ctime>
#include <fstream>

#include "gtest/gtest.h"
#include "mutant_switch.h"

namespace {

class ReachedListener : public testing::EmptyTestEventListener {
 public:
  // Appended: programs that tests start open it too.
  explicit ReachedListener(const char* path) : file_(path, std::ios::app) {}

 private:
  void OnTestProgramStart(const testing::UnitTest&) override { write("*", 0); }
  void OnTestStart(const testing::TestInfo& test) override {
    write(std::string(test.test_suite_name()) + ".*", 0);
    begin_ = std::clock();
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    const std::clock_t used = std::clock() - begin_;
    write(std::string(test.test_suite_name()) + "." + test.name(), used / (CLOCKS_PER_SEC / 1000));
  }

  void write(const std::string& name, std::clock_t time_ms) {
    file_ << name << '\t' << time_ms << '\t';
    for (int i = 0; i < condyle_mutation::kMutants; ++i) {
      if (condyle_mutation::reached[static_cast<unsigned>(i)].exchange(false)) file_ << i << ' ';
    }
    file_ << std::endl;
  }

  std::ofstream file_;
  std::clock_t begin_ = 0;
};

[[maybe_unused]] const bool is_listening = [] {
  const char* path = std::getenv("CONDYLE_REACHED");
  if (path == nullptr) return false;
  testing::UnitTest::GetInstance()->listeners().Append(new ReachedListener(path));
  return true;
}();

}  // namespace
