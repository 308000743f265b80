// The command `dyn`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <sstream>

#include "cli.hpp"

namespace {

// Refuses the first option that the subcommand does not have. CLI11 would first say which others are required.
void check_options(const CLI::App& command, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::Option* o : command.get_options())
    for (const std::string& name : o->get_lnames()) names.push_back("--" + name);
  for (int k = 2; k < argc && std::strcmp(argv[k], "--") != 0; ++k) {
    const std::string word(argv[k], std::strcspn(argv[k], "="));
    if (!word.starts_with("--") || std::find(names.begin(), names.end(), word) != names.end()) continue;
    cli::bad_usage("dyn " + command.get_name() + " has no option \"" + cli::shown(word) + "\"" + cli::did_you_mean(word, names) +
                   "; dyn " + command.get_name() + " --help lists them.");
  }
}

}  // namespace

int main(int argc, char** argv) {
#ifdef SIGPIPE
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away is an error with a message, not a silent death
#endif
  CLI::App app("Rigid-body dynamics: inspect, evaluate, simulate and measure a robot.", "dyn");
  app.set_version_flag("--version", std::string("dyn ") + dyn_version() + " (" + dyn_build_info() + ")",
                       "Print the version and exit");
  app.require_subcommand(1);
  app.allow_windows_style_options(false);  // "/..." is a path everywhere
  cli::add_info(app);
  cli::add_eval(app);
  cli::add_ik(app);
  cli::add_distance(app);
  cli::add_check(app);
  cli::add_sim(app);
  cli::add_accuracy(app);
  cli::add_effects(app);
  cli::add_compare(app);
  cli::add_convert(app);
  cli::add_bench(app);
  cli::add_stress(app);
  cli::add_view(app);
  cli::add_manual(app);
  try {
    std::vector<std::string> names;
    bool known = argc < 2 || *argv[1] == '-';
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
      known = known || command->get_name() == argv[1];
      if (!command->get_group().empty()) names.push_back(command->get_name());
    }
    if (!known)
      cli::bad_usage("there is no subcommand \"" + cli::shown(argv[1]) + "\"" + cli::did_you_mean(argv[1], names) + "; they are " +
                     cli::join(names) + ".");
    if (argc > 1 && *argv[1] != '-') check_options(*app.get_subcommand(argv[1]), argc, argv);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      std::ostringstream answer, complaint;
      const int status = app.exit(error, answer, complaint);
      if (!answer.str().empty()) cli::print(answer.str());
      if (status != 0) throw cli::Failure{2, complaint.str()};
    }
    return 0;
  } catch (const cli::Failure& failure) {
    std::string message = failure.message;
    while (!message.empty() && message.back() == '\n') message.pop_back();
    std::cerr << "dyn: " << message << '\n';
    return failure.exit_status;
  } catch (const std::exception& error) {
    std::cerr << "dyn: " << error.what() << '\n';
    return 1;
  }
}
