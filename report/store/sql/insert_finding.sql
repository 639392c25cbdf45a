-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO findings (run_id, position, rule, level, evidence, advice, value, threshold, unit)
VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?);
