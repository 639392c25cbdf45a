-- SPDX-License-Identifier: BSD-3-Clause
INSERT INTO arrays (run_id, name, element, data) VALUES (?, ?, ?, ?);
