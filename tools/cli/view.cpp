// dyn view: the robot in a browser, as a page in a file or, with --live, in a simulation that goes on.
#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <random>

#include "effect_choice.hpp"
#include "files.hpp"
#ifdef DYN_LIVE
#include "live/server.hpp"
#endif
#include "page/recording.hpp"
#include "stepping.hpp"
#include "system/system.hpp"

namespace cli {

namespace {

struct ViewOptions : SteppingOptions {
  std::string html;
  bool live = false, no_browser = false;
  int port = 0;
};

// Says so when there is nothing to open it with.
void open_browser(const std::string& address) {
  const std::string browser = open_in_browser(address);
  if (browser.empty())
    std::fprintf(stderr, "dyn: there is no screen and no $BROWSER here: open %s yourself\n", address.c_str());
  else
    std::fprintf(stderr, "dyn: opening %s with %s; if nothing opens, open it yourself\n", address.c_str(), browser.c_str());
}

// An empty file of a new name, in the folder for temporary files.
std::string new_page() {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  std::random_device random;
  for (int tries = 0; tries < 100; ++tries) {
    const std::string path = (folder / ("dyn-view-" + std::to_string(random()) + ".html")).string();
    const int file = open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0600);
    if (file >= 0) return close(file), path;
  }
  fail(folder.string() + ": no file can be made in it.");
}

void write_still(const ViewOptions& options, const std::string& html, const std::string& path) {
  json notes = json::array();
  Robot robot(options.robot);
  if (options.ground) robot.add_ground();
  page::Pack pack;
  const json head = page::still("model", options.robot, robot, start_of(robot, options, notes),
                                effects_on(robot, options.effects), pack, notes);
  page::write_file(path, page::filled(html, head, pack));
}

#ifdef DYN_LIVE
void run_live(const ViewOptions& options, const std::string& html) {
  live::Simulation simulation(options);
  page::Pack pack;
  const json head = simulation.head(pack);
  const std::string page = page::filled(html, head, pack);
  live::serve(simulation, page, static_cast<unsigned short>(options.port), [&](const std::string& address) {
    print(options.robot.json ? json_text({{"address", address}}) : address + "\n");
    if (!options.no_browser) open_browser(address);
  });
}
#else
void run_live(const ViewOptions&, const std::string&) {
  fail("this dyn was built without Boost.Beast (Debian: libboost-dev), which --live needs.");
}
#endif

void run_view(const ViewOptions& options) {
  check_stepping(options);
  if (options.live && !options.html.empty()) bad_usage("--live and --html are two ways to look: keep one.");
  check_outputs({{"--html", options.html}}, inputs_of(options.robot, {{"--state", options.state.file}}));
  const std::string html = page::page_template();
  if (options.live) return run_live(options, html);
  const std::string path = options.html.empty() ? new_page() : options.html;
  write_still(options, html, path);
  print(options.robot.json ? json_text({{"page", path}}) : path + "\n");
  if (options.html.empty() && !options.no_browser) open_browser("file://" + path);
}

}  // namespace

void add_view(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  options->duration = 1;
  CLI::App* command = app.add_subcommand(
      "view", "The robot in a browser: shapes, frames, masses, movable joints; with --live a running simulation");
  command->footer(
      "The address of --live has a random word and is served to this machine alone. Drag with Shift held to push a link. Ctrl-C "
      "ends it.");
  add_stepping_options(*command, *options);
  add_dt_option(*command, *options, "Step of --live, seconds");
  command->add_option("--html", options->html, "Write the page to this file, and open nothing")->check(not_empty);
  command->add_flag("--live", options->live, "Serve a running simulation: pause, reset, push, switch effects");
  command->add_option("--port", options->port, "Port of --live; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->check(whole)
      ->capture_default_str();
  command->add_flag("--no-browser", options->no_browser, "Print the address, and open nothing");
  command->callback([options] { run_view(*options); });
}

}  // namespace cli
