/* SPDX-License-Identifier: Apache-2.0
 *
 * The C interface, from C99: what it gives, and what it says to mistakes. Ends with 1 at the first
 * difference. usage: c_interface RECORDING.csv (one axis) SCENARIO.toml (three points)
 */
#include <condyle.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(holds)                                                                      \
  do {                                                                                     \
    if (!(holds)) {                                                                        \
      fprintf(stderr, "%s:%d: not true: %s (last error: %s)\n", __FILE__, __LINE__, #holds, \
              condyle_last_error());                                                       \
      exit(1);                                                                             \
    }                                                                                      \
  } while (0)

/* The call has this status, and its error contains `words`. */
#define EXPECT_ERROR(call, status, words)                         \
  do {                                                            \
    EXPECT((call) == (status));                                   \
    EXPECT(strstr(condyle_last_error(), words) != NULL);          \
  } while (0)

static condyle_estimator *made(int kind, int has_drive, const char *option) {
  condyle_estimator *estimator = NULL;
  const char *options[1];
  options[0] = option;
  EXPECT(condyle_estimator_create(kind, has_drive, 0.01, NULL, options, option != NULL,
                                  &estimator) == CONDYLE_OK);
  EXPECT(estimator != NULL);
  return estimator;
}

static int same(double a, double b) {
  return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void check_words(void) {
  int i;
  EXPECT(strlen(condyle_version()) > 0);
  EXPECT(strcmp(condyle_provenance_name(CONDYLE_MEASURED), "measured") == 0);
  EXPECT(strcmp(condyle_provenance_name(-1), "") == 0);
  EXPECT(strcmp(condyle_provenance_name(4), "") == 0);
  for (i = 0; i < condyle_event_count(); ++i) EXPECT(strlen(condyle_event_name(i)) > 0);
  EXPECT(strcmp(condyle_event_name(condyle_event_count()), "") == 0);
  for (i = 1; i < condyle_limit_count(); ++i) EXPECT(strlen(condyle_limit_name(i)) > 0);
  EXPECT(strcmp(condyle_limit_name(-3), "") == 0);
  EXPECT(condyle_coordinate_count(CONDYLE_THREE_POINTS) == 9);
  EXPECT(condyle_coordinate_count(99) == 0);
}

static void check_misuse(const char *path) {
  const double position[9] = {0};
  double step_s = 0;
  const char *unknown[] = {"--lagg=8"}, *bad[] = {"--lag=eight"}, *help[] = {"--help"};
  const char *nothing[] = {NULL};
  condyle_recording *recording = NULL;
  condyle_estimator *estimator = NULL;
  condyle_readings *readings = NULL;
  condyle_estimate estimate;
  condyle_value value;
  EXPECT_ERROR(condyle_recording_read(NULL, NULL, 0, &recording), CONDYLE_BAD_CALL, "source");
  EXPECT_ERROR(condyle_recording_read("", NULL, 0, &recording), CONDYLE_BAD_CALL, "empty");
  EXPECT_ERROR(condyle_recording_read(path, NULL, 0, NULL), CONDYLE_BAD_CALL, "recording");
  EXPECT_ERROR(condyle_recording_read(path, NULL, 1, &recording), CONDYLE_BAD_CALL, "options");
  EXPECT_ERROR(condyle_recording_read(path, nothing, 1, &recording), CONDYLE_BAD_CALL, "NULL");
  EXPECT_ERROR(condyle_recording_read("no/such.csv", NULL, 0, &recording), CONDYLE_BAD_INPUT,
               "no/such.csv");
  EXPECT_ERROR(condyle_recording_read(path, unknown, 1, &recording), CONDYLE_BAD_INPUT, "--lagg");
  EXPECT(recording == NULL);
  EXPECT(condyle_recording_count(NULL) == 0 && condyle_recording_position(NULL) == NULL);
  EXPECT(strcmp(condyle_recording_note(NULL, 0), "") == 0);
  condyle_recording_free(NULL);

  EXPECT_ERROR(condyle_estimator_create(7, 0, 0, NULL, NULL, 0, &estimator), CONDYLE_BAD_CALL,
               "kind");
  EXPECT_ERROR(condyle_estimator_create(0, 0, -1, NULL, NULL, 0, &estimator), CONDYLE_BAD_CALL,
               "step_s");
  EXPECT_ERROR(condyle_estimator_create(0, 0, (double)NAN, NULL, NULL, 0, &estimator),
               CONDYLE_BAD_CALL, "step_s");
  EXPECT_ERROR(condyle_estimator_create(0, 0, 0, NULL, NULL, 0, NULL), CONDYLE_BAD_CALL,
               "estimator");
  EXPECT_ERROR(condyle_estimator_create(0, 0, 0, NULL, unknown, 1, &estimator), CONDYLE_BAD_INPUT,
               "did you mean --lag?");
  EXPECT_ERROR(condyle_estimator_create(0, 0, 0, NULL, bad, 1, &estimator), CONDYLE_BAD_INPUT,
               "eight");
  EXPECT_ERROR(condyle_estimator_create(0, 0, 0, NULL, help, 1, &estimator), CONDYLE_BAD_INPUT,
               "no options here");
  /* The text of parameters: line, key and remedy. */
  EXPECT_ERROR(condyle_estimator_create(0, 0, 0, "[noise]\nposition_sd = 1\n", NULL, 0, &estimator),
               CONDYLE_BAD_INPUT, "parameters:2");
  EXPECT(strstr(condyle_last_error(), "position_sd") != NULL);
  EXPECT_ERROR(condyle_estimator_create(0, 0, 0, "[noise\n", NULL, 0, &estimator),
               CONDYLE_BAD_INPUT, "parameters:1");
  EXPECT_ERROR(condyle_estimator_create(0, 0, 100, NULL, NULL, 0, &estimator), CONDYLE_BAD_INPUT,
               "longest_gap_s");
  EXPECT(estimator == NULL);
  condyle_estimator_free(NULL);

  EXPECT_ERROR(condyle_estimator_push(NULL, 0, position, 1, CONDYLE_NO_DRIVE), CONDYLE_BAD_CALL,
               "estimator");
  EXPECT_ERROR(condyle_estimator_take(NULL, &estimate, sizeof estimate), CONDYLE_BAD_CALL,
               "estimator");
  EXPECT(condyle_estimator_finish(NULL) == CONDYLE_BAD_CALL);
  EXPECT(condyle_estimator_conclude(NULL, &value, &value) == CONDYLE_BAD_CALL);
  EXPECT(condyle_estimator_column_count(NULL) == 0);
  EXPECT(condyle_median_step(0, NULL, NULL, &step_s) == CONDYLE_BAD_CALL);
  EXPECT(condyle_median_step(1, position, NULL, NULL) == CONDYLE_BAD_CALL);

  EXPECT_ERROR(condyle_analyse("no/such.csv", NULL, 0, &readings), CONDYLE_BAD_INPUT, "no/such");
  EXPECT(condyle_analyse(path, NULL, 0, NULL) == CONDYLE_BAD_CALL);
  EXPECT(condyle_readings_count(NULL) == 0);
  EXPECT(condyle_readings_file(NULL, "readings.csv") == NULL);
  condyle_readings_free(NULL);
}

static void check_samples(void) {
  const double missing[3] = {(double)NAN, 0, 0}, infinite[3] = {HUGE_VAL, 0, 0};
  const double far[3] = {-3.697e28, -3.697e28, -3.697e28};
  double position[3] = {0.001, 0.002, 0.003};
  condyle_estimator *estimator = made(CONDYLE_ONE_POINT, 0, NULL);
  condyle_estimate estimate;
  condyle_value value;
  EXPECT(condyle_estimator_take(estimator, &estimate, sizeof estimate) == CONDYLE_NONE);
  EXPECT_ERROR(condyle_estimator_push(estimator, 0, NULL, 3, CONDYLE_NO_DRIVE), CONDYLE_BAD_CALL,
               "position");
  EXPECT_ERROR(condyle_estimator_push(estimator, 0, position, 1, CONDYLE_NO_DRIVE),
               CONDYLE_BAD_CALL, "coordinate_count");
  EXPECT_ERROR(condyle_estimator_push(estimator, 0, position, 3, 1.0), CONDYLE_BAD_INPUT, "drive");
  EXPECT_ERROR(condyle_estimator_push(estimator, (double)NAN, position, 3, CONDYLE_NO_DRIVE),
               CONDYLE_BAD_INPUT, "sample 0");
  EXPECT_ERROR(condyle_estimator_push(estimator, 1e300, position, 3, CONDYLE_NO_DRIVE),
               CONDYLE_BAD_INPUT, "time");
  EXPECT(condyle_estimator_push(estimator, 1.0, position, 3, CONDYLE_NO_DRIVE) == CONDYLE_OK);
  EXPECT(strcmp(condyle_last_error(), "") == 0);
  EXPECT_ERROR(condyle_estimator_push(estimator, 0.5, position, 3, CONDYLE_NO_DRIVE),
               CONDYLE_BAD_INPUT, "runs backwards");
  EXPECT_ERROR(condyle_estimator_push(estimator, 1.01, infinite, 3, CONDYLE_NO_DRIVE),
               CONDYLE_BAD_INPUT, "infinite");
  /* Missing, or a maker's number for it: an event, and no value is invented. */
  EXPECT(condyle_estimator_push(estimator, 1.01, missing, 3, CONDYLE_NO_DRIVE) == CONDYLE_OK);
  EXPECT(condyle_estimator_push(estimator, 1.02, far, 3, CONDYLE_NO_DRIVE) == CONDYLE_OK);
  EXPECT_ERROR(condyle_estimator_take(estimator, &estimate, 8), CONDYLE_BAD_CALL, "size");
  EXPECT(condyle_estimator_take(estimator, &estimate, sizeof estimate) == CONDYLE_OK);
  EXPECT(estimate.events != 0);
  EXPECT(estimate.followed.velocity_m_s.provenance != CONDYLE_MEASURED);
  EXPECT_ERROR(condyle_estimator_conclude(estimator, &value, &value), CONDYLE_BAD_CALL, "drive");
  EXPECT(condyle_estimator_finish(estimator) == CONDYLE_OK);
  EXPECT(condyle_estimator_finish(estimator) == CONDYLE_BAD_CALL);
  EXPECT(condyle_estimator_push(estimator, 2, position, 3, CONDYLE_NO_DRIVE) == CONDYLE_BAD_CALL);
  condyle_estimator_free(estimator);

  /* The same faults as events. */
  estimator = made(CONDYLE_ONE_POINT, 0, "--faults=event");
  EXPECT(condyle_estimator_push(estimator, 1.0, position, 3, CONDYLE_NO_DRIVE) == CONDYLE_OK);
  EXPECT(condyle_estimator_push(estimator, 0.5, position, 3, CONDYLE_NO_DRIVE) == CONDYLE_OK);
  EXPECT(condyle_estimator_take(estimator, &estimate, sizeof estimate) == CONDYLE_OK);
  EXPECT(estimate.events >> 1 & 1U && strcmp(condyle_event_name(1), "time_reversed") == 0);
  EXPECT(condyle_estimator_push(estimator, (double)NAN, infinite, 3, CONDYLE_NO_DRIVE) ==
         CONDYLE_OK);
  condyle_estimator_free(estimator);

  /* Units: a jaw does not move by 15 m. */
  {
    enum { kCount = 100 };
    static double time_s[kCount], far_away[kCount], table[64][kCount];
    double *columns[64];
    size_t i;
    for (i = 0; i < kCount; ++i) {
      time_s[i] = 0.01 * (double)i;
      far_away[i] = 9 * sin(0.3 * (double)i);
    }
    estimator = made(CONDYLE_ONE_AXIS, 0, NULL);
    EXPECT(condyle_estimator_column_count(estimator) <= 64);
    for (i = 0; i < 64; ++i) columns[i] = table[i];
    EXPECT_ERROR(condyle_estimator_run(estimator, kCount, time_s, NULL, far_away, 1, NULL, columns,
                                       condyle_estimator_column_count(estimator)),
                 CONDYLE_BAD_INPUT, "give the positions in metres");
    condyle_estimator_free(estimator);
  }
}

/* A whole run gives the same as sample by sample, with a lag too. */
static void check_run(const char *path, const char *option, int has_drive) {
  condyle_recording *recording = NULL;
  condyle_estimator *one, *all;
  condyle_estimate estimate;
  double *columns[128] = {NULL}, *drive_N, step_s = 0;
  size_t count, columns_count, i, row = 0, velocity = 0, sd = 0, time = 0;
  const int64_t *time_ns;
  EXPECT(condyle_recording_read(path, NULL, 0, &recording) == CONDYLE_OK);
  EXPECT(condyle_recording_kind(recording) == CONDYLE_ONE_AXIS);
  count = condyle_recording_count(recording);
  time_ns = condyle_recording_time_ns(recording);
  EXPECT(count > 1000 && strlen(condyle_recording_format(recording)) > 0);
  EXPECT(condyle_median_step(count, NULL, time_ns, &step_s) == CONDYLE_OK);
  EXPECT(step_s > 0 && same(step_s, condyle_recording_step_s(recording)));
  one = made(CONDYLE_ONE_AXIS, has_drive, option);
  all = made(CONDYLE_ONE_AXIS, has_drive, option);
  columns_count = condyle_estimator_column_count(all);
  EXPECT(columns_count > 10 && columns_count <= 128);
  drive_N = malloc(count * sizeof *drive_N);
  for (i = 0; i < count; ++i) drive_N[i] = 0.1 * sin(0.01 * (double)i);
  for (i = 0; i < columns_count; ++i) {
    const char *name = condyle_estimator_column_name(all, i);
    if (strcmp(name, "velocity_m_s") == 0) velocity = i;
    if (strcmp(name, "velocity_sd_m_s") == 0) sd = i;
    columns[i] = malloc(count * sizeof *columns[i]);
  }
  EXPECT(strcmp(condyle_estimator_column_name(all, 0), "time_s") == 0);
  EXPECT(velocity > 0 && sd > 0);
  EXPECT(strcmp(condyle_estimator_column_name(all, columns_count), "") == 0);
  EXPECT(condyle_estimator_run(all, count, NULL, time_ns, condyle_recording_position(recording), 1,
                               has_drive ? drive_N : NULL, columns, columns_count) == CONDYLE_OK);
  EXPECT(condyle_estimator_run(all, count, NULL, time_ns, condyle_recording_position(recording), 1,
                               has_drive ? drive_N : NULL, columns,
                               columns_count) == CONDYLE_BAD_CALL);
  for (i = 0; i <= count; ++i) {
    if (i < count) {
      EXPECT(condyle_estimator_push_ns(one, time_ns[i], condyle_recording_position(recording) + i,
                                       1, has_drive ? drive_N[i] : CONDYLE_NO_DRIVE) == CONDYLE_OK);
    } else {
      EXPECT(condyle_estimator_finish(one) == CONDYLE_OK);
    }
    while (condyle_estimator_take(one, &estimate, sizeof estimate) == CONDYLE_OK) {
      const condyle_value of = estimate.followed.velocity_m_s;
      EXPECT(same(columns[time][row], estimate.time_s) && estimate.time_ns == time_ns[row]);
      EXPECT(same(columns[velocity][row], of.value) && same(columns[sd][row], of.sd));
      EXPECT(isnan(of.value) || (of.low < of.value && of.value < of.high));
      EXPECT(estimate.lag_s >= 0);
      ++row;
    }
  }
  EXPECT(row == count);
  EXPECT(estimate.followed.velocity_m_s.provenance == CONDYLE_MEASURED);
  if (has_drive && (option == NULL || strstr(option, "published") == NULL)) {
    condyle_value a[2], b[2];
    EXPECT(condyle_estimator_conclude(one, &a[0], &a[1]) == CONDYLE_OK);
    EXPECT(condyle_estimator_conclude(all, &b[0], &b[1]) == CONDYLE_OK);
    EXPECT(same(a[0].value, b[0].value) && same(a[1].sd, b[1].sd));
    /* This drive has nothing to do with the motion. */
    EXPECT(a[0].provenance != CONDYLE_MEASURED && strlen(condyle_limit_name(a[0].limit)) > 0);
  }
  for (i = 0; i < columns_count; ++i) free(columns[i]);
  free(drive_N);
  condyle_estimator_free(one);
  condyle_estimator_free(all);
  condyle_recording_free(recording);
}

static void check_readings(const char *scenario) {
  char source[4096];
  condyle_readings *readings = NULL;
  condyle_reading reading;
  size_t count, i, withheld = 0;
  snprintf(source, sizeof source, "sim:%s", scenario);
  EXPECT(condyle_analyse(source, NULL, 0, &readings) == CONDYLE_OK);
  count = condyle_readings_count(readings);
  EXPECT(count > 0);
  EXPECT(condyle_readings_get(readings, count, &reading, sizeof reading) == CONDYLE_BAD_CALL);
  EXPECT(condyle_readings_get(readings, 0, &reading, 1) == CONDYLE_BAD_CALL);
  EXPECT(condyle_readings_get(readings, 0, NULL, sizeof reading) == CONDYLE_BAD_CALL);
  for (i = 0; i < count; ++i) {
    EXPECT(condyle_readings_get(readings, i, &reading, sizeof reading) == CONDYLE_OK);
    EXPECT(strlen(reading.name) > 0 && strlen(reading.definition) > 0);
    if (strcmp(reading.provenance, "withheld") == 0) {
      ++withheld;
      EXPECT(isnan(reading.value) && strlen(reading.reason) > 0);
    } else {
      EXPECT(reading.low <= reading.value && reading.value <= reading.high);
    }
  }
  EXPECT(withheld < count);
  EXPECT(strstr(condyle_readings_file(readings, "readings.csv"), "recording,task,side") != NULL);
  EXPECT(strstr(condyle_readings_file(readings, "readings.json"), "condyle-readings-1") != NULL);
  EXPECT(condyle_readings_file(readings, "other.csv") == NULL);
  EXPECT(strstr(condyle_last_error(), "summary.txt") != NULL);
  EXPECT(condyle_readings_file(readings, NULL) == NULL);
  condyle_readings_free(readings);
}

int main(int argc, char **argv) {
  if (argc != 3) return 2;
  check_words();
  check_misuse(argv[1]);
  check_samples();
  check_run(argv[1], NULL, 0);
  check_run(argv[1], "--lag=8", 0);
  check_run(argv[1], NULL, 1);
  check_readings(argv[2]);
  puts("the C interface holds");
  return 0;
}
