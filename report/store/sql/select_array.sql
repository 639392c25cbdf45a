-- SPDX-License-Identifier: BSD-3-Clause
SELECT element, data FROM arrays WHERE run_id = ? AND name = ?;
