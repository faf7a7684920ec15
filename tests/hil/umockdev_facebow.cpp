// SPDX-License-Identifier: Apache-2.0
// Plugs the fake facebow into umockdev's test bed and runs a program, prints the device's account
// after it, and ends with the program's exit code. usage: umockdev-wrapper umockdev_facebow
// hidraw|libusb [OPTIONS] -- PROGRAM ARGUMENTS...
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <optional>
#include <vector>

#include "fake/fake_arguments.h"
#include "fake/fake_run.h"
#include "hil/umockdev_transport.h"
#include "hosted/files/input_error.h"
#include "options/command_line.h"

namespace {

using namespace condyle;

constexpr int kExitUsage = 2, kExitNotExact = 3, kExitNotStarted = 127;
constexpr TimeNs kSlice_ns = 5'000'000;  // between two looks at the program

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
    look(WNOHANG);
    return has_ended_;
  }
  /// True while it waits to be continued, having stopped itself (SIGSTOP).
  bool is_stopped() const { return is_stopped_; }
  void go_on() {
    is_stopped_ = false;
    kill(process_, SIGCONT);
  }
  void interrupt() {
    if (!has_ended()) kill(process_, SIGINT);
  }
  /// Waits for its end; its exit code, or as shells do 128 + the signal that ended it.
  int wait() {
    while (!has_ended_) look(0);
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

 private:
  void look(int options) {
    if (has_ended_ || waitpid(process_, &status_, options | WUNTRACED) != process_) return;
    is_stopped_ = WIFSTOPPED(status_);
    has_ended_ = !is_stopped_;
  }

  pid_t process_ = -1;
  int status_ = 0;
  bool has_ended_ = false, is_stopped_ = false;
};

int run(int argc, char** argv) {
  host::Program self("umockdev_facebow", CONDYLE_VERSION,
                     "Runs a program with a fake facebow under it, for tests");
  const host::CommandLine line = self.line();
  std::string personality, interloper;
  std::vector<std::string> program;
  bool begins_at_stop = false, interrupts = false;
  std::uint64_t most_stopped = 0;
  host::fake::FakeOptions options;
  line.add_option("PERSONALITY", personality, "What the program uses: hidraw or libusb")
      .required()
      .one_of({"hidraw", "libusb"});
  line.add_option("PROGRAM", program, "The program and its arguments, after --").required();
  line.add_option("--interloper", interloper,
                  "Serial number of another device that hidraw shows at every second plugging");
  line.add_flag("--begin-at-stop", begins_at_stop,
                "Send nothing before the program stopped itself (SIGSTOP)");
  line.add_option("--continue-after", most_stopped,
                  "Continue a program that stopped itself after so many further reports");
  line.add_flag(
      "--interrupt", interrupts,
      "Interrupt the program once the device is gone for good and the program let go of it");
  host::fake::add_arguments(line, options);
  std::string text;
  const host::Program::Parsed parsed = self.parse(argc, argv, text);
  if (parsed != host::Program::Parsed::run) {
    const bool is_answer = parsed == host::Program::Parsed::answered;
    std::fputs((text + "\n").c_str(), is_answer ? stdout : stderr);
    return is_answer ? 0 : kExitUsage;
  }

  host::fake::FakeSetup setup = host::fake::set_up(options);
  hil::UmockdevTransport transport(
      personality == "hidraw" ? hil::Personality::hidraw : hil::Personality::usbfs, interloper);
  hal::SteadyClock clock;
  host::fake::FakeRun fake(setup.device, setup.script, transport, clock, setup.run);
  if (begins_at_stop) transport.hold_back();
  std::optional<Child> child;     // first the device is plugged in
  std::uint64_t made_before = 0;  // it stopped
  fake.run([&] {
    if (!child) child.emplace(program);
    const bool was_stopped = child->is_stopped();
    if (child->has_ended()) return true;
    if (!was_stopped) made_before = fake.made();
    if (child->is_stopped()) transport.begin();
    if (child->is_stopped() && fake.made() - made_before >= most_stopped) child->go_on();
    return false;
  });
  if (interrupts) {
    while (!child->has_ended() && !transport.is_let_go()) {
      transport.serve(clock.now_ns() + kSlice_ns);
    }
    child->interrupt();
  }
  const int exit_code = child->wait();
  transport.settle();
  const host::fake::DeliveryLog log = fake.delivery_log();
  std::printf("%s\n", host::fake::delivery_log_json(log).c_str());
  std::fflush(stdout);
  return log.balances() ? exit_code : kExitNotExact;
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
