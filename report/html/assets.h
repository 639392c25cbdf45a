// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline::embedded {

// Files of report/html, compiled in.
const std::string& calibration_page();  // templates/calibration_page.mustache
const std::string& page_style();        // templates/page.css
const std::string& page_script();       // templates/page.js
const std::string& scene_viewer();      // assets/scene_viewer.bundle.js

}  // namespace plumbline::embedded
