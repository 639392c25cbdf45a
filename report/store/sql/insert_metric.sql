-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO metrics (run_id, stage, name, unit, value) VALUES (?, ?, ?, ?, ?);
