-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO parameters (run_id, stage, position, name, unit, value, std, resample_std)
VALUES (?, ?, ?, ?, ?, ?, ?, ?);
