-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO options (run_id, position, name, value) VALUES (?, ?, ?, ?);
