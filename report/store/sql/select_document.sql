-- SPDX-License-Identifier: BSD-3-Clause
SELECT json FROM documents WHERE run_id = ? AND name = ?;
