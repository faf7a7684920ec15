// SPDX-License-Identifier: Apache-2.0
// Reads what the validator found, as JSON, and compares the errors with the expected ones.
// usage: node judge.mjs REPORT_JSON [EXPECTED_ERROR...]     (names such as NOT_INCLUDED)
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

const [path, ...expected] = process.argv.slice(2);
const { issues, summary } = JSON.parse(readFileSync(path, "utf8"));
// The validator that reads the schema of BIDS has a form of its own.
const errors = issues.errors ?? issues.issues.filter((issue) => issue.severity === "error");
const found = errors.map((error) => error.key ?? error.code);
const evidence = errors.flatMap((error) => error.files?.map((file) =>
  `${error.key}: ${file.file?.relativePath ?? ""} ${file.evidence ?? ""}`) ?? `${error.code}: ${error.location}`);
assert.deepEqual([...new Set(found)].sort(), expected.sort(), evidence.join("\n"));
assert.ok(summary.totalFiles > 0);
