/* SPDX-License-Identifier: Apache-2.0
 *
 * condyle in MATLAB and Octave:
 *
 *   recording = condyle('read', 'session.csv', '--unit=mm')
 *   estimates = condyle('estimate', recording, '--lag=8')
 *   estimates = condyle('estimate', time_s, position_m, '--lag=8')
 *   readings  = condyle('analyse', 'session.csv', '--landmarks=session.landmarks.toml')
 *   version   = condyle('version')
 *
 * Samples are rows. The options are those of the command. Build it once:
 *
 *   mkoctfile --mex condyle.c -lcondyle     (Octave, in a shell)
 *   mex condyle.c -lcondyle                 (MATLAB, at its prompt)
 */
#include <condyle.h>
#include <mex.h>
#include <string.h>

/* Words of options; mex frees them. */
static const char **options_of(int count, const mxArray *const *words) {
  const char **options = mxCalloc((mwSize)count + 1, sizeof *options);
  int i;
  for (i = 0; i < count; ++i) {
    options[i] = mxIsChar(words[i]) ? mxArrayToString(words[i]) : NULL;
    if (options[i] == NULL) {
      mexErrMsgIdAndTxt("condyle:option", "an option is not a text; give words such as '--lag=8'");
    }
  }
  return options;
}

/* Ends the call if it had no success. */
static void check(condyle_status status) {
  if (status != CONDYLE_OK) {
    mexErrMsgIdAndTxt(status == CONDYLE_BAD_INPUT ? "condyle:input" : "condyle:call", "%s",
                      condyle_last_error());
  }
}

static void set(mxArray *structure, mwIndex index, const char *name, mxArray *value) {
  const int field = mxAddField(structure, name);
  mxSetFieldByNumber(structure, index, field, value);
}

/* The path of a recording. */
static const char *path_of(int count, const mxArray *const *arguments) {
  if (count < 2 || !mxIsChar(arguments[1])) {
    mexErrMsgIdAndTxt("condyle:call", "the second argument is not the path of a recording");
  }
  return mxArrayToString(arguments[1]);
}

/* `count` rows of `width` values, from row by row to column by column, or back. */
static void turn(const double *from, double *to, size_t count, size_t width, int to_columns) {
  size_t row, column;
  for (row = 0; row < count; ++row) {
    for (column = 0; column < width; ++column) {
      if (to_columns) {
        to[column * count + row] = from[row * width + column];
      } else {
        to[row * width + column] = from[column * count + row];
      }
    }
  }
}

static mxArray *read_recording(int count, const mxArray *const *arguments) {
  const char *path = path_of(count, arguments);
  const char **options = options_of(count - 2, arguments + 2);
  condyle_recording *recording = NULL;
  mxArray *result = mxCreateStructMatrix(1, 1, 0, NULL), *times, *positions, *notes;
  const double *drive;
  size_t samples, width, i;
  check(condyle_recording_read(path, options, (size_t)(count - 2), &recording));
  samples = condyle_recording_count(recording);
  width = condyle_coordinate_count(condyle_recording_kind(recording));
  times = mxCreateDoubleMatrix(samples, 1, mxREAL);
  for (i = 0; i < samples; ++i) {
    const int64_t time_ns = condyle_recording_time_ns(recording)[i];
    mxGetPr(times)[i] = time_ns == CONDYLE_NO_TIME ? mxGetNaN() : (double)time_ns / 1e9;
  }
  positions = mxCreateDoubleMatrix(samples, width, mxREAL);
  turn(condyle_recording_position(recording), mxGetPr(positions), samples, width, 1);
  set(result, 0, "time_s", times);
  set(result, 0, "position_m", positions);
  drive = condyle_recording_drive_N(recording);
  if (drive != NULL) {
    mxArray *drives = mxCreateDoubleMatrix(samples, 1, mxREAL);
    memcpy(mxGetPr(drives), drive, samples * sizeof *drive);
    set(result, 0, "drive_N", drives);
  }
  set(result, 0, "step_s", mxCreateDoubleScalar(condyle_recording_step_s(recording)));
  set(result, 0, "format", mxCreateString(condyle_recording_format(recording)));
  notes = mxCreateCellMatrix(condyle_recording_note_count(recording), 1);
  for (i = 0; i < condyle_recording_note_count(recording); ++i) {
    mxSetCell(notes, i, mxCreateString(condyle_recording_note(recording, i)));
  }
  set(result, 0, "notes", notes);
  set(result, 0, "parameters", mxCreateString(condyle_recording_parameters(recording)));
  condyle_recording_free(recording);
  return result;
}

static const double *numbers_of(const mxArray *array, size_t rows, const char *name) {
  if (array == NULL || !mxIsDouble(array) || mxIsComplex(array) || mxIsSparse(array) ||
      mxGetNumberOfDimensions(array) != 2 || mxGetM(array) != rows) {
    mexErrMsgIdAndTxt("condyle:call", "%s must be real numbers with one row for each sample", name);
  }
  return mxGetPr(array);
}

/* A row of times is as good as a column. */
static size_t length_of(const mxArray *times) {
  if (times == NULL || (mxGetM(times) != 1 && mxGetN(times) != 1)) {
    mexErrMsgIdAndTxt("condyle:call", "time_s must be a column with one time for each sample");
  }
  return mxGetNumberOfElements(times);
}

static int kind_of(size_t width) {
  int kind;
  for (kind = CONDYLE_ONE_AXIS; kind <= CONDYLE_POSE; ++kind) {
    if (condyle_coordinate_count(kind) == width) return kind;
  }
  mexErrMsgIdAndTxt("condyle:call",
                    "position_m must have 1 column (one axis), 3 (x y z), 9 (three points) or 7 (a "
                    "pose)");
  return -1;
}

static mxArray *estimate(int count, const mxArray *const *arguments) {
  const int is_recording = count > 1 && mxIsStruct(arguments[1]);
  const int first_option = is_recording ? 2 : 3;
  const mxArray *times, *positions, *drives = NULL;
  const char *parameters = NULL;
  const char **options;
  condyle_estimator *estimator = NULL;
  condyle_status status;
  mxArray *result;
  double *rows, **columns, step_s = 0;
  const double *time_s, *drive_N = NULL;
  size_t samples, width, column_count, i;
  if (count < first_option) {
    mexErrMsgIdAndTxt("condyle:call", "give a recording, or time_s and position_m");
  }
  times = is_recording ? mxGetField(arguments[1], 0, "time_s") : arguments[1];
  positions = is_recording ? mxGetField(arguments[1], 0, "position_m") : arguments[2];
  samples = length_of(times);
  time_s = numbers_of(times, mxGetM(times), "time_s");
  width = positions != NULL ? mxGetN(positions) : 0;
  rows = mxCalloc(samples * width + 1, sizeof *rows);
  turn(numbers_of(positions, samples, "position_m"), rows, samples, width, 0);
  check(condyle_median_step(samples, time_s, NULL, &step_s));
  if (is_recording) {
    const mxArray *step = mxGetField(arguments[1], 0, "step_s");
    const mxArray *text = mxGetField(arguments[1], 0, "parameters");
    drives = mxGetField(arguments[1], 0, "drive_N");
    if (drives != NULL) drive_N = numbers_of(drives, samples, "drive_N");
    if (step != NULL) step_s = mxGetScalar(step);
    if (text != NULL && mxGetNumberOfElements(text) > 0) parameters = mxArrayToString(text);
  }
  options = options_of(count - first_option, arguments + first_option);
  check(condyle_estimator_create(kind_of(width), drive_N != NULL, step_s, parameters, options,
                                 (size_t)(count - first_option), &estimator));
  result = mxCreateStructMatrix(1, 1, 0, NULL);
  column_count = condyle_estimator_column_count(estimator);
  columns = mxCalloc(column_count, sizeof *columns);
  for (i = 0; i < column_count; ++i) {
    mxArray *column = mxCreateDoubleMatrix(samples, 1, mxREAL);
    columns[i] = mxGetPr(column);
    set(result, 0, condyle_estimator_column_name(estimator, i), column);
  }
  status = condyle_estimator_run(estimator, samples, time_s, NULL, rows, width, drive_N, columns,
                                 column_count);
  if (status == CONDYLE_OK && drive_N != NULL) {
    condyle_value friction, mass;
    /* The published cascade concludes nothing. */
    if (condyle_estimator_conclude(estimator, &friction, &mass) == CONDYLE_OK) {
      const char *names[] = {"value", "low", "high", "provenance", "limit"};
      const condyle_value *values[2];
      mxArray *both = mxCreateStructMatrix(1, 2, 5, names);
      values[0] = &friction;
      values[1] = &mass;
      for (i = 0; i < 2; ++i) {
        const condyle_value *of = values[i];
        mxSetField(both, i, "value", mxCreateDoubleScalar(of->value));
        mxSetField(both, i, "low", mxCreateDoubleScalar(of->low));
        mxSetField(both, i, "high", mxCreateDoubleScalar(of->high));
        mxSetField(both, i, "provenance",
                   mxCreateString(condyle_provenance_name(of->provenance)));
        mxSetField(both, i, "limit", mxCreateString(condyle_limit_name(of->limit)));
      }
      set(result, 0, "friction_and_mass_of_all", both);
    }
  }
  condyle_estimator_free(estimator);
  check(status);
  return result;
}

static mxArray *analyse(int count, const mxArray *const *arguments) {
  const char *names[] = {"task", "side", "stroke", "reading", "value", "low",
                         "high", "unit", "definition", "provenance", "reason"};
  const char *path = path_of(count, arguments);
  const char **options = options_of(count - 2, arguments + 2);
  condyle_readings *readings = NULL;
  mxArray *result;
  size_t rows, i;
  check(condyle_analyse(path, options, (size_t)(count - 2), &readings));
  rows = condyle_readings_count(readings);
  result = mxCreateStructMatrix(rows, 1, 11, names);
  for (i = 0; i < rows; ++i) {
    condyle_reading of;
    if (condyle_readings_get(readings, i, &of, sizeof of) != CONDYLE_OK) break;
    mxSetField(result, i, "task", mxCreateString(of.task));
    mxSetField(result, i, "side", mxCreateString(of.side));
    mxSetField(result, i, "stroke", mxCreateDoubleScalar(of.stroke));
    mxSetField(result, i, "reading", mxCreateString(of.name));
    mxSetField(result, i, "value", mxCreateDoubleScalar(of.value));
    mxSetField(result, i, "low", mxCreateDoubleScalar(of.low));
    mxSetField(result, i, "high", mxCreateDoubleScalar(of.high));
    mxSetField(result, i, "unit", mxCreateString(of.unit));
    mxSetField(result, i, "definition", mxCreateString(of.definition));
    mxSetField(result, i, "provenance", mxCreateString(of.provenance));
    mxSetField(result, i, "reason", mxCreateString(of.reason));
  }
  condyle_readings_free(readings);
  return result;
}

void mexFunction(int result_count, mxArray **results, int count, const mxArray **arguments) {
  char word[16] = "";
  (void)result_count;
  if (count > 0 && mxIsChar(arguments[0])) mxGetString(arguments[0], word, sizeof word);
  if (strcmp(word, "read") == 0) {
    results[0] = read_recording(count, arguments);
  } else if (strcmp(word, "estimate") == 0) {
    results[0] = estimate(count, arguments);
  } else if (strcmp(word, "analyse") == 0) {
    results[0] = analyse(count, arguments);
  } else if (strcmp(word, "version") == 0) {
    results[0] = mxCreateString(condyle_version());
  } else {
    mexErrMsgIdAndTxt("condyle:call",
                      "the first argument must be 'read', 'estimate', 'analyse' or 'version'");
  }
}
