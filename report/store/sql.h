// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline::embedded {

// The statements of report/store/sql, compiled in.
const std::string& schema_v1();
const std::string& schema_v2();
const std::string& schema_v3();
const std::string& insert_run();
const std::string& insert_option();
const std::string& insert_metric();
const std::string& insert_parameter();
const std::string& insert_finding();
const std::string& insert_document();
const std::string& insert_array();
const std::string& select_runs();
const std::string& select_run();
const std::string& select_options();
const std::string& select_findings();
const std::string& select_document();
const std::string& select_array();

}  // namespace plumbline::embedded
