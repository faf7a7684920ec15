// SPDX-License-Identifier: Apache-2.0
#include <httplib.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "commands.h"
#include "input_error.h"
#include "text_file.h"

namespace condyle::host {
namespace {

struct SessionOptions {
  std::string box = "http://127.0.0.1:8750";
  std::string token_file;
  std::string subject, text;
};

httplib::Client client_of(const SessionOptions& options) {
  httplib::Client client(options.box);
  if (!client.is_valid()) {
    throw InputError("--box", "\"" + options.box + "\" is no address of a box",
                     "write it like http://127.0.0.1:8750");
  }
  client.set_connection_timeout(5);
  client.set_read_timeout(30);
  if (!options.token_file.empty()) {
    client.set_bearer_token_auth(read_text_line(options.token_file));
  }
  return client;
}

int tell(const SessionOptions& options, const httplib::Result& result) {
  if (!result) {
    throw InputError(options.box, "no box answers: " + httplib::to_string(result.error()),
                     "start condyle-box, or say with --box where it is");
  }
  const nlohmann::json answer = nlohmann::json::parse(result->body, nullptr, false);
  const bool is_done = result->status == 200;
  const char* const key = is_done ? "done" : "problem";
  const std::string words = answer.is_object() && answer.contains(key) && answer[key].is_string()
                                ? answer[key].get<std::string>()
                                : "HTTP status " + std::to_string(result->status);
  if (!is_done) throw InputError(options.box, words, "");
  print_output(words + "\n");
  return kExitOk;
}

int post(const SessionOptions& options, const char* path, const nlohmann::json& body) {
  httplib::Client client = client_of(options);
  return tell(options,
              client.Post(path, body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                          "application/json"));
}

int print_status(const SessionOptions& options) {
  httplib::Client client = client_of(options);
  const httplib::Result result = client.Get("/v1/status");
  if (!result || result->status != 200) return tell(options, result);
  print_output(result->body);
  return kExitOk;
}

}  // namespace

Command add_session(CommandLine app) {
  auto options = std::make_shared<SessionOptions>();
  const CommandLine command =
      app.add_command("session", "Start, mark and stop recordings of a measurement box");
  command.add_option("--box", options->box, "Where the box listens").show_default();
  command.add_option("--token-file", options->token_file, "File with the box's token");
  const CommandLine start = command.add_command("start", "Begin to record");
  start.add_option("--subject", options->subject, "Pseudonymous code of the subject");
  const CommandLine mark = command.add_command("mark", "Note something that happens now");
  mark.add_option("TEXT", options->text, "What happens").required();
  const CommandLine stop = command.add_command("stop", "End the recording");
  const CommandLine status = command.add_command("status", "Show how the box does, as JSON");
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
