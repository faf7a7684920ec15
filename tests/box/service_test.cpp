// SPDX-License-Identifier: Apache-2.0
// The program as the service manager runs it.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <mutex>
#include <thread>

#include "box/running_box.h"
#include "support/command.h"
#include "support/http_client.h"
#include "support/paths.h"
#include "support/sanitizer.h"
#include "support/temporary_folder.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;
using Json = nlohmann::json;

// A datagram socket as the manager's, read as they come: a full one loses what is sent.
class NoticeSocket {
 public:
  explicit NoticeSocket(const std::string& path)
      : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    is_bound_ = bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    reader_ = std::thread([this] { read(); });
  }
  ~NoticeSocket() {
    shutdown(socket_, SHUT_RD);
    reader_.join();
    ::close(socket_);
  }
  NoticeSocket(const NoticeSocket&) = delete;
  NoticeSocket& operator=(const NoticeSocket&) = delete;

  bool is_bound() const { return is_bound_; }
  // The next one; empty where it does not come.
  std::string receive() {
    std::string notice;
    testing_support::wait_for([&] {
      const std::lock_guard lock(mutex_);
      if (notices_.empty()) return false;
      notice = notices_.front();
      notices_.pop_front();
      return true;
    });
    return notice;
  }

 private:
  void read() {
    char text[256];
    for (ssize_t size = 0; (size = recv(socket_, text, sizeof text, 0)) > 0;) {
      const std::lock_guard lock(mutex_);
      notices_.emplace_back(text, static_cast<std::size_t>(size));
    }
  }

  int socket_;
  bool is_bound_ = false;
  std::mutex mutex_;
  std::deque<std::string> notices_;
  std::thread reader_;
};

constexpr uid_t kNobody = 65534;

// condyle-box, its errors in a file.
class Program {
 public:
  Program(const std::string& configuration, const std::string& errors,
          const std::string& notify_socket, const std::string& hung_disk = "",
          bool as_nobody = false) {
    std::string program = testing_support::program_path("condyle-box");
    if (as_nobody) {  // who may not enter the build folder
      program = errors + ".program";
      std::filesystem::copy_file(testing_support::program_path("condyle-box"), program);
    }
    process_ = fork();
    if (process_ == 0) {
      std::signal(SIGXFSZ, SIG_DFL);
      (void)std::freopen(errors.c_str(), "w", stderr);
      if (as_nobody && geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) _exit(126);
      setenv("NOTIFY_SOCKET", notify_socket.c_str(), 1);
      setenv("WATCHDOG_USEC", "1000000", 1);
      if (!hung_disk.empty()) {
        setenv("CONDYLE_HUNG_DISK", hung_disk.c_str(), 1);
        setenv("LD_PRELOAD", testing_support::program_path("hung_disk.so").c_str(), 1);
      }
      execl(program.c_str(), program.c_str(), "--config", configuration.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Program() {
    if (process_ > 0) (void)end(SIGKILL);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t process() const { return process_; }
  // Its exit code; -1 where a signal ended it.
  int end(int signal) {
    int status = 0;
    kill(process_, signal);
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_ = -1;
};

// From the line that tells it; 0 where it does not come.
std::uint16_t told_port(const std::string& errors) {
  const std::string words = "listening on 127.0.0.1 port ";
  std::uint16_t port = 0;
  testing_support::wait_for([&] {
    if (!std::filesystem::exists(errors)) return false;
    const std::string text = testing_support::read_file(errors);
    const std::size_t at = text.find(words);
    if (at == std::string::npos || text.find('\n', at) == std::string::npos) return false;
    port = static_cast<std::uint16_t>(std::atoi(text.c_str() + at + words.size()));
    return true;
  });
  return port;
}

std::string facebow_profile() {
  return testing_support::source_path("/hal/profiles/condyle_facebow.toml");
}

// The configuration of a box that records into `folder`.
std::string recording_box(const TemporaryFolder& folder,
                          const std::string& profile = facebow_profile()) {
  return folder.write("box.toml", "[facebow]\nsource = \"synth:" + profile +
                                      "\"\n[recording]\nfolder = \".\"\nreserve_MB = 1\n"
                                      "[http]\nport = 0\n");
}

// Asks for a session until one is being recorded: on a busy machine the answer may be that the
// command is carried out later.
bool begins_to_record(std::uint16_t port) {
  return testing_support::wait_for([port] {
    testing_support::post(port, "/v1/session/start", "{}");
    const Json now = Json::parse(testing_support::get(port, "/v1/status").body, nullptr, false);
    return now.is_object() && now["session"]["phase"] == "recording";
  });
}

TEST(Service, TellsItsManagerAndKeepsItsRecordingWhenItIsEnded) {
  const TemporaryFolder folder(TemporaryFolder::in_memory());
  const std::string configuration = recording_box(folder);
  NoticeSocket manager(folder / "notify");
  ASSERT_TRUE(manager.is_bound());
  Program program(configuration, folder / "errors", folder / "notify");
  const std::uint16_t port = told_port(folder / "errors");
  ASSERT_NE(port, 0);
  EXPECT_EQ(manager.receive(), "READY=1");
  EXPECT_EQ(manager.receive(), "WATCHDOG=1");
  EXPECT_EQ(manager.receive(), "WATCHDOG=1");
  const auto session = [port](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "session");
    arguments.insert(arguments.end(), {"--box", "http://127.0.0.1:" + std::to_string(port)});
    return testing_support::run_condyle(arguments);
  };
  ASSERT_TRUE(testing_support::wait_for([&] {
    return session({"start", "--subject", "S-1"}).exit_code == 0;
  }));
  EXPECT_EQ(session({"mark", "swallowed"}).exit_code, 0);
  EXPECT_THAT(session({"status"}).output, HasSubstr("\"markers\": 1,"));
  EXPECT_THAT(session({"start"}).errors, HasSubstr("is being recorded; stop it first"));
  ASSERT_TRUE(testing_support::wait_for([&] {
    const Json status = Json::parse(session({"status"}).output, nullptr, false);
    return status.is_object() && status["session"]["reports_written"] > 0;
  }));
  EXPECT_EQ(program.end(SIGTERM), 0);
  EXPECT_THAT(session({"stop"}).errors, HasSubstr("no box answers"));
  std::string notice;
  do notice = manager.receive();
  while (notice == "WATCHDOG=1");
  EXPECT_EQ(notice, "STOPPING=1");
  const std::string errors = testing_support::read_file(folder / "errors");
  EXPECT_THAT(errors, HasSubstr("<5>session: ended "));
  EXPECT_THAT(errors, HasSubstr(", 0 lost, 0 in 0 s of pauses, "));
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    if (file.path().extension() != ".mcap") continue;
    const auto replayed = testing_support::run_condyle({"replay", file.path().string()});
    EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
    EXPECT_THAT(replayed.output, testing::Not(HasSubstr("note        " + file.path().string())));
    EXPECT_THAT(replayed.output, HasSubstr("s: swallowed\n"));
  }
}

TEST(Service, ChecksItsConfigurationAndMeasuresItsLatency) {
  const TemporaryFolder folder;
  const std::string good =
      folder.write("good.toml", "[facebow]\nsource = \"synth:" + facebow_profile() + "\"\n");
  const std::string bad = folder.write("bad.toml", "[facebow]\nsource = \"x\"\n");
  const std::string out = folder / "out";
  const auto run = [&](const std::string& arguments) {
    const int status = std::system(
        (testing_support::program_path("condyle-box") + " " + arguments + " >" + out + " 2>&1")
            .c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  EXPECT_EQ(run("--check --config " + good), 0);
  EXPECT_THAT(testing_support::read_file(out), testing::Not(HasSubstr("note: ")));
  const std::string early = folder.write(
      "early.toml", testing_support::read_file(good) + "[recording]\nfolder = \"later\"\n");
  EXPECT_EQ(run("--check --config " + early), 0);
  EXPECT_THAT(testing_support::read_file(out), HasSubstr("later is not a folder yet; create it"));
  EXPECT_EQ(run("--check --config " + bad), 2);
  EXPECT_THAT(testing_support::read_file(out), HasSubstr("bad.toml:2:10"));
  for (const char* wrong : {"", "--config", "--nothing", "--config a b", "--latency-test 1"}) {
    EXPECT_EQ(run(wrong), 2) << wrong;
  }
  EXPECT_EQ(run("--latency-test x --config " + good), 2);
  ASSERT_EQ(run("--latency-test 0.2 --config " + good), 0);
  const std::string told = testing_support::read_file(out);
  EXPECT_THAT(told, HasSubstr("wake-up by the kernel: "));
  EXPECT_THAT(told, HasSubstr("from report to estimate: "));
  EXPECT_THAT(told, HasSubstr("0 estimates dropped"));
  EXPECT_THAT(told, testing::Not(HasSubstr("[estimator] node")));
  const std::string node = folder.write(
      "node.toml", testing_support::read_file(good) + "[estimator]\nnode = \"unix:nobody\"\n");
  ASSERT_EQ(run("--latency-test 0.2 --config " + node), 0);
  EXPECT_THAT(testing_support::read_file(out), HasSubstr("the test does not use [estimator] node"));
}

// However little memory there is, it says so and ends, or it works. A core would hold what was
// measured.
TEST(Service, SaysThatMemoryIsShort) {
  if (CONDYLE_UNDER_SANITIZER) GTEST_SKIP() << "a sanitizer takes terabytes";
  const TemporaryFolder folder;
  const std::string configuration = folder.write(
      "box.toml", "[facebow]\nsource = \"synth:" + facebow_profile() + "\"\n[http]\nport = 0\n");
  int said = 0;
  for (int limit_kB = 8'000; limit_kB <= 120'000; limit_kB += 8'000) {
    const std::string out = folder / std::to_string(limit_kB);
    const int status =
        std::system(("ulimit -v " + std::to_string(limit_kB) + "; " +
                     testing_support::program_path("condyle-box") +
                     " --latency-test 0.1 --config " + configuration + " >" + out + " 2>&1")
                        .c_str());
    ASSERT_TRUE(WIFEXITED(status));
    const std::string words = testing_support::read_file(out);
    if (words.rfind("condyle-box: ", 0) != 0) continue;  // the loader's, or it works
    ++said;
    EXPECT_EQ(WEXITSTATUS(status), 2) << limit_kB << words;
    EXPECT_EQ(std::count(words.begin(), words.end(), '\n'), 1) << words;
    EXPECT_THAT(words, HasSubstr("MemoryMax"));
  }
  EXPECT_GT(said, 0);
}

// Neither its journal nor the log may grow: it says what it cannot do, and does it later.
TEST(Service, OutlivesAJournalThatTakesNoMoreLines) {
  const TemporaryFolder folder(TemporaryFolder::in_memory()), elsewhere;
  const std::string configuration = recording_box(folder);
  Program program(configuration, elsewhere / "errors", elsewhere / "notify");
  const std::uint16_t port = told_port(elsewhere / "errors");
  ASSERT_NE(port, 0);
  ASSERT_TRUE(begins_to_record(port));
  rlimit before{};
  const rlim_t size = std::filesystem::file_size(elsewhere / "errors");
  ASSERT_EQ(prlimit(program.process(), RLIMIT_FSIZE, nullptr, &before), 0);
  const rlimit small{size, before.rlim_max};
  ASSERT_EQ(prlimit(program.process(), RLIMIT_FSIZE, &small, nullptr), 0);
  EXPECT_NE(testing_support::post(port, "/v1/session/stop", "{}").status, 0);
  EXPECT_GE(testing_support::post(port, "/v1/session/start", "{}").status, 500);
  EXPECT_EQ(testing_support::get(port, "/v1/status").status, 200);
  ASSERT_EQ(prlimit(program.process(), RLIMIT_FSIZE, &before, nullptr), 0);
  EXPECT_TRUE(begins_to_record(port));
  EXPECT_EQ(program.end(SIGTERM), 0);
  EXPECT_THAT(testing_support::read_file(elsewhere / "errors"), HasSubstr("<5>session: ended "));
}

// A disk that fails does not only refuse to write: nothing can be asked of it.
TEST(Service, StaysPausedWhereTheFolderCannotBeLookedInto) {
  const TemporaryFolder folder, recordings(TemporaryFolder::in_memory());
  const std::string profile =
      folder.write("profile.toml", testing_support::read_file(facebow_profile()));
  const std::string configuration = folder.write(
      "box.toml", "[facebow]\nsource = \"synth:" + profile + "\"\n[recording]\nfolder = \"" +
                      recordings.path().string() + "\"\nreserve_MB = 1\n[http]\nport = 0\n");
  const bool is_root = geteuid() == 0;
  ASSERT_TRUE(!is_root || chown(recordings.path().c_str(), kNobody, kNobody) == 0);
  Program program(configuration, folder / "errors", folder / "notify", "", true);
  const std::uint16_t port = told_port(folder / "errors");
  ASSERT_NE(port, 0);
  const auto session = [port]() -> Json {
    return Json::parse(testing_support::get(port, "/v1/status").body).at("session");
  };
  ASSERT_TRUE(begins_to_record(port));
  ASSERT_TRUE(testing_support::wait_for([&] { return session()["reports_written"] > 0; }));
  const std::string away = recordings.path().string() + ".away";
  std::filesystem::rename(recordings.path(), away);
  EXPECT_TRUE(testing_support::wait_for([&] { return session()["phase"] == "paused"; }));
  std::filesystem::permissions(away, std::filesystem::perms::none);
  std::filesystem::rename(away, recordings.path());
  EXPECT_TRUE(testing_support::wait_for([&] {
    return session()["problem"].get<std::string>().find("Permission denied") != std::string::npos;
  }));
  std::filesystem::permissions(recordings.path(), std::filesystem::perms::owner_all);
  EXPECT_TRUE(testing_support::wait_for([&] { return session()["phase"] == "recording"; }));
  EXPECT_EQ(program.end(SIGTERM), 0);
}

// Whoever asks, listens or ends the box waits for no disk.
TEST(Service, GoesOnWhereTheDiskHangs) {
  if (CONDYLE_UNDER_SANITIZER) GTEST_SKIP() << "a sanitizer is to be loaded first";
  const TemporaryFolder folder(TemporaryFolder::in_memory()), elsewhere;
  const std::string configuration = recording_box(folder);
  const std::string flag = elsewhere / "hangs";
  Program program(configuration, elsewhere / "errors", elsewhere / "notify", flag);
  const std::uint16_t port = told_port(elsewhere / "errors");
  ASSERT_NE(port, 0);
  const auto status = [port] {
    return Json::parse(testing_support::get(port, "/v1/status").body, nullptr, false);
  };
  ASSERT_TRUE(begins_to_record(port));
  ASSERT_TRUE(
      testing_support::wait_for([&] { return status()["session"]["reports_written"] > 0; }));
  elsewhere.write("hangs", "");
  testing_support::EventStream stream(port);
  testing_support::EventStream::Event event;
  ASSERT_TRUE(testing_support::wait_for([&] {
    return stream.next(event) && status()["session"]["problem"].get<std::string>().find(
                                     "the disk has not responded") == 0;
  }));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(stream.next(event));
  const auto stopped = testing_support::post(port, "/v1/session/stop", "{}");
  EXPECT_EQ(stopped.status, 503);
  EXPECT_THAT(stopped.body, HasSubstr("the disk does not respond"));
  EXPECT_EQ(testing_support::get(port, "/v1/status").status, 200);
  stream.end();
  EXPECT_EQ(program.end(SIGTERM), 1);
  EXPECT_THAT(testing_support::read_file(elsewhere / "errors"),
              HasSubstr("the disk does not respond: unwritten data are lost"));
}

// The command that waited is carried out once the disk is back.
TEST(Service, EndsTheSessionOnceTheDiskIsBack) {
  if (CONDYLE_UNDER_SANITIZER) GTEST_SKIP() << "a sanitizer is to be loaded first";
  const TemporaryFolder folder(TemporaryFolder::in_memory()), elsewhere;
  std::string profile = testing_support::read_file(facebow_profile());
  const std::string rate = "rate_Hz = 500\n";
  ASSERT_NE(profile.find(rate), std::string::npos);
  // The box keeps 4096 reports while the disk hangs: 8 s of 500 a second, which a busy machine may
  // take to bring it back.
  profile.replace(profile.find(rate), rate.size(), "rate_Hz = 50\n");
  const std::string configuration = recording_box(folder, elsewhere.write("slow.toml", profile));
  Program program(configuration, elsewhere / "errors", elsewhere / "notify", elsewhere / "hangs");
  const std::uint16_t port = told_port(elsewhere / "errors");
  ASSERT_NE(port, 0);
  ASSERT_TRUE(begins_to_record(port));
  elsewhere.write("hangs", "");
  EXPECT_EQ(testing_support::post(port, "/v1/session/stop", "{}").status, 503);
  std::filesystem::remove(elsewhere / "hangs");
  ASSERT_TRUE(testing_support::wait_for([&] {
    const Json now = Json::parse(testing_support::get(port, "/v1/status").body, nullptr, false);
    return now["session"]["phase"] == "idle";
  }));
  EXPECT_EQ(program.end(SIGTERM), 0);
  EXPECT_THAT(testing_support::read_file(elsewhere / "errors"), HasSubstr(" reports, 0 lost"));
}

}  // namespace
}  // namespace condyle::box
