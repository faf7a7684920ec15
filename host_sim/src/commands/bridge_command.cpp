// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bridge/bridge_input.h"
#include "bridge/in_process_node.h"
#include "bridge/node_rows.h"
#include "commands/commands.h"
#include "condyle/hal/link/serial_port.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "hosted/node/node_client.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "output/estimates_file.h"
#include "output/impedance_text.h"
#include "output/lasting_effect.h"
#include "output/progress.h"
#include "output/report_text.h"

namespace condyle::host {
namespace {

constexpr TimeNs kPatience_ns = 20'000'000;
// Of a thread that answers at once, though on a busy computer.
constexpr TimeNs kTwinPatience_ns = 600'000'000'000;
constexpr int kTwinWaits = 250;

struct BridgeOptions {
  std::string input, port, out, serial;
  unsigned baud = 1'000'000;
  double patience_s = seconds(NodeClient::kUsualPatience_ns);
  bool checks = false;
  EstimatorChoice estimator;
  DriveStatement drive_stated;
  RecordingChoice choice;
};

hal::StartMessage start_of(const BridgeOptions& options, const BridgeInput& input) {
  hal::StartMessage start;
  start.followed = options.choice.followed;
  start.expects_drive = input.has_drive;
  start.nominal_step_ns = input.nominal_step_ns.value_or(0);
  if (options.estimator.is_published()) {
    start.estimator = hal::EstimatorChoice::published;
    start.published = load_published_for(options.estimator, input.median_step_ns, options.input);
    start.nominal_step_ns = nanoseconds(start.published.sample_time_s);
  } else {
    start.lag = static_cast<std::uint8_t>(options.estimator.lag);
    start.recommended = options.estimator.load_recommended();
    options.drive_stated.apply(start.recommended.impedance);
    refuse_long_step(start.recommended, seconds(start.nominal_step_ns), options.input,
                     "its median step", kCheckTimes);
  }
  return start;
}

// The same run on this computer; its answers must equal the microcontroller's byte for byte.
class ReferenceRun {
 public:
  ReferenceRun(unsigned scalar_size, const hal::ReportLayout& layout,
               const hal::StartMessage& start, hal::Clock& clock)
      : clock_(clock),
        node_(scalar_size, clock),
        client_(node_.line(), clock, "the estimator on this computer", kTwinPatience_ns) {
    client_.connect([] { return false; });
    client_.begin(layout, start);
  }

  void send(const hal::RawReport& report) {
    while (!client_.has_room()) keep_answer(clock_.now_ns() + kPatience_ns);
    client_.send(report);
  }
  void reconnect() { client_.reconnect(); }
  void finish() { client_.finish(); }

  // Compares an answer of the microcontroller with the next one here. `name` names it for the user.
  template <class Name>
  void compare(NodeAnswer answer, const hal::LinkFrame& frame, Name name) {
    for (int i = 0; answers_.empty() && i < kTwinWaits; ++i) {
      keep_answer(clock_.now_ns() + kPatience_ns);
    }
    ++compared_;
    const bool is_same = !answers_.empty() && answers_.front().is(answer, frame);
    if (!is_same && differences_++ == 0) first_difference_ = name();
    if (!answers_.empty()) answers_.pop_front();
  }

  std::string words() const {
    if (differences_ == 0) {
      return fmt::format("all {} answers are this computer's, byte for byte", compared_);
    }
    return fmt::format("{} of {} answers are not this computer's; the first is {}", differences_,
                       compared_, first_difference_);
  }
  bool is_same() const { return differences_ == 0; }

 private:
  struct Answer {
    NodeAnswer answer;
    std::uint8_t type;
    std::vector<std::uint8_t> payload;

    bool is(NodeAnswer other, const hal::LinkFrame& frame) const {
      return answer == other && type == frame.type &&
             std::equal(payload.begin(), payload.end(), frame.payload.begin(), frame.payload.end());
    }
  };
  void keep_answer(TimeNs deadline_ns) {
    const NodeAnswer answer = client_.receive(deadline_ns);
    if (answer == NodeAnswer::none) return;
    const hal::LinkFrame& frame = client_.frame();
    answers_.push_back({answer, frame.type, {frame.payload.begin(), frame.payload.end()}});
  }

  hal::Clock& clock_;
  InProcessNode node_;
  NodeClient client_;
  std::deque<Answer> answers_;
  std::uint64_t compared_ = 0, differences_ = 0;
  std::string first_difference_;
};

struct BridgeCounts {
  std::uint64_t estimates = 0, without_estimate = 0, without_time = 0, disconnections = 0;
  std::uint64_t rows = 0;  // of estimates; fewer than estimates while a lag fills
};

enum class Fed { report, nothing, reconnected, end };

// Takes the next report; waits at most `wait_ns`.
Fed take_report(BridgeInput& input, TimeNs wait_ns, hal::Clock& clock, hal::RawReport& report,
                BridgeCounts& counts) {
  switch (input.source->read(clock.now_ns() + wait_ns, report)) {
    case hal::Status::ok:
      return Fed::report;
    case hal::Status::timeout:
      return Fed::nothing;
    case hal::Status::bad_report:
      ++counts.without_time;
      return Fed::nothing;
    case hal::Status::disconnected:
      ++counts.disconnections;
      while (input.source->open() != hal::Status::ok) {
        if (stop_requested() || !input.is_live) return Fed::end;
        clock.sleep_until(clock.now_ns() + kPatience_ns);
      }
      return Fed::reconnected;
    default:
      return Fed::end;
  }
}

std::string health_text(const std::optional<hal::HealthMessage>& health) {
  if (!health) return "not known: it no longer answers";
  return fmt::format(
      "{} frames refused, {} lost; {} bytes overrun, {} dropped; {} of {} bytes of stack used",
      health->frames.refused(), health->frames.lost, health->uart_overruns, health->dropped_bytes,
      health->stack_used_bytes, health->stack_size_bytes);
}

// Connects a source of reports and a microcontroller.
class Bridge {
 public:
  Bridge(BridgeInput& input, NodeClient& client, ReferenceRun* reference, NodeRows& rows,
         EstimatesFile* estimates, hal::Clock& clock)
      : input_(input),
        client_(client),
        reference_(reference),
        rows_(rows),
        estimates_(estimates),
        clock_(clock) {}

  // False if the user stopped a recording.
  bool run() {
    Progress progress("feeding", clock_);
    for (NodeAnswer answer = NodeAnswer::none; answer != NodeAnswer::finished;) {
      if (stop_requested()) {
        if (!input_.is_live) return false;
        if (has_input_) finish();  // the user ends a live run
      }
      if (has_input_ && client_.has_room()) feed();
      // A recording has its next report at once; a device is polled every millisecond.
      const TimeNs wait_ns = !client_.has_room() ? kPatience_ns : input_.is_live ? 1'000'000 : 0;
      answer = client_.receive(clock_.now_ns() + wait_ns);
      if (answer != NodeAnswer::none) take(answer);
      progress.show(input_.progress());
    }
    return true;
  }
  const BridgeCounts& counts() const { return counts_; }

 private:
  void feed() {
    const bool is_idle = client_.reports_sent() == counts_.estimates + counts_.without_estimate;
    switch (take_report(input_, is_idle ? kPatience_ns : 0, clock_, report_, counts_)) {
      case Fed::report:
        client_.send(report_);
        if (reference_ != nullptr) reference_->send(report_);
        break;
      case Fed::reconnected:
        client_.reconnect();
        if (reference_ != nullptr) reference_->reconnect();
        break;
      case Fed::nothing:
        break;
      case Fed::end:
        finish();
    }
  }
  void finish() {
    has_input_ = false;
    client_.finish();
    if (reference_ != nullptr) reference_->finish();
  }
  void take(NodeAnswer answer) {
    std::optional<EstimateRow> row;
    if (answer == NodeAnswer::no_estimate) ++counts_.without_estimate;
    if (answer == NodeAnswer::conclusion) rows_.take_conclusion(client_.frame());
    if (answer == NodeAnswer::estimate) {
      ++counts_.estimates;
      row = rows_.row_of(client_.frame());
    }
    if (row) ++counts_.rows;
    if (reference_ != nullptr) {
      reference_->compare(answer, client_.frame(), [&] { return name_of_answer(row); });
    }
    if (row && estimates_ != nullptr) estimates_->write_row(*row);
  }
  // "row 100 of the estimates (time_s 1.65)".
  std::string name_of_answer(const std::optional<EstimateRow>& row) const {
    if (!row) return fmt::format("one without a row, after row {} of the estimates", counts_.rows);
    std::string text = fmt::format("row {} of the estimates", counts_.rows);
    if (!row->time_ns) return text;
    text += " (time_s ";
    append_time_s(text, *row->time_ns);
    return text + ")";
  }

  BridgeInput& input_;
  NodeClient& client_;
  ReferenceRun* reference_;
  NodeRows& rows_;
  EstimatesFile* estimates_;
  hal::Clock& clock_;
  hal::RawReport report_;
  bool has_input_ = true;
  BridgeCounts counts_;
};

int bridge(const BridgeOptions& options) {
  refuse_same_files({options.input, options.estimator.parameters, options.choice.reading.profile},
                    {options.out});
  options.estimator.refuse_if_published("--lag", options.estimator.lag > 0);
  options.estimator.refuse_if_published("an option of the drive, such as --drive-missing",
                                        options.drive_stated.is_given());
  hal::SteadyClock clock;
  BridgeInput input = open_bridge_input(options.input, options.serial, options.choice.reading,
                                        clock, stop_requested);
  options.choice.FollowedChoice::check(options.input, input.layout.kind);
  hal::StartMessage start = start_of(options, input);

  hal::SerialPort port(clock);
  if (port.open(options.port, options.baud) != hal::Status::ok) {
    throw InputError(options.port, port.problem(), "give a serial port, or unix:SOCKET");
  }
  has_lasting_effect = input.is_live;  // Ctrl-C ends a live run
  NodeClient client(port, clock, options.port, nanoseconds(options.patience_s));
  client.connect(stop_requested);
  const unsigned scalar_size = client.greeting().scalar_size;
  if (client.fault()) {
    print_error("the microcontroller had stopped: " + fault_text(*client.fault()));
  }
  start.identifies =
      input.has_drive && !options.estimator.is_published() && client.greeting().identifies;
  start = client.within_memory(start);
  client.begin(input.layout, start);
  std::optional<ReferenceRun> reference;
  if (options.checks) reference.emplace(scalar_size, input.layout, start, clock);

  const bool is_published = options.estimator.is_published();
  const int axis_count = is_published ? 0 : input.layout.kind == SampleKind::one_axis ? 1 : 3;
  std::unique_ptr<EstimatesFile> estimates;
  if (!options.out.empty()) {
    estimates = std::make_unique<EstimatesFile>(
        options.out, axis_count, start.identifies, TableForm(),
        !is_published && start.recommended.learning.kernels >= 1 && start.lag < hal::kMaxLinkLag);
  }
  NodeRows rows(axis_count, options.choice.followed, scalar_size, start.identifies);
  Bridge bridge(input, client, reference ? &*reference : nullptr, rows, estimates.get(), clock);
  bool has_kept = !estimates;
  const auto keep_estimates = [&] {
    if (std::exchange(has_kept, true)) return;
    estimates->close();
    estimates->commit();
  };
  try {
    if (!bridge.run()) return report_stop();
    const std::string problem = input.problem();
    if (!problem.empty()) throw InputError(problem);
    keep_estimates();
  } catch (const InputError& error) {
    if (!input.is_live) throw;
    print_error(error.what());
    if (has_kept) return kExitBadInput;
    keep_estimates();  // a live measurement cannot be repeated
    print_error("the estimates so far are in " + options.out);
    return kExitBadInput;
  }
  const std::optional<hal::HealthMessage> health = client.ask_health();
  const BridgeCounts& counts = bridge.counts();

  ReportText report(17);
  const auto line = [&report](const char* label, const std::string& words) {
    report.line(label, words);
  };
  line("input", options.input + ", " + input.words);
  line("microcontroller", options.port + ": " + greeting_text(client.greeting()));
  line("reports", fmt::format("{} sent, {} lost on the line; {} estimates, {} without one",
                              client.reports_sent(), client.reports_lost(), counts.estimates,
                              counts.without_estimate));
  if (counts.disconnections > 0) {
    line("device", fmt::format("disconnected {} times; counted by the microcontroller: {}",
                               counts.disconnections,
                               health ? std::to_string(health->disconnections) : "not known"));
  }
  if (counts.without_time > 0) {
    line("left out", fmt::format("{} samples without a time", counts.without_time));
  }
  if (start.identifies) {
    report.add(impedance_text(rows.conclusion(), start.recommended.impedance));
  } else if (input.has_drive && !is_published) {
    line("drive",
         "not used: the microcontroller has too little memory to identify friction and mass");
  }
  line("its health", health_text(health));
  line("this computer",
       fmt::format("{} frames refused, {} lost", client.frames_refused(), client.frames_lost()));
  if (reference) line("check", reference->words());
  if (estimates) line("estimates", options.out);
  const bool is_told = try_to_print(report.text());
  const bool is_whole =
      client.reports_lost() == 0 && client.frames_lost() == 0 && rows.unreadable() == 0;
  if (!is_whole) print_error("warning: some reports have no estimate");
  if (!is_told) return kExitBadInput;
  return is_whole && (!reference || reference->is_same()) ? kExitOk : kExitRefused;
}

}  // namespace

Command add_bridge(CommandLine app) {
  auto options = std::make_shared<BridgeOptions>();
  const CommandLine command =
      app.add_command("bridge",
                      "Send reports to an estimator on a microcontroller over a serial line, and "
                      "receive its estimates; Ctrl-C ends a live run",
                      "Measure with a device");
  command.add_example("condyle bridge jaw.csv --port /dev/ttyUSB0 --check --out estimates.csv",
                      "Replay a recording through a microcontroller, and compare each answer with "
                      "this computer's.");
  command.add_example("condyle bridge hid:bow.toml --port /dev/ttyUSB0 --out estimates.csv",
                      "Send it the reports of a device.");
  command
      .add_option("INPUT", options->input,
                  "hid:PROFILE or usb:PROFILE, a device; synth:PROFILE, a synthetic one; or a "
                  "recording, as for replay")
      .required();
  command
      .add_option("--port", options->port,
                  "Serial port of the microcontroller, or unix:SOCKET of an emulator")
      .required();
  command.add_option("--baud", options->baud, "Baud rate").show_default();
  command
      .add_option("--patience-s", options->patience_s,
                  "If an answer is due for this long, the microcontroller is asked whether it is "
                  "there; after four times as long the run ends. At its start, it has 1.5 times as "
                  "long to greet, and this long to accept each message")
      .number_in({0.5, 600})
      .show_default();
  command.add_flag(
      "--check", options->checks,
      "Also run the same estimator on this computer, and compare every answer byte by byte");
  add_estimator_options(command, options->estimator);
  add_drive_options(command, options->drive_stated);
  // The line to the microcontroller names points of the instrument only.
  add_recording_options(command, options->choice, JawPoints::no);
  command.add_option("--serial", options->serial, "Serial number, if several are plugged in");
  command.group("Output").add_option("-o,--out=FILE", options->out, "CSV file for the estimates");
  return [options] { return bridge(*options); };
}

}  // namespace condyle::host
