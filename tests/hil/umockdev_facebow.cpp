// SPDX-License-Identifier: Apache-2.0
// Runs a program with the fake facebow plugged into umockdev's test bed, prints the device's
// account after it, and ends with the program's exit code. usage: umockdev-wrapper umockdev_facebow
// hidraw|libusb [OPTIONS] -- PROGRAM ARGUMENTS...
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <vector>

#include "fake/fake_arguments.h"
#include "fake/fake_run.h"
#include "hil/umockdev_transport.h"
#include "input_error.h"

namespace {

using namespace condyle;

constexpr int kExitUsage = 2, kExitNotExact = 3, kExitNotStarted = 127;

// A program started from here.
class Child {
 public:
  explicit Child(std::vector<std::string> arguments) {
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    process_ = fork();
    if (process_ == 0) {
      execvp(words[0], words.data());
      _exit(kExitNotStarted);
    }
  }
  /// True once it has ended.
  bool has_ended() {
    if (!has_ended_) has_ended_ = waitpid(process_, &status_, WNOHANG) != 0;
    return has_ended_;
  }
  /// Waits for its end; its exit code, or as shells do 128 + the signal that ended it.
  int wait() {
    if (!has_ended_) waitpid(process_, &status_, 0);
    has_ended_ = true;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

 private:
  pid_t process_ = -1;
  int status_ = 0;
  bool has_ended_ = false;
};

int run(int argc, char** argv) {
  CLI::App app{"Runs a program with a fake facebow under it, for tests"};
  std::string personality, interloper;
  std::vector<std::string> program;
  host::fake::FakeOptions options;
  app.add_option("PERSONALITY", personality, "What the program uses: hidraw or libusb")
      ->required()
      ->check(CLI::IsMember({"hidraw", "libusb"}));
  app.add_option("PROGRAM", program, "The program and its arguments, after --")->required();
  app.add_option("--interloper", interloper,
                 "Serial number of another device that hidraw shows at every second plugging");
  host::fake::add_arguments(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }

  host::fake::FakeSetup setup = host::fake::set_up(options);
  hil::UmockdevTransport transport(
      personality == "hidraw" ? hil::Personality::hidraw : hil::Personality::usbfs, interloper);
  hal::SteadyClock clock;
  host::fake::FakeRun fake(setup.device, setup.script, transport, clock, setup.run);
  Child child(program);
  fake.run([&child] { return child.has_ended(); });
  const int exit_code = child.wait();
  transport.settle();
  const host::fake::Account account = fake.account();
  std::printf("%s\n", host::fake::account_json(account).c_str());
  std::fflush(stdout);
  return account.balances() ? exit_code : kExitNotExact;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const host::InputError& error) {
    std::fprintf(stderr, "umockdev_facebow: %s\n", error.what());
    return kExitUsage;
  }
}
