-- SPDX-License-Identifier: BSD-3-Clause
SELECT name, value FROM options WHERE run_id = ? ORDER BY position;
