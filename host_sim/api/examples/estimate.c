/* SPDX-License-Identifier: Apache-2.0
 *
 * Reads a recording and prints the velocity of its followed axis each second, with its 95 %
 * interval and where it comes from.
 *
 *     cc -std=c99 estimate.c -lcondyle -o estimate && ./estimate recording.csv
 */
#include <condyle.h>
#include <stdio.h>

static int fail(void) {
  fprintf(stderr, "%s\n", condyle_last_error());
  return 2;
}

static void print(const condyle_estimate *estimate) {
  const condyle_value velocity = estimate->followed.velocity_m_s;
  printf("%8.3f s  velocity %9.2f mm/s, from %9.2f to %9.2f, %s\n", estimate->time_s,
         velocity.value * 1e3, velocity.low * 1e3, velocity.high * 1e3,
         condyle_provenance_name(velocity.provenance));
}

int main(int argc, char **argv) {
  condyle_recording *recording = NULL;
  condyle_estimator *estimator = NULL;
  condyle_estimate estimate;
  const char *options[] = {"--lag=2", "--faults=event"};
  const int64_t *time_ns;
  const double *position;
  size_t count, width, i;
  int kind;
  double next_s = 0;
  if (argc != 2) {
    fprintf(stderr, "usage: estimate RECORDING\n");
    return 2;
  }
  if (condyle_recording_read(argv[1], NULL, 0, &recording) != CONDYLE_OK) return fail();
  kind = condyle_recording_kind(recording);
  width = condyle_coordinate_count(kind);
  count = condyle_recording_count(recording);
  time_ns = condyle_recording_time_ns(recording);
  position = condyle_recording_position(recording);
  if (condyle_estimator_create(kind, 0, condyle_recording_step_s(recording), NULL, options, 2,
                               &estimator) != CONDYLE_OK) {
    condyle_recording_free(recording);
    return fail();
  }
  for (i = 0; i < count; ++i) {
    if (condyle_estimator_push_ns(estimator, time_ns[i], position + i * width, width,
                                  CONDYLE_NO_DRIVE) != CONDYLE_OK) {
      break;
    }
    if (condyle_estimator_take(estimator, &estimate, sizeof estimate) == CONDYLE_OK &&
        estimate.time_s >= next_s) {
      print(&estimate);
      next_s = estimate.time_s + 1;
    }
  }
  if (i == count) condyle_estimator_finish(estimator);
  while (condyle_estimator_take(estimator, &estimate, sizeof estimate) == CONDYLE_OK) {
    print(&estimate);
  }
  condyle_estimator_free(estimator);
  condyle_recording_free(recording);
  return i == count ? 0 : fail();
}
