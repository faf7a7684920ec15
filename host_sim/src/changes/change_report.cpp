// SPDX-License-Identifier: Apache-2.0
#include "changes/change_report.h"

#include <fmt/format.h>

#include <cmath>

#include "hosted/files/number_text.h"
#include "output/gnuplot.h"

namespace condyle::host {
namespace {

std::string line(const char* label, const std::string& words) {
  return fmt::format("{:<14}{}\n", label, words);
}

std::string time_text(TimeNs time_ns) {
  return fmt::format("{:.1f} s", seconds(time_ns));
}

// How many cycles, and why the others are not counted.
std::string cycles_text(const ChangeWatch& watch) {
  std::string others;
  for (const CycleOutcome outcome : {CycleOutcome::irregular, CycleOutcome::incomplete,
                                     CycleOutcome::uncertain, CycleOutcome::lost}) {
    const std::size_t count = count_of(watch, outcome);
    if (count > 0) others += fmt::format(", {} {}", count, cycle_outcome_name(outcome));
  }
  std::string text =
      line("cycles", fmt::format("{} counted{}; {} judged after those from which the detector "
                                 "learned",
                                 watch.counted, others, watch.judged));
  if (watch.counted == 0) return text;
  return text +
         line("",
              fmt::format("{:.2f} s each; damping {:.3g} Ns/m on average of all; stated sd of one "
                          "cycle {:.2g}, scatter of the cycles {:.2f} times that",
                          watch.mean_duration_s, watch.mean_Ns_m, watch.sd_Ns_m, watch.spread));
}

std::string change_text(const ChangeWatch& watch, const DetectedChange& found) {
  const DampingChange<double>& change = found.change;
  const std::string what =
      fmt::format("effective damping {} from {:.3g} (sd {:.2g}) to {:.3g} (sd {:.2g}) Ns/m",
                  found.is_increase ? "INCREASED" : "DECREASED", change.before_Ns_m,
                  change.before_sd, change.after_Ns_m, change.after_sd);
  const std::string when =
      fmt::format("alarm at {}, cycle {}; from about cycle {} on, which ended at {}",
                  time_text(watch.cycles[found.alarm].end_ns), found.alarm + 1,
                  found.first_after + 1, time_text(watch.cycles[found.first_after].end_ns));
  if (found.is_told()) return line("change", what) + line("", when);
  return line("WITHHELD",
              fmt::format("the drive alone may have caused this alarm of {:.2g} Ns/m: as stated, "
                          "it can cause up to {:.2g} Ns/m",
                          std::abs(change.after_Ns_m - change.before_Ns_m), found.of_drive_Ns_m)) +
         line("", when);
}

std::string delay_text(const ChangeWatch& watch, double change_Ns_m, const DetectionDelay& delay) {
  const auto words = [&](const std::optional<double>& cycles) {
    return cycles ? fmt::format("within {:g} cycles ({:.0f} s)", *cycles,
                                *cycles * watch.mean_duration_s)
                  : fmt::format("not within {} cycles", DetectionDelay::kLongest);
  };
  return line("", fmt::format("{:.3g} Ns/m: {} in half of the cases, {} in nine of ten",
                              change_Ns_m, words(delay.median), words(delay.most)));
}

std::string could_find_text(const ChangeWatch& watch, const WatchSettings& settings) {
  std::string text;
  const double smallest = settings.detector.change_Ns_m;
  for (const double change_Ns_m : {smallest, 2 * smallest, 4 * smallest}) {
    const DetectionDelay delay = expected_delay(watch, settings.detector, change_Ns_m);
    if (text.empty()) {
      text = line("can detect", fmt::format("a lasting change after {} such cycles, simulated:",
                                            delay.after_cycles));
    }
    text += delay_text(watch, change_Ns_m, delay);
  }
  return text;
}

std::string lost_text(const ChangeWatch& watch) {
  if (!watch.lost_from) return "";
  return line("WITHHELD",
              fmt::format("from {} on: the motion no longer fits the identified model: the point "
                          "slipped, another force acts,\n              or damping, mass or "
                          "stiffness changed much; analyse a recording that begins there",
                          time_text(watch.cycles[*watch.lost_from].end_ns)));
}

std::string numbers(const std::vector<WatchedCycle>& cycles, bool are_counted) {
  std::string text = are_counted ? "$counted << EOD\n" : "$judged << EOD\n";
  for (const auto& cycle : cycles) {
    const double time_s = seconds(cycle.end_ns);
    const CycleReport<double>& report = cycle.report;
    if (are_counted && report.outcome == CycleOutcome::counted) {
      text += fmt::format("{:.9g} {:.9g} {:.9g}\n", time_s, report.friction_Ns_m,
                          report.standard_deviation);
    } else if (!are_counted && std::isfinite(cycle.threshold)) {
      text += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", time_s, cycle.statistic_up,
                          cycle.statistic_down, cycle.threshold);
    }
  }
  return text + "EOD\n";
}

}  // namespace

std::string changes_text(const ChangeWatch& watch, const WatchSettings& settings) {
  std::string text = cycles_text(watch);
  text +=
      line("false alarms", fmt::format("one in {:g} h of chewing, as requested: {:.0f} cycles",
                                       settings.false_alarm_interval_h, watch.false_alarm_cycles));
  for (const DetectedChange& found : watch.changes) text += change_text(watch, found);
  if (watch.judged == 0) {
    text += line(
        "NOT WATCHED",
        fmt::format("the detector learns from {:g} cycles before it judges the next; record longer",
                    settings.detector.baseline_cycles));
  } else if (watch.changes.empty()) {
    text += line("no change", watch.lost_from ? "none was found before" : "none was found");
  }
  text += lost_text(watch);
  if (watch.of_drive_Ns_m > 0) {
    text +=
        line(watch.of_drive_Ns_m < settings.detector.change_Ns_m ? "note" : "WITHHELD",
             fmt::format("the stated share that the drive may miss can cause or hide a change of "
                         "up to {:.2g} Ns/m; a change\n              that small is not reported",
                         watch.of_drive_Ns_m));
  }
  if (watch.counted > 0) text += could_find_text(watch, settings);
  return text +
         "This detects a change in effective damping; it is not a diagnosis; research use only. "
         "Joint, muscle, tissue, food, and a drive\nwith another missing force or delay look "
         "alike. A slow drift is not detected, nor a change during learning.\n";
}

std::string changes_csv(const ChangeWatch& watch) {
  std::string text =
      "cycle,begin_s,end_s,outcome,damping_Ns_m,damping_sd_Ns_m,statistic_up,statistic_down,"
      "threshold,state\n";
  for (std::size_t i = 0; i < watch.cycles.size(); ++i) {
    const WatchedCycle& cycle = watch.cycles[i];
    text += fmt::format("{},", i + 1);
    append_time_s(text, cycle.end_ns - nanoseconds(cycle.report.duration_s));
    text += ',';
    append_time_s(text, cycle.end_ns);
    text += fmt::format(",{}", cycle_outcome_name(cycle.report.outcome));
    for (const double value : {cycle.report.friction_Ns_m, cycle.report.standard_deviation,
                               cycle.statistic_up, cycle.statistic_down, cycle.threshold}) {
      text += ',';
      append_number(text, value);
    }
    text += fmt::format(",{}\n", cycle.is_watched ? change_state_name(cycle.state) : "not_watched");
  }
  return text;
}

std::vector<std::unique_ptr<OutputFile>> draw_changes(const std::string& directory,
                                                      const std::string& name,
                                                      const ChangeWatch& watch) {
  if (watch.counted == 0) return {};
  Gnuplot gnuplot(directory);
  gnuplot.send(numbers(watch.cycles, true) + numbers(watch.cycles, false));
  std::string alarms;
  for (const DetectedChange& found : watch.changes) {
    const double time_s = seconds(watch.cycles[found.alarm].end_ns);
    alarms += fmt::format(
        "set arrow from first {0:.9g}, graph 0 to first {0:.9g}, graph 1 nohead "
        "lw 1.5 dt (6,4) lc rgb '#c00000'\n",
        time_s);
  }
  const double begin_s = seconds(watch.cycles.front().end_ns);
  const double end_s = seconds(watch.cycles.back().end_ns);
  const std::string title = fmt::format("Effective damping of chewing cycles, {}{}", name,
                                        watch.changes.empty() ? "" : "; dashed red: alarm");
  gnuplot.draw(
      "changes",
      fmt::format(
          "set multiplot\nset lmargin 10\nset rmargin 3\nset xrange [{0:.9g}:{1:.9g}]\n{2}"
          "set origin 0,0.42\nset size 1,0.58\n{3}set ylabel 'damping (Ns/m)'\nset format x ''\n"
          "unset xlabel\nset key left top\nset yrange [*:*]\n"
          "plot $counted using 1:2:3 with yerrorbars pt 7 ps 0.4 lw 0.6 lc rgb '#0b559f' title "
          "'a cycle, with its standard deviation'\n"
          "set origin 0,0\nset size 1,0.45\nunset title\nset ylabel 'statistic'\nset format x\n"
          "set xlabel 'time (s)'\nset yrange [0:*]\n"
          "{4}unset multiplot",
          begin_s, end_s > begin_s ? end_s : begin_s + 1, alarms,
          title_command(title, "font ',11'"),
          watch.judged == 0
              ? "set label 'no cycle was judged' at graph 0.5, graph 0.5 center\n"
                "plot NaN notitle\n"
              : "plot $judged using 1:4 with lines dt 2 lc rgb '#303030' title 'threshold', "
                "$judged using 1:2 with lines lw 1.8 lc rgb '#b35900' title 'more damping', "
                "$judged using 1:3 with lines lw 1.8 lc rgb '#0b559f' title 'less damping'\n"),
      900, 560);
  return gnuplot.finish();
}

}  // namespace condyle::host
