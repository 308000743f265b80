// Pages of --html and of dyn view: the template that tools/viewer makes, with a head in JSON and packed numbers in it.
#pragma once

#include "pack.hpp"

namespace cli::page {

// The template, which lies beside the command as share/dyn/viewer.html; fails, saying what is missing, where there is none.
std::string page_template();
// The template with these data in it: one page that needs nothing else.
std::string filled(const std::string& page, const json& head, const Pack& pack);
void write_file(const std::string& path, const std::string& text);

// The robot: joints, frames, shapes with their meshes. What could not be shown as it is is said in notes.
json model_json(const Robot& robot, const std::vector<std::string>& package_dirs, Pack& pack, json& notes);

}  // namespace cli::page
