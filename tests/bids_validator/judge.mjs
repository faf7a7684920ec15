// SPDX-License-Identifier: Apache-2.0
// Reads what the validator found, as JSON, and compares the errors with the expected ones.
// usage: node judge.mjs REPORT_JSON [EXPECTED_ERROR...]     (names such as NOT_INCLUDED)
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

const [path, ...expected] = process.argv.slice(2);
const { issues, summary } = JSON.parse(readFileSync(path, "utf8"));
const found = issues.errors.map((error) => error.key);
const evidence = issues.errors.flatMap((error) =>
  error.files.map((file) => `${error.key}: ${file.file?.relativePath ?? ""} ${file.evidence ?? ""}`));
assert.deepEqual([...new Set(found)].sort(), expected.sort(), evidence.join("\n"));
assert.ok(summary.totalFiles > 0);
