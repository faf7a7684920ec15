/* SPDX-License-Identifier: Apache-2.0
 *
 * condyle for C99, and for every language that can call C: read recordings of jaw motion, estimate
 * from samples, read range of motion and chewing. Research use only; not a diagnosis.
 *
 * Objects are opaque. A function that makes one gives it through its last argument; the function
 * that ends in _free takes it back, and accepts NULL. Texts are UTF-8. A text that a function
 * returns lives as long as the object that it belongs to.
 *
 * One object may be used by one thread at a time; different objects by different threads.
 *
 * Options are the words that the command takes, such as "--lag=8": of `condyle replay` for
 * recordings and estimators, of `condyle analyse` for readings.
 *
 * Example: host_sim/api/examples/estimate.c. Page: host_sim/docs/languages.md.
 */
#ifndef CONDYLE_H
#define CONDYLE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define CONDYLE_API __attribute__((visibility("default")))
#else
#define CONDYLE_API
#endif

/* What a function returns. */
typedef enum condyle_status {
  CONDYLE_OK = 0,
  CONDYLE_NONE = 1,      /* no estimate yet; not an error */
  CONDYLE_BAD_CALL = 2,  /* an argument cannot be: a mistake of the calling program */
  CONDYLE_BAD_INPUT = 3, /* a file, an option or a sample cannot be used */
  CONDYLE_FAILED = 4     /* memory ran out, or a fault of the library */
} condyle_status;

/* The meaning of a sample's coordinates, all in metres. */
typedef enum condyle_kind {
  CONDYLE_ONE_AXIS = 0,     /* 1 coordinate: the position along one axis */
  CONDYLE_ONE_POINT = 1,    /* 3: x, y, z */
  CONDYLE_THREE_POINTS = 2, /* 9: x, y, z of points 1, 2, 3 */
  CONDYLE_POSE = 3          /* 7: x, y, z; unit quaternion w, x, y, z */
} condyle_kind;

/* Where a value comes from. */
typedef enum condyle_provenance {
  CONDYLE_NOT_COMPUTED = 0, /* the value is NaN */
  CONDYLE_ASSUMED = 1,      /* the prior or the tuning determines it, not the subject */
  CONDYLE_DERIVED = 2,      /* a measured quantity times a named assumption */
  CONDYLE_MEASURED = 3      /* the measurements determine it */
} condyle_provenance;

/* A time that is not known. */
#define CONDYLE_NO_TIME INT64_MIN
/* A sample without a drive. */
#define CONDYLE_NO_DRIVE ((double)NAN)

/* Version of the library, such as "0.1.0". */
CONDYLE_API const char* condyle_version(void);

/* What was wrong in the last call of this thread that returned no success: the place (file, line,
 * column, or sample), the problem and the remedy, in one line. Empty if nothing was wrong. */
CONDYLE_API const char* condyle_last_error(void);

/* Words for codes; "" for a code that does not exist. */
CONDYLE_API const char* condyle_provenance_name(int provenance);
CONDYLE_API const char* condyle_event_name(int bit); /* of an estimate's `events` */
CONDYLE_API const char* condyle_limit_name(int limit);
CONDYLE_API int condyle_event_count(void);
CONDYLE_API int condyle_limit_count(void);

/* Number of coordinates of a kind; 0 for a kind that does not exist. */
CONDYLE_API size_t condyle_coordinate_count(int kind);

/* ---- Recordings: a file in any format that the command reads, as arrays. ---- */

typedef struct condyle_recording condyle_recording;

/* Reads all of `source`: a path, or sim:SCENARIO.toml. Options: --faults, --marker, --columns,
 * --rate-Hz, --unit, --profile, --movement, --ignore-column. */
CONDYLE_API condyle_status condyle_recording_read(const char* source, const char* const* options,
                                                  size_t option_count,
                                                  condyle_recording** recording);
CONDYLE_API void condyle_recording_free(condyle_recording* recording);

CONDYLE_API int condyle_recording_kind(const condyle_recording* recording);
CONDYLE_API size_t condyle_recording_count(const condyle_recording* recording); /* samples */
/* One a sample; CONDYLE_NO_TIME if it is missing. */
CONDYLE_API const int64_t* condyle_recording_time_ns(const condyle_recording* recording);
/* condyle_coordinate_count() a sample; NaN if missing. */
CONDYLE_API const double* condyle_recording_position(const condyle_recording* recording);
/* One a sample, NaN if missing; NULL if the recording has no drive. */
CONDYLE_API const double* condyle_recording_drive_N(const condyle_recording* recording);
/* The time between samples by which `replay` finds gaps (s); 0 if it is not known. */
CONDYLE_API double condyle_recording_step_s(const condyle_recording* recording);
/* The format, in words. */
CONDYLE_API const char* condyle_recording_format(const condyle_recording* recording);
/* What was recognised or left out; "" from the number of notes on. */
CONDYLE_API size_t condyle_recording_note_count(const condyle_recording* recording);
CONDYLE_API const char* condyle_recording_note(const condyle_recording* recording, size_t index);
/* Parameters that the recording holds, as TOML; "" without. */
CONDYLE_API const char* condyle_recording_parameters(const condyle_recording* recording);

/* ---- Estimators. ---- */

typedef struct condyle_estimator condyle_estimator;

/* An estimator for samples of `kind`. `has_drive`: the samples have a drive, and friction and mass
 * are identified. `step_s`: the time between samples, for finding gaps; 0 if it is not known.
 * `parameters_toml`: the text of a parameter file; NULL: the defaults. Options: --estimator, --lag,
 * --parameters, --point, --axis, --jaw-point-mm, --faults, --drive-missing and the others of the
 * drive. */
CONDYLE_API condyle_status condyle_estimator_create(int kind, int has_drive, double step_s,
                                                    const char* parameters_toml,
                                                    const char* const* options, size_t option_count,
                                                    condyle_estimator** estimator);
CONDYLE_API void condyle_estimator_free(condyle_estimator* estimator);

/* Gives the next sample. `position`: `coordinate_count` coordinates (m), which must be those of the
 * kind; NaN if missing, which is an event. `drive_N`: NaN without. A time that is missing or runs
 * backwards and a number that is infinite are refused, and the sample is not used; with
 * --faults=event they are events too. */
CONDYLE_API condyle_status condyle_estimator_push(condyle_estimator* estimator, double time_s,
                                                  const double* position, size_t coordinate_count,
                                                  double drive_N);
/* The same with a time in nanoseconds, which is exact on any clock. */
CONDYLE_API condyle_status condyle_estimator_push_ns(condyle_estimator* estimator, int64_t time_ns,
                                                     const double* position,
                                                     size_t coordinate_count, double drive_N);

/* After the last sample: the estimates that wait for later ones can then be taken. */
CONDYLE_API condyle_status condyle_estimator_finish(condyle_estimator* estimator);

/* A value. `low` and `high`: its 95 % interval by the model. NaN if there is none. */
typedef struct condyle_value {
  double value, sd, low, high;
  int32_t provenance; /* condyle_provenance */
  int32_t limit;      /* why friction or mass is withheld: condyle_limit_name(); 0: it is not */
} condyle_value;

/* What is known of one axis at one instant. */
typedef struct condyle_axis_estimate {
  condyle_value position_m, velocity_m_s, acceleration_m_s2;
  double noise_sd_m; /* of the instrument, as estimated or given */
} condyle_axis_estimate;

/* The estimate for one instant. Fields are added at the end in later versions. */
typedef struct condyle_estimate {
  int64_t time_ns;    /* of the instant; CONDYLE_NO_TIME if it is not known */
  double time_s;      /* the same; NaN if it is not known */
  double lag_s;       /* from this instant to the last sample given; NaN if it is not known */
  uint32_t events;    /* bit i: condyle_event_name(i) */
  int32_t axis_count; /* 1 or 3: how many of `axes` hold values */
  condyle_axis_estimate followed; /* the axis of --axis */
  condyle_axis_estimate axes[3];  /* x, y, z; the recommended estimator's */
  condyle_value force_N, friction_Ns_m, mass_kg;
} condyle_estimate;

/* Takes the next estimate that is ready; CONDYLE_NONE if none is. One that is not taken before the
 * next sample is lost. `size`: sizeof *estimate. */
CONDYLE_API condyle_status condyle_estimator_take(condyle_estimator* estimator,
                                                  condyle_estimate* estimate, size_t size);

/* Friction and mass from all samples so far, as at the end of a recording; only with a drive. */
CONDYLE_API condyle_status condyle_estimator_conclude(condyle_estimator* estimator,
                                                      condyle_value* friction_Ns_m,
                                                      condyle_value* mass_kg);

/* The columns of a whole run: those of the file that `replay --out` writes, all as numbers. A
 * column that ends in _provenance holds codes of condyle_provenance, one that ends in _limit codes
 * of condyle_limit_name(), and `events` a set of bits. */
CONDYLE_API size_t condyle_estimator_column_count(const condyle_estimator* estimator);
CONDYLE_API const char* condyle_estimator_column_name(const condyle_estimator* estimator,
                                                      size_t index);

/* Estimates from a whole array, as `replay` does from a file, bit for bit. The estimator must be
 * new. Gives one row for each sample: `columns[i]` has room for `count` numbers, or is NULL if the
 * column is not wanted; `column_count` is condyle_estimator_column_count(). Either `time_s` or
 * `time_ns`; the other is NULL. `position`: row by row. `drive_N`: NULL without a drive. */
CONDYLE_API condyle_status condyle_estimator_run(condyle_estimator* estimator, size_t count,
                                                 const double* time_s, const int64_t* time_ns,
                                                 const double* position, size_t coordinate_count,
                                                 const double* drive_N, double* const* columns,
                                                 size_t column_count);

/* The median time between samples (s), as `replay` takes it; 0 if there is none. */
CONDYLE_API condyle_status condyle_median_step(size_t count, const double* time_s,
                                               const int64_t* time_ns, double* step_s);

/* ---- Readings: range of motion, condylar paths, chewing. ---- */

typedef struct condyle_readings condyle_readings;

/* Analyses the recording `source`. Options: --landmarks, --tasks, --reference-s, --jaw, --head,
 * --moving, --marker and the others of `condyle analyse`. */
CONDYLE_API condyle_status condyle_analyse(const char* source, const char* const* options,
                                           size_t option_count, condyle_readings** readings);
CONDYLE_API void condyle_readings_free(condyle_readings* readings);

/* A reading, in `unit`. NaN without a value; `reason` says why, or what is assumed. */
typedef struct condyle_reading {
  const char* task; /* "opening" ...; "" for the whole recording */
  const char* side; /* "left", "right" or "" */
  int32_t stroke;   /* from 1; 0: of the whole task */
  const char* name; /* "opening_mm" ... */
  double value, low, high;
  const char *unit, *definition;
  const char* provenance; /* "measured", "derived" or "withheld" */
  const char* reason;
} condyle_reading;

CONDYLE_API size_t condyle_readings_count(const condyle_readings* readings);
/* `size`: sizeof *reading. */
CONDYLE_API condyle_status condyle_readings_get(const condyle_readings* readings, size_t index,
                                                condyle_reading* reading, size_t size);
/* Why no reading can be trusted; "" if they can be. */
CONDYLE_API const char* condyle_readings_unusable(const condyle_readings* readings);
/* The text of a file that `condyle analyse --out` writes: "readings.csv", "readings.json",
 * "cycles.csv", "average_cycle.csv" or "summary.txt"; NULL for another name. */
CONDYLE_API const char* condyle_readings_file(condyle_readings* readings, const char* name);

#ifdef __cplusplus
}
#endif

#endif
