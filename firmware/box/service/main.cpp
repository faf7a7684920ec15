// SPDX-License-Identifier: Apache-2.0
// condyle-box: see firmware/box/README.md.
#include <getopt.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>

#include "box/service/box.h"
#include "box/service/latency_test.h"
#include "hosted/files/input_error.h"
#include "hosted/files/last_words.h"

namespace {

using namespace condyle;

constexpr int kExitOk = 0, kExitFailure = 1, kExitBadInput = 2;

constexpr const char* kUsage =
    "usage: condyle-box --config FILE [--check | --latency-test SECONDS]\n"
    "Estimate and record jaw motion from a facebow, unattended. Research use only; not a "
    "diagnosis.\n"
    "  --config FILE           settings, see box.toml\n"
    "  --check                 only read the settings, and report what is wrong\n"
    "  --latency-test SECONDS  only measure this machine's latency, with [facebow] as source\n"
    "  --version, --help\n";

volatile std::sig_atomic_t stop_signal = 0;

void on_signal(int signal) {
  stop_signal = signal;
}

struct Arguments {
  std::string configuration;
  bool only_checks = false;
  double latency_test_s = 0;
};

// False if the program has nothing more to do; `exit_code` is then set.
bool parse(int argc, char** argv, Arguments& arguments, int& exit_code) {
  constexpr option options[] = {{"config", required_argument, nullptr, 'c'},
                                {"check", no_argument, nullptr, 'k'},
                                {"latency-test", required_argument, nullptr, 'l'},
                                {"version", no_argument, nullptr, 'v'},
                                {"help", no_argument, nullptr, 'h'},
                                {nullptr, 0, nullptr, 0}};
  exit_code = kExitBadInput;
  for (int letter = 0; (letter = getopt_long(argc, argv, "", options, nullptr)) != -1;) {
    switch (letter) {
      case 'c':
        arguments.configuration = optarg;
        break;
      case 'k':
        arguments.only_checks = true;
        break;
      case 'l': {
        const char* const end = optarg + std::strlen(optarg);
        const auto [place, error] = std::from_chars(optarg, end, arguments.latency_test_s);
        if (error != std::errc() || place != end || !(arguments.latency_test_s > 0) ||
            arguments.latency_test_s > 1e6) {
          std::fprintf(stderr, "condyle-box: --latency-test takes seconds, above 0 to 1e6\n");
          return false;
        }
        break;
      }
      case 'v':
        std::printf("condyle-box %s\n", CONDYLE_VERSION);
        exit_code = kExitOk;
        return false;
      case 'h':
        std::fputs(kUsage, stdout);
        exit_code = kExitOk;
        return false;
      default:
        std::fputs(kUsage, stderr);
        return false;
    }
  }
  if (optind < argc || arguments.configuration.empty()) {
    std::fputs(kUsage, stderr);
    return false;
  }
  return true;
}

int run(const Arguments& arguments) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  const auto should_stop = [] { return stop_signal != 0; };

  const box::Configuration configuration = box::load_configuration(arguments.configuration);
  hal::SteadyClock clock;
  if (arguments.only_checks) {
    std::printf("%s: ok\n", arguments.configuration.c_str());
    std::error_code ignored;
    if (!configuration.folder.empty() &&
        !std::filesystem::is_directory(configuration.folder, ignored)) {
      std::printf("note: %s is not a folder yet; create it before the box starts\n",
                  configuration.folder.c_str());
    }
    return kExitOk;
  }
  if (arguments.latency_test_s > 0) {
    std::fputs(
        box::test_latency(configuration, arguments.latency_test_s, clock, should_stop).c_str(),
        stdout);
    return kExitOk;
  }
  box::BoxLog log(clock);
  box::Box service(configuration, clock, log);
  log.say(box::BoxLog::Level::info, "http",
          "listening on " + configuration.http_address + " port " +
              std::to_string(service.http_port()));
  service.run(should_stop);
  if (service.is_held_by_disk()) std::_Exit(kExitFailure);
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  host::end_with_last_words("condyle-box", kExitFailure);
  // Without a reader, or if a file may not grow, the write fails instead: a blocked journal must
  // not end a recording.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Arguments arguments;
  int exit_code = kExitOk;
  if (!parse(argc, argv, arguments, exit_code)) return exit_code;
  try {
    return run(arguments);
  } catch (const host::InputError& error) {
    std::fprintf(stderr, "condyle-box: %s\n", error.what());
    return kExitBadInput;
  } catch (const std::exception& error) {
    return host::say_last_words("condyle-box", error, kExitFailure);
  }
}
