// The command `dyn`.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "cli.hpp"

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away is an error with a message, not a silent death
  CLI::App app("Rigid-body dynamics: inspect, evaluate, simulate and measure a robot.", "dyn");
  app.set_version_flag("--version", std::string("dyn ") + dyn_version() + " (" + dyn_build_info() + ")",
                       "Print the version and exit");
  app.require_subcommand(1);
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
      cli::bad_usage("there is no subcommand \"" + cli::shown(argv[1]) + "\"; they are " + cli::join(names) + ".");
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
