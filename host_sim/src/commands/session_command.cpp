// SPDX-License-Identifier: Apache-2.0
#include <httplib.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "commands/box_answer.h"
#include "commands/commands.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"
#include "options/command_line.h"
#include "output/lasting_effect.h"

namespace condyle::host {
namespace {

struct SessionOptions {
  std::string box = "http://127.0.0.1:8750";
  std::string token_file;
  std::string subject, text;
};

constexpr std::chrono::seconds kPatience{30};

// Ends the client's wait after a time limit, even if an answer arrives slowly.
class Deadline {
 public:
  explicit Deadline(httplib::Client& client)
      : thread_([this, &client] {
          std::unique_lock lock(mutex_);
          has_passed_ = !ended_.wait_for(lock, kPatience, [this] { return is_over_; });
          if (has_passed_) client.stop();
        }) {}
  ~Deadline() { (void)has_passed(); }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  // Ends the wait.
  bool has_passed() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    ended_.notify_one();
    if (thread_.joinable()) thread_.join();
    return has_passed_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_over_ = false, has_passed_ = false;
  std::thread thread_;
};

// The answer and its HTTP status.
struct BoxAnswer {
  int status = 0;
  std::string text;
};

BoxAnswer ask(const SessionOptions& options, httplib::Request request) {
  httplib::Client client(options.box);
  if (!client.is_valid()) {
    throw InputError("--box", "\"" + options.box + "\" is not the address of a box",
                     "write it like http://127.0.0.1:8750");
  }
  client.set_connection_timeout(5);
  client.set_read_timeout(kPatience);
  if (!options.token_file.empty()) {
    client.set_bearer_token_auth(read_text_line(options.token_file));
  }
  BoxAnswer answer;
  bool is_too_long = false;
  request.content_receiver = [&](const char* bytes, std::size_t size, std::uint64_t,
                                 std::uint64_t) {
    is_too_long = answer.text.size() + size > kLongestBoxAnswer;
    if (!is_too_long) answer.text.append(bytes, size);
    return !is_too_long;
  };
  httplib::Response response;
  httplib::Error error = httplib::Error::Success;
  has_lasting_effect = true;  // the box may carry the request out, whatever comes back
  Deadline deadline(client);
  const bool has_answer = client.send(request, response, error);
  const bool is_late = deadline.has_passed();
  if (is_too_long) refuse_stranger(options.box, "its answer is longer than 1 MiB");
  if (is_late) refuse_stranger(options.box, "its answer does not end");
  if (!has_answer) {
    const std::string why =
        error == httplib::Error::Connection ? "nothing listens there" : httplib::to_string(error);
    throw InputError(options.box, "no box answers: " + why,
                     "start condyle-box, or give its address with --box");
  }
  answer.status = response.status;
  return answer;
}

int post(const SessionOptions& options, const char* path, const nlohmann::json& body) {
  httplib::Request request;
  request.method = "POST";
  request.path = path;
  request.body = body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  request.set_header("Content-Type", "application/json");
  const BoxAnswer answer = ask(options, std::move(request));
  print_output(read_command_answer(options.box, answer.status, answer.text) + "\n");
  return kExitOk;
}

int print_status(const SessionOptions& options) {
  httplib::Request request;
  request.method = "GET";
  request.path = "/v1/status";
  const BoxAnswer answer = ask(options, std::move(request));
  print_output(read_status_answer(options.box, answer.status, answer.text));
  return kExitOk;
}

}  // namespace

Command add_session(CommandLine app) {
  auto options = std::make_shared<SessionOptions>();
  const CommandLine command = app.add_command(
      "session", "Start, mark and stop recordings of a measurement box", "Measure with a device");
  command.add_example("condyle session start --subject P07",
                      "Start a recording on the box of this computer.");
  command.add_example("condyle session status --box http://192.0.2.7:8750 --token-file token",
                      "Show the state of another box.");
  command.add_option("--box", options->box, "Address of the box").show_default();
  command.add_option("--token-file=FILE", options->token_file, "File with the box's token");
  const CommandLine start = command.add_command("start", "Start a recording");
  start.add_option("--subject", options->subject, "Pseudonymous code of the subject");
  const CommandLine mark =
      command.add_command("mark", "Add a marker to the recording, at the present time");
  mark.add_option("TEXT", options->text, "Text of the marker").required();
  const CommandLine stop = command.add_command("stop", "End the recording");
  const CommandLine status = command.add_command("status", "Show the state of the box as JSON");
  command.require_command();
  for (CommandLine part : {start, mark, stop, status}) part.pass_on_unknown();
  return [options, start, mark, stop] {
    if (start.is_given())
      return post(*options, "/v1/session/start", {{"subject", options->subject}});
    if (mark.is_given()) return post(*options, "/v1/session/marker", {{"text", options->text}});
    if (stop.is_given()) return post(*options, "/v1/session/stop", nlohmann::json::object());
    return print_status(*options);
  };
}

}  // namespace condyle::host
