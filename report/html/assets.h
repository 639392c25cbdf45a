// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace plumbline::embedded {

// Files of report/html, compiled in.
const std::string& calibration_page();  // templates/calibration_page.mustache
const std::string& study_page();        // templates/study_page.mustache
// Parts of both, templates/page_*.mustache.
const std::string& page_head();
const std::string& page_verdict();
const std::string& page_cards();
const std::string& page_matrices();
const std::string& page_sections();
const std::string& page_figures();
const std::string& page_provenance();
const std::string& page_foot();
const std::string& page_style();    // templates/page.css
const std::string& page_script();   // templates/page.js
const std::string& scene_viewer();  // assets/scene_viewer.bundle.js

// The player of a replay.
const std::string& replay_player();    // templates/replay_player.mustache
const std::string& player_style();     // templates/player.css
const std::string& player_data();      // player/replay_data.js
const std::string& player_images();    // player/replay_images.js
const std::string& player_scene();     // player/replay_scene.js
const std::string& player_timeline();  // player/replay_timeline.js
const std::string& player_player();    // player/replay_player.js

}  // namespace plumbline::embedded
