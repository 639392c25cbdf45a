-- SPDX-License-Identifier: BSD-3-Clause
SELECT rule, level, evidence, advice, value, threshold, unit
FROM findings WHERE run_id = ? ORDER BY position;
